"""Runs inside Blender: Cycles and Rayleaf render a floor under lamps with nodes; reports the pixels."""

import itertools
import sys
from pathlib import Path

import both_engines
import bpy
import scenes
from oracle_case import described_nodes

SIZE, SAMPLES = 12, 400
LAMPS = {
    "point": dict(type="POINT", energy=100, shadow_soft_size=0.0),
    "spot": dict(type="SPOT", energy=100, shadow_soft_size=0.0, spot_size=2.2, spot_blend=0.3),
    "sun": dict(type="SUN", energy=3, angle=0.0),
    "rectangle": dict(type="AREA", energy=100, shape="RECTANGLE", size=1.5, size_y=0.7),
    "disk": dict(type="AREA", energy=100, shape="DISK", size=1.2),
}
# One quadrant; half; all around; a single column. Candela.
IES = {
    "quadrant": ((0, 30, 60, 90), (0, 45, 90), (900, 700, 300, 0, 800, 400, 100, 0, 900, 900, 600, 100)),
    "half": ((0, 30, 60, 90), (0, 90, 180), (900, 700, 300, 0, 900, 400, 100, 0, 900, 900, 600, 100)),
    "around": ((0, 45, 90), (0, 120, 240, 360), (500, 700, 300, 500, 200, 100, 500, 900, 800, 500, 700, 300)),
    "column": ((0, 20, 40, 90, 180), (0,), (900, 1200, 300, 200, 100)),
}


def ies_text(name):
    """A file with a distribution, as Blender's text."""
    down, around, values = IES[name]
    header = f"IESNA:LM-63-1995\n[TEST] {name}\nTILT=NONE\n1 1000 1.5 {len(down)} {len(around)} 1 2 0 0 0\n1 0.9 60\n"
    text = bpy.data.texts.new(name)
    text.write(header + "\n".join(" ".join(map(str, row)) for row in (down, around, values)) + "\n")
    return text


def distribute(node, name, is_file):
    """Give a node a distribution, as a text or as a file beside the pictures."""
    text = ies_text(name)
    if not is_file:
        node.ies = text
        return
    path = Path(bpy.app.tempdir) / f"{name}.ies"
    path.write_text(text.as_string())
    node.mode, node.filepath = "EXTERNAL", str(path)


def tint(tree, *wanted):
    """The emission of a lamp by what a case names."""
    kind, name = wanted
    emission = tree.nodes.new("ShaderNodeEmission")
    if kind in ("IES", "IES file", "IES turned"):
        node = tree.nodes.new("ShaderNodeTexIES")
        distribute(node, name, kind == "IES file")
        if kind == "IES turned":
            geometry, turned = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeVectorRotate")
            turned.inputs["Angle"].default_value = 0.6
            tree.links.new(geometry.outputs["Normal"], turned.inputs["Vector"])
            tree.links.new(turned.outputs[0], node.inputs["Vector"])
        node.inputs["Strength"].default_value = 0.5
        tree.links.new(node.outputs[0], emission.inputs["Strength"])
    elif kind == "falloff":
        node = tree.nodes.new("ShaderNodeLightFalloff")
        node.inputs["Strength"].default_value, node.inputs["Smooth"].default_value = 0.7, 1.5
        tree.links.new(node.outputs[name], emission.inputs["Strength"])
    elif kind == "blackbody":
        node = tree.nodes.new("ShaderNodeBlackbody")
        node.inputs[0].default_value = float(name)
        tree.links.new(node.outputs[0], emission.inputs["Color"])
    else:  # a vector; shown in colours that are positive
        node, shift = tree.nodes.new(f"ShaderNode{kind}"), tree.nodes.new("ShaderNodeVectorMath")
        if kind == "Attribute":
            node.attribute_type, node.attribute_name, name = "OBJECT", name, "Color"
        tree.links.new(node.outputs[name], shift.inputs[0])
        shift.inputs[1].default_value = (3, 3, 3)
        tree.links.new(shift.outputs[0], emission.inputs["Color"])
    return emission.outputs[0]


