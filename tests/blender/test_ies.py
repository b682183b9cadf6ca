"""Files of light distributions: what is wrong with one is said, and the lamp shines without."""

from tree_scripts import START

GOOD = "IESNA:LM-63-2002\nTILT=NONE\n1 1000 2.0 3 1 1 2 0 0 0\n1 0.5 60\n0 45 90\n0\n100 50 0\n"
WRONG = {
    "": "no line TILT",
    "\x00\xff nonsense": "no line TILT",
    "TILT=other.tlt\n1": "tilt lies in another file",
    "TILT=NONE\n": "ends before the lamps",
    "TILT=NONE\n1 1000 two": "'two' stands where the candela multiplier",
    "TILT=NONE\n1 1000 nan": "not finite",
    GOOD.replace("3 1 1 2", "1000000000 1 1 2"): "the number of vertical angles is 1e+09",
    GOOD.replace("3 1 1 2", "3 -1 1 2"): "the number of horizontal angles is -1",
    GOOD.replace("3 1 1 2", "3 1 2 2"): "photometric type is B",
    GOOD.replace("0 45 90\n", "0 90 45\n"): "vertical angles do not ascend",
    GOOD.replace("0 45 90\n", "10 45 90\n"): "vertical angles begin with 10",
    GOOD.replace("90\n0\n", "90\n45\n"): "horizontal angles begin with 45",
    GOOD.replace("100 50 0\n", "100 50\n"): "ends before an intensity",
}
SCRIPT = (
    START
    + """
lamp = bpy.data.lights.new("Lamp", "POINT")
scenes.add(lamp)
lamp.use_nodes = True
node, text = lamp.node_tree.nodes.new("ShaderNodeTexIES"), bpy.data.texts.new("file")
lamp.node_tree.links.new(node.outputs[0], lamp.node_tree.nodes["Emission"].inputs["Strength"])
node.ies = text

def sent():
    made, _, texts = recording_core.export()
    program = made.lamps[0]["emission"]
    return [line for line in program.lines if line["op"] == "ies"], texts
"""
)


def test_a_distribution_that_cannot_be_read_is_named_and_the_lamp_shines_alike_everywhere(run_blender):
    told = run_blender(
        SCRIPT
        + f"""
told = []
for content in {list(WRONG)!r}:
    text.clear()
    text.write(content)
    told.append(sent())
node.mode, node.filepath = "EXTERNAL", "//nowhere.ies"
told.append(sent())
report(told=told)
"""
    ).report["told"]
    for (lines, texts), wanted in zip(told, [*WRONG.values(), "No such file"], strict=True):
        assert lines == [] and len(texts) == 1
        assert "'Lamp'" in texts[0] and "'IES Texture'" in texts[0] and wanted in texts[0], (texts, wanted)


def test_a_distribution_becomes_a_table_all_around(run_blender):
    lines, texts = run_blender(SCRIPT + f"text.write({GOOD!r})\nreport(sent=sent())").report["sent"]
    assert texts == []
    floats = lines[0]["floats"]
    assert floats[:4] == [3, 2, 0, 0] and len(floats) % 4 == 0
    watts = 0.0706650768394 * 2.0 * 0.5
    half_turn = 3.14159265
    expected = [0, half_turn / 4, half_turn / 2, 0, 2 * half_turn] + [100 * watts, 50 * watts, 0.0] * 2
    assert all(abs(a - b) < 1e-6 for a, b in zip(floats[4:15], expected, strict=True))
