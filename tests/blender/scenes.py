"""Small parts of scenes for scripts inside Blender."""

import addon_utils
import bpy


# Where Blender's versions differ for the tests.
LINEAR, XYZ = ("Linear", "XYZ") if bpy.app.version < (4, 0, 0) else ("Linear Rec.709", "Linear CIE-XYZ D65")
SUBSURFACE = "Subsurface" if bpy.app.version < (4, 0, 0) else "Subsurface Weight"
TRANSMISSION = "Transmission" if bpy.app.version < (4, 0, 0) else "Transmission Weight"
COAT = "Clearcoat" if bpy.app.version < (4, 0, 0) else "Coat Weight"


def group(name, input_type, output_type, kind="ShaderNodeTree"):
    """A node group, of shaders or of another kind, with one input and one output."""
    tree = bpy.data.node_groups.new(name, kind)
    if bpy.app.version < (4, 0, 0):
        tree.inputs.new(input_type, "In")
        tree.outputs.new(output_type, "Out")
    else:
        tree.interface.new_socket("In", in_out="INPUT", socket_type=input_type)
        tree.interface.new_socket("Out", in_out="OUTPUT", socket_type=output_type)
    return tree


def sharpen_edges_above(item, angle):
    """Shades edges sharp where faces meet at more than the angle."""
    if bpy.app.version < (4, 1, 0):
        item.data.use_auto_smooth, item.data.auto_smooth_angle = True, angle
    else:
        item.data.set_sharp_from_angle(angle=angle)


def cast_solid_shadows(material):
    """Shadows of a material do not respect its transparency."""
    owner = material if hasattr(material, "use_transparent_shadow") else material.cycles
    owner.use_transparent_shadow = False


def set_shadow_terminator(item, kind, offset):
    """The GEOMETRY or SHADING offset of an object; since 4.2 a setting for all engines."""
    name = f"shadow_terminator_{kind.lower()}_offset"
    if hasattr(item, name):
        setattr(item, name, offset)
    else:
        setattr(item.cycles, "shadow_terminator_offset" if kind == "SHADING" else name, offset)


