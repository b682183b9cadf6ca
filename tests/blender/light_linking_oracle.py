"""Runs inside Blender: Cycles and Rayleaf render tiles of several materials under lights that are linked to some of them,
and under plates that cast shadows in some lights only; reports the mean of each tile, with two seeds of each engine.
"""

import sys
from pathlib import Path

import both_engines
import bpy
import scenes

report = globals()["report"]  # given by the test
PIXELS, SAMPLES, DISTRIBUTED = 12, 400, 80  # the last sends several rays from each surface
TILES = 3  # a side
# From the bottom left, by row.
MATERIALS = ("matte", "rough", "sharp", "mirror", "glass", "veiled", "skin", "matte", "glossy")


def mix(tree, first, second, share):
    node = tree.nodes.new("ShaderNodeMixShader")
    node.inputs[0].default_value = share
    tree.links.new(first.outputs[0], node.inputs[1])
    tree.links.new(second.outputs[0], node.inputs[2])
    return node


def shader(tree, kind, **inputs):
    node = tree.nodes.new(f"ShaderNode{kind}")
    for name, value in inputs.items():
        node.inputs[name.replace("_", " ")].default_value = value
    return node


def material(kind):
    made, tree, output = scenes.material(kind)
    color = (0.8, 0.7, 0.6, 1)
    glossy = {"rough": 0.5, "sharp": 0.15, "mirror": 0.0, "glossy": 0.3}
    if kind in glossy:
        node = shader(tree, "BsdfGlossy", Color=color)
        node.inputs["Roughness"].default_value = glossy[kind]
    elif kind == "glass":
        node = shader(tree, "BsdfGlass", Color=color, Roughness=0.1, IOR=1.3)
    elif kind == "veiled":
        node = mix(tree, shader(tree, "BsdfTransparent"), shader(tree, "BsdfDiffuse", Color=color), 0.6)
    elif kind == "skin":
        node = shader(tree, "SubsurfaceScattering", Color=color, Scale=0.1)
    elif kind == "glow":
        node = shader(tree, "Emission", Strength=8.0)
    elif kind == "fog":
        fog = shader(tree, "VolumeScatter", Density=1.5)
        tree.links.new(fog.outputs[0], output.inputs["Volume"])
        return made
    else:
        node = shader(tree, "BsdfDiffuse", Color=color)
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return made


def placed(name, place, size, kind, unseen=True):
    item = scenes.quad(name)
    item.location, item.scale = place, (size, size, 1)
    item.data.materials.append(material(kind))
    item.visible_camera = not unseen
    return item


def box(name, place, size, kind):
    bpy.ops.mesh.primitive_cube_add(size=size, location=place)
    item = bpy.context.object
    item.name = name
    item.data.materials.append(material(kind))
    return item


def collection(name, chosen):
    """One that chooses objects: their names with + or - before them; in brackets by way of a collection inside."""
    made = bpy.data.collections.new(name)
    for entry in chosen.split():
        state, inner = ("INCLUDE" if entry[0] == "+" else "EXCLUDE"), entry[1:]
        if inner.startswith("("):
            child = bpy.data.collections.new(f"in {name}")
            for each in inner[1:-1].split(","):
                child.objects.link(bpy.data.objects[each])
            made.children.link(child)
            made.collection_children[len(made.collection_children) - 1].light_linking.link_state = state
        else:
            made.objects.link(bpy.data.objects[inner])
            made.collection_objects[len(made.collection_objects) - 1].light_linking.link_state = state
    return made


def light(kind):
    """One above the middle."""
    if kind == "MESH":
        item = placed("light", (-0.75, -0.75, 2.5), 1.5, "glow")
        return item
    data = bpy.data.lights.new("light", kind)
    data.energy = 4.0 if kind == "SUN" else 150.0
    item = scenes.add(data)
    item.location = (0, 0, 2.5)
    if kind == "AREA":
        data.size = 1.5
    elif kind == "SUN":
        data.angle = 0.4
    else:
        data.shadow_soft_size = 0.3
    return item


def tiles():
    for row in range(TILES):
        for column in range(TILES):
            number = row * TILES + column
            item = placed(f"tile{number}", (column - 1.5, row - 1.5, 0), 1.0, MATERIALS[number], unseen=False)
            if MATERIALS[number] == "skin":
                item.modifiers.new("thick", "SOLIDIFY").thickness = 0.5
    placed("below", (-3, -3, -1.0), 6, "matte", unseen=False)


def instanced(name, source):
    """An empty that shows an object of its own, of the source's mesh and place."""
    inside = bpy.data.collections.new(f"inside {name}")
    copy = bpy.data.objects[source].copy()
    copy.name = f"{name}-shown"
    inside.objects.link(copy)
    empty = bpy.data.objects.new(name, None)
    empty.instance_type, empty.instance_collection = "COLLECTION", inside
    bpy.context.scene.collection.objects.link(empty)
    bpy.data.objects.remove(bpy.data.objects[source])


