"""Small parts of scenes for scripts inside Blender."""

import bpy


def empty_scene():
    """A scene with a camera at the origin and nothing else."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    import addon_utils

    addon_utils.enable("rayleaf")
    scene = bpy.context.scene
    scene.render.engine = "RAYLEAF"
    scene.camera = add(bpy.data.cameras.new("Camera"))
    return scene


def add(data, name=None, collection=None):
    """An object with this data, in the scene."""
    item = bpy.data.objects.new(name or (data.name if data else "Empty"), data)
    (collection or bpy.context.scene.collection).objects.link(item)
    return item


def mesh(vertices, faces, name="Mesh"):
    """An object with a mesh."""
    data = bpy.data.meshes.new(name)
    data.from_pydata(vertices, [], faces)
    return add(data, name)


def quad(name="Quad"):
    """A unit square in the plane z = 0, with a UV map."""
    item = mesh([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)], [(0, 1, 2, 3)], name)
    layer = item.data.uv_layers.new(name="UVMap")
    for loop, uv in zip(layer.data, [(0, 0), (1, 0), (1, 1), (0, 1)], strict=True):
        loop.uv = uv
    return item


def surface(name="Surface"):
    """A NURBS surface object: Blender's primitive, 4 x 4 points."""
    bpy.ops.surface.primitive_nurbs_surface_surface_add()
    bpy.context.object.name = name
    return bpy.context.object


def material(name="Material"):
    """A material with an empty node tree but for its output; the material, the tree and the output."""
    result = bpy.data.materials.new(name)
    result.use_nodes = True
    tree = result.node_tree
    tree.nodes.clear()
    return result, tree, tree.nodes.new("ShaderNodeOutputMaterial")