def several(tree):
    """Two emissions added, and mixed with a third."""
    nodes = [tree.nodes.new("ShaderNodeEmission") for _ in range(3)]
    for node, color in zip(nodes, ((1, 0.2, 0.1, 1), (0.1, 1, 0.3, 1), (0.3, 0.2, 1, 1))):
        node.inputs["Color"].default_value = color
    added, mixed = tree.nodes.new("ShaderNodeAddShader"), tree.nodes.new("ShaderNodeMixShader")
    mixed.inputs[0].default_value = 0.3
    for source, target in zip((*nodes[:2], added, nodes[2]), (*added.inputs, *mixed.inputs[1:])):
        tree.links.new(source.outputs[0], target)
    return mixed.outputs[0]


def cases():
    """Name -> lamp, and what makes its emission."""
    found = {f"{lamp}, IES {name}": (lamp, "IES", name) for lamp, name in itertools.product(("point", "spot"), IES)}
    found["point, IES file"] = ("point", "IES file", "half")
    found["point, IES turned"] = ("point", "IES turned", "half")
    found["sun, IES"] = ("sun", "IES", "half")
    found["rectangle, IES"] = ("rectangle", "IES", "half")
    for lamp in LAMPS:
        # Since 4.0 lamps have UV coordinates, which Rayleaf names by a warning. A sun has no place.
        uv = () if bpy.app.version >= (4, 0, 0) else ("UV",)
        for name in ("Normal", *uv) + (("Object",) if lamp != "sun" else ()):
            found[f"{lamp}, coordinate {name}"] = (lamp, "TexCoord", name)
        for name in ("Normal", "Incoming") + (("Position",) if lamp != "sun" else ()):
            found[f"{lamp}, geometry {name}"] = (lamp, "NewGeometry", name)
    for name in ("Location", "Color", "Object Index", "Material Index", "Random"):
        found[f"point, object {name}"] = ("point", "ObjectInfo", name)
    for name in ("of lamp", "of object", "pass_index", "none"):
        found[f"point, property {name}"] = ("point", "Attribute", name)
    for name in ("Quadratic", "Linear", "Constant"):
        found[f"point, falloff {name}"] = ("point", "falloff", name)
        found[f"rectangle, falloff {name}"] = ("rectangle", "falloff", name)
    found["point, blackbody"] = ("point", "blackbody", "2700")
    found["spot, several"] = ("spot", "several", "")
    return found


def build():
    """A white floor seen from above."""
    scenes.empty_file()
    scene = bpy.context.scene
    both_engines.white_floor(4.0)
    both_engines.show_direct_light(scene, SIZE, SAMPLES)
    return scene


def add_lamp(lamp, kind, name):
    """A lamp above the floor, a little turned."""
    described = dict(LAMPS[lamp])
    data = bpy.data.lights.new("lamp", described.pop("type"))
    for key, value in described.items():
        setattr(data, key, value)
    data.use_nodes = True
    tree = data.node_tree
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputLight")
    made = several(tree) if kind == "several" else tint(tree, kind, name)
    tree.links.new(made, output.inputs[0])
    placed = scenes.add(data)
    data["of lamp"], placed["of object"] = (0.3, 0.6, 0.9), 0.7
    placed.color, placed.pass_index = (0.2, 0.5, 0.8, 0.6), 2
    placed.location, placed.rotation_euler = (0.3, 0.2, 1.6), (0.25, 0.15, 0.4)
    return placed


def picture(scene, engine, path):
    """Pixels by row, column, channel."""
    return both_engines.color(both_engines.channels(scene, engine, path))


# Nodes that bring an answer to the emission, which is compared where there are several.
_KINDS = (
    "TexIES",
    "LightFalloff",
    "Blackbody",
    "TexCoord",
    "NewGeometry",
    "ObjectInfo",
    "Attribute",
    "AddShader",
    "MixShader",
    "Emission",
)


def compared_nodes():
    """By case: the nodes as they are compared."""
    build()
    kinds, found = [f"ShaderNode{kind}" for kind in _KINDS], {}
    for case, described_lamp in cases().items():
        thing = add_lamp(*described_lamp)
        found[case] = described_nodes(thing.data.node_tree, kinds)
        bpy.data.objects.remove(thing)
    return found


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    scene_of_all, folder, pictures = build(), Path(sys.argv[1]), {}
    for case, described_lamp in cases().items():
        thing = add_lamp(*described_lamp)
        engines = ("CYCLES", "RAYLEAF")
        pictures[case] = [picture(scene_of_all, e, folder / "picture.exr").ravel().tolist() for e in engines]
        bpy.data.objects.remove(thing)
    report(pictures=pictures, version=bpy.app.version, nodes=compared_nodes())
