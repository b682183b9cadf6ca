"""What stands for nodes, modes and sockets that are not supported: as little as can be is replaced, and named."""

from tree_scripts import START, run_tree


def test_a_volume_alone_has_no_surface_and_shaders_count_only_where_they_belong(run_blender):
    run = run_blender(
        START
        + """
def sent():
    made, _, texts = recording_core.export()
    programs = [made.materials[0][name] for name in ("surface", "medium")]
    return [None if each is None else [line["op"] for line in each.lines] for each in programs], texts

volume, diffuse = nodes.new("ShaderNodeVolumeAbsorption"), nodes.new("ShaderNodeBsdfDiffuse")
links.new(volume.outputs[0], output.inputs["Volume"])
report(alone=sent())
emission(tree, output)
report(beside=sent())
links.new(volume.outputs[0], output.inputs["Surface"])
links.new(diffuse.outputs[0], output.inputs["Volume"])
report(swapped=sent())
"""
    ).report
    assert run["alone"] == [[None, ["volume_absorption"]], []]
    assert run["beside"] == [[["emission"], ["volume_absorption"]], []]
    assert run["swapped"] == [[[], []], []]


def test_an_unknown_node_passes_on_what_is_linked_or_written_to_an_input_of_its_type(run_blender):
    told = run_tree(
        run_blender,
        """
forget("ShaderNodeVectorRotate", "ShaderNodeTexBrick", "ShaderNodeBump")
rotate, place = nodes.new("ShaderNodeVectorRotate"), nodes.new("ShaderNodeTexCoord")
checker, brick = nodes.new("ShaderNodeTexChecker"), nodes.new("ShaderNodeTexBrick")
links.new(place.outputs["Object"], rotate.inputs["Vector"])
links.new(rotate.outputs[0], checker.inputs["Vector"])
brick.inputs["Color1"].default_value = (0.25, 0.5, 0.75, 1)
links.new(brick.outputs["Color"], checker.inputs["Color1"])
links.new(checker.outputs["Color"], shader.inputs["Color"])
bump = nodes.new("ShaderNodeBump")
links.new(bump.outputs[0], shader.inputs["Strength"])
""",
    )
    vector, color = told["color"][3:5]
    assert vector == ["object_coordinates", "", []]
    assert color == [0.25, 0.5, 0.75, 1]
    assert told["strength"] == ["average", "", [], ["normal", "", []]]
    assert sorted(text.split("'")[3] for text in told["texts"]) == ["Brick Texture", "Bump", "Vector Rotate"]


def test_an_unknown_vector_of_its_own_is_a_texture_coordinate_not_one_point(run_blender):
    told = run_tree(
        run_blender,
        """
forget("ShaderNodeParticleInfo")
particle = nodes.new("ShaderNodeParticleInfo")
links.new(particle.outputs["Velocity"], shader.inputs["Color"])
""",
    )
    assert told["color"] == ["generated", "", []]
    assert len(told["texts"]) == 1


UNKNOWN_MODES = """
from rayleaf.export.nodes import compiler

def with_unknown(kind):
    "Makes the core refuse an operation of the node, as it does for what a later Blender brings."
    whole = core.Program.operation
    def refuse(self, identifier, operands=(), ints=(), floats=(), text=""):
        if identifier == kind:
            raise core.InputError(f"text of '{kind}' is 'NEW'")
        return whole(self, identifier, operands, ints, floats, text)
    core.Program.operation = refuse

core = recording_core.install()
"""


def test_an_unknown_mode_of_a_known_node_takes_only_that_node_with_it(run_blender):
    run = run_blender(
        START
        + UNKNOWN_MODES
        + """
recording_core.install = lambda: core
shader, mixing = emission(tree, output), nodes.new("ShaderNodeMixRGB")
mixing.inputs["Color1"].default_value = (0.25, 0.5, 0.75, 1)
links.new(mixing.outputs[0], shader.inputs["Color"])
shader.inputs["Strength"].default_value = 3
with_unknown("mix")
program, texts = compiled()
_, color, strength = program.operands(program.line("emission"))
report(color=told(color), strength=told(strength), texts=texts)
glossy = nodes.new("ShaderNodeBsdfGlossy")
glossy.inputs["Color"].default_value = (1, 0.5, 0.25, 1)
links.new(glossy.outputs[0], output.inputs["Surface"])
with_unknown("glossy")
program, texts = compiled()
report(diffuse=told(program.operands(program.line("diffuse"))[1]), shader_texts=texts)
"""
    ).report
    assert (run["color"], run["strength"]) == ([0.25, 0.5, 0.75, 1], [3] * 4)
    assert run["diffuse"] == [1, 0.5, 0.25, 1]
    for texts, node in ((run["texts"], "Mix"), (run["shader_texts"], "Glossy BSDF")):
        assert len(texts) == 1 and node in texts[0] and "a mode of it is not supported" in texts[0]
