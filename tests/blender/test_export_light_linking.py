"""Light linking: collections of objects as the sets of lights and instances that the core gets, whatever the Blender."""

import pytest

# Blender before 4.0 has no such collections: here are some for all versions.
START = """
import bpy, scenes, recording_core
from types import SimpleNamespace
from rayleaf import versions
from rayleaf.export.light_linking import LightLinks
scene = scenes.empty_scene()
links = {}  # by name of an object: what it lights and what casts its shadows

def chosen(*entries):
    made = SimpleNamespace(entries=[(bpy.data.objects[each[1:]], each[0] == "+") for each in entries])
    made.original, made.as_pointer = made, lambda: id(made)
    return made

versions.light_collections = lambda item: links.get(item.name, (None, None))
versions.linked_objects = lambda collection: collection.entries

def lamp(name):
    return scenes.add(bpy.data.lights.new(name, "POINT"), name)

def exported():
    bpy.context.view_layer.update()
    sent, _, texts = recording_core.export()
    lamps = {each["name"]: each["link"] for each in sent.lamps}
    rows = dict(zip(sent.instances["names"], sent.instances["linkings"]))
    return dict(lamps=lamps, rows=rows, texts=texts)
"""
ANY, ALL_BLOCK = (1 << 63) - 1, (1 << 24) - 1


def test_objects_know_the_sets_that_they_are_in(run_blender):
    run = run_blender(
        START
        + """
for name in ("A", "B", "C"):
    scenes.quad(name)
for name in ("Included", "Excluded", "Both", "Like Included", "Plain", "Empty"):
    lamp(name)
links["Included"] = (chosen("+A", "+B"), None)
links["Excluded"] = (chosen("-A"), chosen("-B"))
links["Both"] = (chosen("+A", "+B", "-B"), None)
links["Like Included"] = (chosen("+B", "+A"), chosen("+C"))
links["Empty"] = (chosen(), None)
links["C"] = (None, chosen("-B"))
report(**exported())
"""
    ).report
    lamps, rows = run["lamps"], run["rows"]
    assert run["texts"] == []
    assert lamps["Plain"] == lamps["Empty"] == [-1, -1]
    assert lamps["Included"][0] == lamps["Like Included"][0] and lamps["Included"][1] == -1
    assert len({lamps[name][0] for name in ("Included", "Excluded", "Both")}) == 3
    assert rows["C"][2:] == [-1, lamps["Excluded"][1]] and rows["A"][2:] == rows["B"][2:] == [-1, -1]

    def lit(name):
        return {lamp for lamp in ("Included", "Excluded", "Both") if rows[name][0] >> lamps[lamp][0] & 1}

    def shades(name):
        return {lamp for lamp in ("Excluded", "Like Included") if rows[name][1] >> lamps[lamp][1] & 1}

    assert (lit("A"), lit("B"), lit("C")) == ({"Included", "Both"}, {"Included", "Excluded"}, {"Excluded"})
    assert (shades("A"), shades("B"), shades("C")) == ({"Excluded"}, set(), {"Excluded", "Like Included"})
    for row in rows.values():  # sets that nobody has are no reason to differ
        assert row[0] >> 3 == ANY >> 3 and row[1] >> 2 == ALL_BLOCK >> 2


def test_without_links_nothing_is_said_of_them(run_blender):
    run = run_blender(START + "scenes.quad('A'); lamp('Lamp'); report(**exported())").report
    assert run == {"lamps": {"Lamp": [-1, -1]}, "rows": {"A": None}, "texts": []}


def test_what_an_object_makes_is_lit_as_that_object_where_it_is_chosen(run_blender):
    run = run_blender(
        START
        + """
leaf = scenes.quad("Leaf")
tree = bpy.data.collections.new("Tree")
tree.objects.link(leaf)
for name in ("One", "Two"):
    place = scenes.add(None, name)
    place.instance_type, place.instance_collection = "COLLECTION", tree
lamp("Lamp")
links["Lamp"] = (chosen("+Two"), None)
bpy.context.view_layer.update()
sent = recording_core.export()[0]
report(lit=sorted(row[0] & 1 for row in sent.instances["linkings"]), shapes=len(set(sent.instances["shapes"])))
links["Lamp"] = (chosen("+Leaf"), None)
sent = recording_core.export()[0]
report(all=[row[0] & 1 for row in sent.instances["linkings"]])
"""
    ).report
    assert run == {"lit": [0, 0, 1], "shapes": 1, "all": [1, 1, 1]}


@pytest.mark.parametrize("which, most", [(0, 63), (1, 24)])
def test_more_sets_than_there_are_bits_for_are_named_and_unlinked(run_blender, which, most):
    run = run_blender(
        START
        + f"""
which, most = {which}, {most}
for number in range(most + 2):
    scenes.quad(f"Quad {{number:02}}")
    lamp(f"Lamp {{number:02}}")
    found = chosen(f"+Quad {{number:02}}")
    links[f"Lamp {{number:02}}"] = (found, None) if which == 0 else (None, found)
report(**exported())
"""
    ).report
    unlinked = [name for name, link in run["lamps"].items() if link == [-1, -1]]
    assert len(unlinked) == 2 and len(run["texts"]) == 2
    assert all(any(f"'{name}'" in text and str(most) in text for text in run["texts"]) for name in unlinked)
    assert sorted(link[which] for link in run["lamps"].values())[2:] == list(range(most))


def test_links_that_changed_are_other_links(run_blender):
    run = run_blender(
        START
        + """
scenes.quad("A")
lamp("Lamp")
kept = []
for collection in (None, chosen("+A"), chosen("+A"), chosen("-A"), chosen()):
    links["Lamp"] = (collection, None)
    kept.append(LightLinks.of(bpy.data.objects))
report(same=[kept[0] == each for each in kept], included=[kept[1] == each for each in kept])
"""
    ).report
    assert run == {"same": [True, False, False, False, True], "included": [False, True, True, False, False]}