def build(case):
    scenes.empty_scene()
    scenes.plain_world((0.02, 0.02, 0.03))
    tiles()
    placed("plate", (-1.2, -1.2, 1.2), 1.2, "matte")
    placed("pane", (0.1, 0.1, 1.5), 1.2, "veiled")
    if case.get("fog"):
        box("fog", (0.5, -0.5, 0.7), 1.0, "fog")
    if case.get("air"):
        world = bpy.context.scene.world
        world.use_nodes = True
        tree = world.node_tree
        fog = shader(tree, "VolumeScatter", Density=0.1)
        output = next(node for node in tree.nodes if node.type == "OUTPUT_WORLD")
        tree.links.new(fog.outputs[0], output.inputs["Volume"])
    if case.get("instanced"):
        instanced("maker", "tile0")
    for number, each in enumerate(case["lights"]):
        item = light(each["kind"])
        item.name = f"light{number}"
        item.location.x += each.get("x", 0.0)
    for number, each in enumerate(case["lights"]):
        linking = bpy.data.objects[f"light{number}"].light_linking
        if "lit" in each:
            linking.receiver_collection = collection(f"lit {number}", each["lit"])
        if "blocks" in each:
            linking.blocker_collection = collection(f"blocks {number}", each["blocks"])


def cases():
    for kind in ("POINT", "SUN", "AREA", "MESH"):
        yield f"{kind} included", {"lights": [{"kind": kind, "lit": "+tile0 +tile2 +tile3 +tile6 +tile8"}]}
        yield f"{kind} excluded", {"lights": [{"kind": kind, "lit": "-tile1 -tile4 -tile5 -tile7"}]}
        yield f"{kind} without shadows of the plate", {"lights": [{"kind": kind, "blocks": "-plate"}]}
        yield f"{kind} with shadows of the plate alone", {"lights": [{"kind": kind, "blocks": "+plate"}]}
        yield f"{kind} without shadows of the pane", {"lights": [{"kind": kind, "blocks": "-pane", "lit": "-tile4"}]}
    nested = "+(tile0,tile2,tile4,tile6,tile8) -tile4 +tile1"
    yield "nested", {"lights": [{"kind": "AREA", "lit": nested}]}
    two = [
        {"kind": "AREA", "lit": "+tile0 +tile2 +tile8", "x": -0.5},
        {"kind": "MESH", "lit": "-tile2 -tile3", "x": 0.5},
    ]
    two += [{"kind": "SUN", "blocks": "-plate -tile5"}]
    yield "several", {"lights": two}
    yield "instanced", {
        "lights": [{"kind": "AREA", "lit": "-maker"}, {"kind": "SUN", "blocks": "-maker -plate"}],
        "instanced": True,
    }
    for name, sets in {
        "unlit": {"lit": "-fog"},
        "alone": {"lit": "+fog"},
        "clear": {"blocks": "-fog"},
        "all": {},
    }.items():
        yield f"fog {name}", {"lights": [{"kind": "AREA", **sets}], "fog": True}
    yield "air", {
        "lights": [{"kind": "AREA", "lit": "+tile0 +tile1"}, {"kind": "AREA", "lit": "-tile0", "x": 1.0}],
        "air": True,
    }


def main():
    folder, integrator, *names = sys.argv[1:]
    if bpy.app.version < (4, 0, 0):
        return report(version=bpy.app.version)
    found = {}
    for name, case in cases():
        if names and name not in names:
            continue
        build(case)
        camera = bpy.data.cameras.new("camera")
        camera.type, camera.ortho_scale = "ORTHO", TILES
        scene = bpy.context.scene
        scene.camera = scenes.add(camera)
        scene.camera.location = (0, 0, 10)
        scene.render.resolution_x = scene.render.resolution_y = PIXELS
        scenes.write_layers()
        scene.rayleaf.integrator = integrator.upper()
        both_engines.set_alike(scene, max_bounces=3, diffuse_bounces=1)  # distribution ray tracing knows one
        both_engines.sample_plainly(scene, SAMPLES)
        if integrator == "distribution":
            scene.rayleaf.samples = DISTRIBUTED
        both_engines.without_blur(scene)
        both_engines.filter_by_box(scene)
        found[name] = {}
        for engine in ("CYCLES", "RAYLEAF"):
            for seed in (1, 2):
                scene.cycles.seed = seed
                scene.rayleaf.seed = seed
                picture = both_engines.picture(scene, engine, Path(folder) / "picture.exr")
                found[name][f"{engine} {seed}"] = both_engines.means(picture[..., :3], PIXELS // TILES)
    report(found=found, version=bpy.app.version)


main()
