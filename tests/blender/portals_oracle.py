"""Runs inside Blender: a plate or a block that is a portal to another place, in both engines and integrators."""

import sys
from pathlib import Path

import both_engines
import bpy
import scenes
from oracle_case import described_nodes

SIZE, SAMPLES = 32, 128
KIND = "ShaderNodeBsdfRayPortal"
FAR = 20.0  # where the other place is, along x


def there(tree, node):
    """The ray goes on from the same point of the other place."""
    moved = tree.nodes.new("ShaderNodeVectorMath")
    moved.inputs[1].default_value = (FAR, 0, 0)
    tree.links.new(tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"], moved.inputs[0])
    tree.links.new(moved.outputs[0], node.inputs["Position"])
    return node.outputs[0]


def mirrored(tree, node):
    """The ray leaves the surface by its mirror direction."""
    tree.links.new(tree.nodes.new("ShaderNodeTexCoord").outputs["Reflection"], node.inputs["Direction"])
    return node.outputs[0]


def straight(tree, node):
    """As the node is made: nothing but shadows tells it from a transparent surface."""
    return node.outputs[0]


def turned(tree, node):
    """In the other place, along one direction that is no unit vector."""
    node.inputs["Direction"].default_value = (0.3, 2, -0.9)
    return there(tree, node)


def mixed(other, share=0.5, **inputs):
    """Beside another shader."""

    def shader(tree, node):
        mix, second = tree.nodes.new("ShaderNodeMixShader"), tree.nodes.new(f"ShaderNode{other}")
        for key, value in inputs.items():
            second.inputs[key].default_value = value
        mix.inputs[0].default_value = share
        node.inputs["Color"].default_value = (0.9, 0.7, 0.4, 1)
        tree.links.new(there(tree, node), mix.inputs[1])
        tree.links.new(second.outputs[0], mix.inputs[2])
        return mix.outputs[0]

    return shader


# The body, what makes it a portal, and how many transparent surfaces a ray may pass.
CASES = {
    "window": ("plate", there, 8),
    "block": ("block", there, 8),
    "mirror": ("plate", mirrored, 8),
    "straight": ("plate", straight, 8),
    "turned": ("plate", turned, 8),
    "half matte": ("plate", mixed("BsdfDiffuse", Color=(0.2, 0.4, 0.9, 1)), 8),
    "half clear": ("plate", mixed("BsdfTransparent", Color=(0.6, 1, 0.8, 1)), 8),
    "half mirror": ("plate", mixed("BsdfAnisotropic", Roughness=0.0), 8),
    "few passed": ("block", there, 0),
}


def portal(body, shade):
    """The material of a case."""
    material, tree, output = scenes.material(body)
    tree.links.new(shade(tree, tree.nodes.new(KIND)), output.inputs["Surface"])
    return material


def counting_floor():
    """Redder where the ray has come by portals."""
    material, tree, output = scenes.material("counting")
    shader, color = tree.nodes.new("ShaderNodeBsdfDiffuse"), tree.nodes.new("ShaderNodeCombineXYZ")
    path, share = tree.nodes.new("ShaderNodeLightPath"), tree.nodes.new("ShaderNodeMath")
    share.operation, share.inputs[1].default_value = "MULTIPLY", 0.4
    color.inputs[1].default_value = color.inputs[2].default_value = 0.4
    if "Portal Depth" in path.outputs:  # 5.0
        tree.links.new(path.outputs["Portal Depth"], share.inputs[0])
    tree.links.new(share.outputs[0], color.inputs[0])
    tree.links.new(color.outputs[0], shader.inputs["Color"])
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return material


def place(x, floor, ball, energy):
    """A floor, a ball and a lamp."""
    bpy.ops.mesh.primitive_plane_add(size=8, location=(x, 1, 0))
    bpy.context.object.data.materials.append(floor)
    bpy.ops.mesh.primitive_uv_sphere_add(radius=0.6, location=(x + 0.4, 1.6, 0.6))
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(ball)
    lamp = scenes.add(bpy.data.lights.new("lamp", "POINT"))
    lamp.data.energy, lamp.data.shadow_soft_size, lamp.location = energy, 0, (x - 1.5, -1.5, 3.0)


def build(body, shade, passed):
    """Two places; the body stands in the first, which the camera sees."""
    scenes.empty_file()
    scene = bpy.context.scene
    scenes.plain_world((0.1, 0.15, 0.2))
    place(
        0,
        scenes.of_one_shader("floor", "BsdfDiffuse", Color=(0.7, 0.7, 0.7, 1)),
        scenes.of_one_shader("ball", "BsdfDiffuse", Color=(0.9, 0.2, 0.1, 1)),
        150,
    )
    place(FAR, counting_floor(), scenes.of_one_shader("far ball", "BsdfDiffuse", Color=(0.1, 0.3, 0.9, 1)), 250)
    if body == "plate":
        bpy.ops.mesh.primitive_plane_add(size=1.8, location=(0, 0, 1.0), rotation=(1.5, 0, 0.2))
    else:
        bpy.ops.mesh.primitive_cube_add(size=1.3, location=(0, 0, 0.8), rotation=(0, 0, 0.4))
    bpy.context.object.data.materials.append(portal(body, shade))
    scene.camera = scenes.add(bpy.data.cameras.new("camera"))
    scene.camera.location, scene.camera.rotation_euler = (0.0, -5.0, 2.4), (1.25, 0, 0)
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.film_transparent = True
    scenes.write_layers()
    both_engines.set_alike(scene, max_bounces=6)
    scene.cycles.transparent_max_bounces = scene.rayleaf.transparent_bounces = passed
    both_engines.sample_plainly(scene, SAMPLES)
    both_engines.without_blur(scene)
    both_engines.filter_by_box(scene)
    return scene


def cases():
    """Those that this Blender has."""
    return CASES if hasattr(bpy.types, KIND) else {}


def compared_nodes():
    """By case: the node as it is compared."""
    scenes.empty_file()
    return {name: described_nodes(portal(body, shade).node_tree, (KIND,)) for name, (body, shade, _) in cases().items()}


if __name__ == "__main__":
    folder, found = Path(sys.argv[1]), {}
    for case_name, case in cases().items():
        shown, found[case_name] = build(*case), {}
        for engine, integrator in (("CYCLES", "PATH"), ("RAYLEAF", "PATH"), ("RAYLEAF", "DISTRIBUTION")):
            shown.rayleaf.integrator = integrator
            picture = both_engines.picture(shown, engine, folder / f"{engine} {integrator} {case_name}.exr")
            found[case_name][f"{engine} {integrator}"] = both_engines.means(picture, SIZE // 4)
    globals()["report"](found=found, nodes=compared_nodes())
