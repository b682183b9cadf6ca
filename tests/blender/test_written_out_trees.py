"""Trees with switches, zones and closures, which Blender writes out before they are compiled."""

import pytest

# A material, a world and a lamp shine by the first of two strengths and by a node that is not supported.
SCRIPT = """
import bpy, scenes, recording_core
if not hasattr(bpy.types.Material, "inline_shader_nodes"):
    report(there=False)
    raise SystemExit
scene = scenes.empty_scene()

def shine(owner, shader_kind, output_kind):
    owner.use_nodes = True
    tree = owner.node_tree
    tree.nodes.clear()
    place, squeeze = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeSqueeze")
    switch, shader, output = (tree.nodes.new(kind) for kind in ("GeometryNodeMenuSwitch", shader_kind, output_kind))
    switch.data_type, squeeze.name = "FLOAT", "4_Squeezed"
    switch.inputs["A"].default_value, switch.inputs["B"].default_value = 3, 5
    tree.links.new(place.outputs["Object"], squeeze.inputs[0])
    tree.links.new(squeeze.outputs[0], shader.inputs["Color"])
    tree.links.new(switch.outputs[0], shader.inputs["Strength"])
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return owner

item, lamp = scenes.quad(), scenes.add(bpy.data.lights.new("Lamp", "POINT"), "Lamp")
item.data.materials.append(shine(bpy.data.materials.new("Glow"), "ShaderNodeEmission", "ShaderNodeOutputMaterial"))
scene.world = shine(bpy.data.worlds.new("Sky"), "ShaderNodeBackground", "ShaderNodeOutputWorld")
shine(lamp.data, "ShaderNodeEmission", "ShaderNodeOutputLight")
made, _, texts = recording_core.export()
programs = [(made.materials[0]["surface"], "emission"), (made.world, "background"), (made.lamps[0]["emission"], "emission")]
strengths = [program.operands(program.line(kind))[2] for program, kind in programs]
report(there=True, texts=texts, strengths=strengths)
"""


def test_switches_count_in_materials_worlds_and_lamps_and_messages_have_the_names_of_the_file(run_blender):
    run = run_blender(SCRIPT).report
    if not run["there"]:
        pytest.skip("came with Blender 5.0")
    assert [strength[0] for strength in run["strengths"]] == [3, 3, 3]
    owners = ["Light 'Lamp'", "Material 'Glow'", "World 'Sky'"]
    assert sorted(text.partition(":")[0] for text in run["texts"]) == [f"{each}, node '4_Squeezed'" for each in owners]
