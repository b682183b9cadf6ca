"""Runs inside Blender: Cycles and Rayleaf render a body with a volume on a floor; reports means over parts of the picture."""

import sys
from pathlib import Path

import both_engines
import bpy
import scenes
from oracle_case import described_nodes
from volume_oracle_cases import CASES

SIZE, SAMPLES = 24, 256
ENGINES = {"CYCLES": {}, "RAYLEAF": {"integrator": "PATH"}, "DISTRIBUTION": {"integrator": "DISTRIBUTION"}}
# Distribution ray tracing has one diffuse bounce at most: these have none to speak of.
ALSO_DISTRIBUTED = ("tinted glass", "scattering", "uneven scattering", "a world of mist")


def textures(tree):
    """What cases link to by name."""
    place, noise, colors = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("TexCoord", "TexNoise", "TexNoise"))
    gradient, faint = tree.nodes.new("ShaderNodeTexGradient"), tree.nodes.new("ShaderNodeMath")
    strong = tree.nodes.new("ShaderNodeMath")
    for node, scale in ((noise, 1.7), (colors, 0.9)):
        tree.links.new(place.outputs["Object"], node.inputs["Vector"])
        node.inputs["Scale"].default_value, node.inputs["Detail"].default_value = scale, 1.0
    tree.links.new(place.outputs["Generated"], gradient.inputs["Vector"])
    for node, factor in ((faint, 0.1), (strong, 2.0)):
        node.operation = "MULTIPLY"
        tree.links.new(noise.outputs["Fac"], node.inputs[0])
        node.inputs[1].default_value = factor
    return {
        "noise": strong.outputs[0],
        "colors": colors.outputs["Color"],
        "gradient": gradient.outputs["Fac"],
        "faint": faint.outputs[0],
    }


def shader(tree, named, described):
    """The output of a described shader."""
    kind, inputs = described
    node = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in inputs.items():
        if name == "phase":
            node.phase = value
        elif isinstance(value, tuple) and isinstance(value[0], str):
            tree.links.new(shader(tree, named, value), node.inputs[name])
        elif isinstance(value, str):
            tree.links.new(named[value], node.inputs[name])
        else:
            node.inputs[name].default_value = value
    return node.outputs[0]


def fill(owner, kind, **described):
    """Give a material or world the nodes that are described by input of the output."""
    owner.use_nodes = True
    tree = owner.node_tree
    tree.nodes.clear()
    output, named = tree.nodes.new(f"ShaderNodeOutput{kind}"), textures(tree)
    for name, each in described.items():
        if each is not None:
            tree.links.new(shader(tree, named, each), output.inputs[name])


def add_body(name, shape, size, location):
    """A closed body with a material of its own."""
    if shape == "ball":
        bpy.ops.mesh.primitive_uv_sphere_add(radius=size / 2, location=location, segments=48, ring_count=24)
        bpy.ops.object.shade_smooth()
    else:
        bpy.ops.mesh.primitive_cube_add(size=size, location=location, rotation=(0.0, 0.0, 0.4))
    body = bpy.context.object
    body.name = name
    body.data.materials.append(bpy.data.materials.new(name))
    return body


def build(case):
    """A body on a floor under a point lamp, an area lamp and a grey sky."""
    scenes.empty_file()
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("grey")
    fill(scene.world, "World", Surface=("Background", {"Color": (0.2, 0.25, 0.3, 1)}), Volume=case.world)
    bpy.ops.mesh.primitive_plane_add(size=8)
    bpy.context.object.data.materials.append(bpy.data.materials.new("floor"))
    fill(bpy.data.materials["floor"], "Material", Surface=("BsdfDiffuse", {"Color": (0.7, 0.7, 0.7, 1)}))
    size, place = (12.0, (0, 0, 5.9)) if case.camera_inside else (1.6, (0, 0, 1.0))
    add_body("body", case.shape, size, place)
    fill(bpy.data.materials["body"], "Material", Surface=case.surface, Volume=case.volume)
    if case.inner:
        add_body("inner", "cube", 0.7, (0.1, 0.0, 1.0))
        fill(bpy.data.materials["inner"], "Material", Volume=case.inner)
    # Without a size: Cycles' balls of light are disks that face who looks, which shows in mist close by.
    point = scenes.add(bpy.data.lights.new("point", "POINT"))
    point.data.energy, point.data.shadow_soft_size, point.location = 150, 0.0, (1.5, -1.5, 3.0)
    area = scenes.add(bpy.data.lights.new("area", "AREA"))
    area.data.energy, area.data.size = 60, 1.0
    area.location, area.rotation_euler = (-2.5, -0.5, 2.5), (0.2, -0.9, 0.0)
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.location, camera.rotation_euler = (0.0, -4.5, 2.4), (1.25, 0, 0)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scenes.write_layers()
    return scene


def set_up(scene, settings):
    """The same for both engines."""
    both_engines.set_alike(scene, **{"max_bounces": 16, "volume_bounces": 0, "diffuse_bounces": 1, **settings})
    both_engines.sample_plainly(scene, SAMPLES)
    both_engines.without_blur(scene)
    both_engines.filter_by_box(scene)
    scene.cycles.volume_step_rate, scene.cycles.volume_preview_step_rate = 0.1, 0.1


# What volumes are made of.
KINDS = [
    f"ShaderNode{kind}"
    for kind in ("VolumeAbsorption", "VolumeScatter", "VolumeCoefficients", "VolumePrincipled", "Emission", "AddShader")
]
KINDS.append("ShaderNodeMixShader")


def compared_nodes():
    """By case: the nodes of its volumes as they are compared."""
    found = {}
    for name, case in CASES.items():
        scene = build(case)
        owners = [scene.world, *bpy.data.materials]
        found[name] = [node for owner in owners for node in described_nodes(owner.node_tree, KINDS)]
    return found


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    folder, result = Path(sys.argv[1]), {}
    wanted = sys.argv[2:] or list(CASES)
    for case_name in wanted:
        scene_of_case = build(CASES[case_name])
        set_up(scene_of_case, CASES[case_name].settings)
        result[case_name] = {}
        for engine_name, own_settings in ENGINES.items():
            if engine_name == "DISTRIBUTION" and case_name not in ALSO_DISTRIBUTED:
                continue
            for key, setting in own_settings.items():
                setattr(scene_of_case.rayleaf, key, setting)
            chosen = "CYCLES" if engine_name == "CYCLES" else "RAYLEAF"
            picture = both_engines.picture(scene_of_case, chosen, folder / "picture.exr")
            result[case_name][engine_name] = both_engines.means(picture[..., :3], SIZE // 3)
    report(result=result, nodes=compared_nodes())
