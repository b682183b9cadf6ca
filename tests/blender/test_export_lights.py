"""Lamps and worlds as the core gets them."""

from math import cos, pi

import pytest

START = """
import bpy, scenes, recording_core
scene = scenes.empty_scene()
"""


def test_lamps_of_every_kind_arrive_with_their_shape_and_strength(run_blender):
    run = run_blender(
        START
        + """
def lamp(kind, **settings):
    item = scenes.add(bpy.data.lights.new(kind, kind), settings.pop("name", kind))
    item.data.energy, item.data.color = 100, (1, 0.5, 0.25)
    for name, value in settings.items():
        setattr(item.data, name, value)
    return item

lamp("POINT", shadow_soft_size=0.25, use_shadow=False).location = (1, 2, 3)
lamp("SUN", angle=0.125)
lamp("SPOT", shadow_soft_size=0.5, spot_size=1.5, spot_blend=0.25)
for shape in ("SQUARE", "RECTANGLE", "DISK", "ELLIPSE"):
    lamp("AREA", name=shape, shape=shape, size=2, size_y=3, spread=1.25)
bpy.context.view_layer.update()
lamps = {lamp["name"]: lamp for lamp in recording_core.export()[0].lamps}
place = lamps["POINT"]["matrix"][:3, 3].tolist()
for lamp in lamps.values():
    del lamp["matrix"]
report(lamps=lamps, place=place, version=bpy.app.version[0])
"""
    ).report
    lamps = run["lamps"]
    assert run["place"] == [1, 2, 3]
    for name, lamp in lamps.items():
        # What the same powers mean since Blender 4: test_lamp_oracle.py compares it with Cycles.
        later = 1 if name in ("POINT", "SPOT") else 2 / (1 + cos(0.0625)) if name == "SUN" else 4 / pi
        factor = 1 if run["version"] < 4 else later
        assert lamp["strength"] == pytest.approx([100 * factor, 50 * factor, 25 * factor]), name
    assert lamps["SPOT"]["spot_profile"] == ("COSINE" if run["version"] < 4 else "EVEN")
    # Blender hides lamps from the camera, and has them shine in the footage of shadow catchers.
    assert all(lamp["visibility"] == 62 | 64 for lamp in lamps.values())
    assert (lamps["POINT"]["radius"], lamps["POINT"]["casts_shadow"], lamps["SUN"]["casts_shadow"]) == (
        0.25,
        False,
        True,
    )
    assert lamps["SUN"]["angle"] == 0.125
    assert [lamps["SPOT"][name] for name in ("radius", "spot_size", "spot_blend")] == [0.5, 1.5, 0.25]
    shapes = {name: (lamp["kind"], lamp["size_x"], lamp["size_y"]) for name, lamp in lamps.items() if "size_x" in lamp}
    assert shapes == {
        "SQUARE": ("RECTANGLE", 2, 2),
        "RECTANGLE": ("RECTANGLE", 2, 3),
        "DISK": ("DISK", 2, 2),
        "ELLIPSE": ("DISK", 2, 3),
    }
    assert lamps["DISK"]["spread"] == 1.25


def test_a_lamps_emission_node_multiplies_and_other_nodes_become_a_program(run_blender):
    run = run_blender(
        START
        + """
item = scenes.add(bpy.data.lights.new("Lamp", "POINT"), "Lamp")
item.data.energy, item.data.use_nodes = 10, True
node = item.data.node_tree.nodes["Emission"]
node.inputs["Color"].default_value, node.inputs["Strength"].default_value = (1, 0.5, 0, 1), 2
sent, _, texts = recording_core.export()
report(strength=sent.lamps[0]["strength"], program=sent.lamps[0]["emission"], texts=texts)
noise = item.data.node_tree.nodes.new("ShaderNodeTexNoise")
item.data.node_tree.links.new(noise.outputs["Color"], node.inputs["Color"])
sent, _, texts = recording_core.export()
report(whole=sent.lamps[0]["strength"], lines=[line["op"] for line in sent.lamps[0]["emission"].lines], more=texts)
"""
    ).report
    assert (run["strength"], run["program"], run["texts"]) == ([20, 10, 0], None, [])
    assert (run["whole"], run["more"]) == ([10, 10, 10], [])
    assert run["lines"][-1] == "emission" and "noise" in run["lines"]


def test_lamps_in_instanced_collections_shine_from_each_place(run_blender):
    run = run_blender(
        START
        + """
collection = bpy.data.collections.new("Lamps")
scenes.add(bpy.data.lights.new("Lamp", "POINT"), "Lamp", collection)
for x in (1, 2, 3):
    place = scenes.add(None, f"Place {x}")
    place.instance_type, place.instance_collection, place.location.x = "COLLECTION", collection, x
bpy.context.view_layer.update()
report(x=sorted(lamp["matrix"][0][3] for lamp in recording_core.export()[0].lamps))
"""
    ).report
    assert run["x"] == [1, 2, 3]


def test_worlds_with_nodes_without_and_none(run_blender):
    run = run_blender(
        START
        + """
def background(sent):
    return [round(x, 5) for value in sent.world.operands(sent.world.line("background")) for x in value]

report(none=recording_core.export()[0].world is None)
world = scenes.plain_world((0.25, 0.5, 0.75))
report(plain=background(recording_core.export()[0]))
world.use_nodes = True
node = world.node_tree.nodes["Background"]
node.inputs["Color"].default_value, node.inputs["Strength"].default_value = (0.5, 0.25, 1, 1), 3
report(nodes=background(recording_core.export()[0]))
"""
    ).report
    assert run["none"]
    assert run["plain"] == [1] * 4 + [0.25, 0.5, 0.75, 1] + [1] * 4
    assert run["nodes"] == [1] * 4 + [0.5, 0.25, 1, 1] + [3] * 4