def empty_file():
    """Removes everything. Blender 4 disables add-ons at that."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    addon_utils.enable("rayleaf")


def empty_scene():
    """A scene with a camera at the origin and nothing else."""
    empty_file()
    scene = bpy.context.scene
    scene.render.engine = "RAYLEAF"
    scene.camera = add(bpy.data.cameras.new("Camera"))
    return scene


def half_filled_picture(path, samples):
    """A scene of 16 x 16 pixels, written to a file: a quad shines in the lower half, the upper is empty."""
    scene = empty_scene()
    render = scene.render
    render.resolution_x, render.resolution_y, render.resolution_percentage = 16, 16, 100
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth, render.image_settings.exr_codec = "32", "NONE"
    render.filepath, render.film_transparent = path, True
    scene.rayleaf.samples = samples
    scene.camera.location, scene.camera.data.type, scene.camera.data.ortho_scale = (0, 0, 5), "ORTHO", 2
    shining = mesh([(-1, -1, 0), (1, -1, 0), (1, 0, 0), (-1, 0, 0)], [(0, 1, 2, 3)], "Good")
    shining_material, tree, output = material("Shining")
    shader = tree.nodes.new("ShaderNodeEmission")
    shader.inputs["Color"].default_value = (1, 0.5, 0.25, 1)
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    shining.data.materials.append(shining_material)
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


def write_layers():
    """Have renders written as multilayer EXR files that plain_exr reads."""
    from rayleaf.versions import choose_file_format

    settings = bpy.context.scene.render.image_settings
    choose_file_format(settings, "OPEN_EXR_MULTILAYER")
    settings.color_depth, settings.exr_codec = "32", "NONE"


def material(name="Material"):
    """A material with an empty node tree but for its output; the material, the tree and the output."""
    result = bpy.data.materials.new(name)
    result.use_nodes = True
    tree = result.node_tree
    tree.nodes.clear()
    return result, tree, tree.nodes.new("ShaderNodeOutputMaterial")


def of_one_shader(name, kind, **inputs):
    """A material of one shader, with these inputs."""
    made, tree, output = material(name)
    shader = tree.nodes.new(f"ShaderNode{kind}")
    for key, value in inputs.items():
        shader.inputs[key].default_value = value
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return made


def set_displacement(material, method):
    """BUMP, DISPLACEMENT or BOTH."""
    if hasattr(material, "displacement_method"):  # 4.1
        material.displacement_method = method
    else:
        addon_utils.enable("cycles")
        material.cycles.displacement_method = method


def make_panoramic(camera, kind, **settings):
    """A camera's data, with Cycles' settings of panoramas."""
    camera.type = "PANO"
    own = camera if hasattr(camera, "panorama_type") else camera.cycles  # 5.0
    own.panorama_type = kind
    for name, value in settings.items():
        setattr(own, name, value)


def set_aov(node, name):
    """Which AOV an AOV Output node writes to."""
    setattr(node, "aov_name" if hasattr(node, "aov_name") else "name", name)  # 4.2


def grow_strands(item, length, width):
    """Twelve straight strands of even width, spread over the faces of a mesh."""
    item.modifiers.new("Hair", "PARTICLE_SYSTEM")
    settings = item.particle_systems[0].settings
    settings.type, settings.count, settings.hair_length, settings.hair_step = "HAIR", 12, length, 2
    settings.emit_from, settings.distribution, settings.use_modifier_stack = "FACE", "JIT", True
    settings.root_radius = settings.tip_radius = 1.0
    settings.radius_scale, settings.shape, settings.use_close_tip = width, 0.0, False
    settings.display_step = settings.render_step = 2


def set_curve_types(curves, kind):
    """Of all hair curves of the active object: CATMULL_ROM, POLY, BEZIER or NURBS."""
    if hasattr(curves, "set_types"):
        curves.set_types(type=kind)
        return
    if bpy.app.version >= (4, 2, 0):  # from here on an attribute added by hand harms Blender's memory
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.curves.select_all(action="SELECT")
        bpy.ops.curves.curve_type_set(type=kind)
        bpy.ops.object.mode_set(mode="OBJECT")
        return
    types = curves.attributes.new("curve_type", "INT8", "CURVE")
    for each in types.data:
        each.value = ("CATMULL_ROM", "POLY", "BEZIER", "NURBS").index(kind)


def compositor(scene):
    """The scene's compositor with a Render Layers node in it."""
    if hasattr(scene, "compositing_node_group"):  # 5.0
        scene.compositing_node_group = bpy.data.node_groups.new("Compositing", "CompositorNodeTree")
        scene.compositing_node_group.nodes.new("CompositorNodeRLayers")
        return scene.compositing_node_group
    scene.use_nodes = True
    return scene.node_tree


def compositor_output(tree):
    """The node that takes the picture."""
    if bpy.app.version < (5, 0, 0):  # where there are several, versions differ in which one counts
        there = [node for node in tree.nodes if node.bl_idname == "CompositorNodeComposite"]
        return there[0] if there else tree.nodes.new("CompositorNodeComposite")
    tree.interface.new_socket("Image", in_out="OUTPUT", socket_type="NodeSocketColor")
    return tree.nodes.new("NodeGroupOutput")


def plain_world(color):
    """A world of an even colour. Since 5.0 each has nodes."""
    world = bpy.context.scene.world = bpy.data.worlds.new("World")
    world.color = color
    if world.use_nodes:
        world.node_tree.nodes["Background"].inputs["Color"].default_value = (*color, 1)
    return world


def diffuse_alone(tree):
    """A diffuse shader in place of what a material's tree has."""
    tree.nodes.clear()
    shader, output = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return shader
