"""Node trees as programs: what each node becomes, conversions, groups, loops, and what is not supported."""

import pytest
from tree_scripts import START, run_tree


def test_implicit_conversions_are_blenders(run_blender):
    told = run_tree(
        run_blender,
        """
rgb, normal = nodes.new("ShaderNodeRGB"), nodes.new("ShaderNodeNewGeometry")
rgb.outputs[0].default_value = (0.25, 0.5, 0.75, 1)
math = nodes.new("ShaderNodeMath")
links.new(rgb.outputs[0], math.inputs[0])
links.new(normal.outputs["Normal"], math.inputs[1])
links.new(math.outputs[0], shader.inputs["Color"])
""",
    )
    luminance, average = ["luminance", "", [], [0.25, 0.5, 0.75, 1]], ["average", "", [], ["normal", "", []]]
    assert told["color"] == ["math", "ADD", [0], luminance, average]
    assert told["strength"] == [1, 1, 1, 1]
    assert told["texts"] == []


def test_nested_groups_reroutes_and_muted_nodes_pass_values_on(run_blender):
    told = run_tree(
        run_blender,
        """
inner = scenes.group("Inner", "NodeSocketColor", "NodeSocketFloat")
a, b = inner.nodes.new("NodeGroupInput"), inner.nodes.new("NodeGroupOutput")
inner.links.new(a.outputs[0], b.inputs[0])
outer = scenes.group("Outer", "NodeSocketColor", "NodeSocketColor")
a, b, group = outer.nodes.new("NodeGroupInput"), outer.nodes.new("NodeGroupOutput"), outer.nodes.new("ShaderNodeGroup")
group.node_tree = inner
outer.links.new(a.outputs[0], group.inputs[0])
outer.links.new(group.outputs[0], b.inputs[0])
group, reroute, muted = nodes.new("ShaderNodeGroup"), nodes.new("NodeReroute"), nodes.new("ShaderNodeGamma")
group.node_tree, muted.mute = outer, True
rgb = nodes.new("ShaderNodeRGB")
rgb.outputs[0].default_value = (1, 2, 3, 1)
links.new(rgb.outputs[0], group.inputs[0])
links.new(group.outputs[0], reroute.inputs[0])
links.new(reroute.outputs[0], muted.inputs["Color"])
links.new(muted.outputs[0], shader.inputs["Color"])
second = nodes.new("ShaderNodeGroup")
second.node_tree = outer
second.inputs[0].default_value = (0.5, 0.5, 0.5, 1)
links.new(second.outputs[0], shader.inputs["Strength"])
""",
    )
    assert told["color"] == ["luminance", "", [], [1, 2, 3, 1]]
    assert told["strength"][:3] == ["luminance", "", []]
    assert told["texts"] == []


def test_mix_and_add_shaders_multiply_into_the_weights(run_blender):
    run = run_blender(
        START
        + """
diffuse, glass, transparent = (nodes.new(f"ShaderNodeBsdf{kind}") for kind in ("Diffuse", "Glass", "Transparent"))
mix, add, layer = nodes.new("ShaderNodeMixShader"), nodes.new("ShaderNodeAddShader"), nodes.new("ShaderNodeLayerWeight")
mix.inputs[0].default_value = 0.25
links.new(diffuse.outputs[0], mix.inputs[1])
links.new(glass.outputs[0], mix.inputs[2])
links.new(mix.outputs[0], add.inputs[0])
links.new(mix.outputs[0], add.inputs[1])
second = nodes.new("ShaderNodeMixShader")
links.new(layer.outputs["Facing"], second.inputs[0])
links.new(add.outputs[0], second.inputs[1])
links.new(transparent.outputs[0], second.inputs[2])
links.new(second.outputs[0], output.inputs["Surface"])
program, texts = compiled()
report(**{kind: told(program.operands(program.line(kind))[0]) for kind in ("diffuse", "glass", "transparent")}, texts=texts)
"""
    ).report
    facing = ["clamp", "MINMAX", [], ["layer_weight", "FACING", [], [0.5] * 4, None], [0] * 4, [1] * 4]
    rest = ["math", "SUBTRACT", [0], [1] * 4, facing]
    twice = ["math", "ADD", [0], rest, rest]
    assert run["transparent"] == facing
    assert run["diffuse"] == ["math", "MULTIPLY", [0], twice, [0.75] * 4]
    assert run["glass"] == ["math", "MULTIPLY", [0], twice, [0.25] * 4]
    assert run["texts"] == []


def test_a_shader_behind_a_factor_of_zero_is_not_compiled(run_blender):
    run = run_blender(
        START
        + """
diffuse, glass, mix = nodes.new("ShaderNodeBsdfDiffuse"), nodes.new("ShaderNodeBsdfGlass"), nodes.new("ShaderNodeMixShader")
mix.inputs[0].default_value = 0
links.new(diffuse.outputs[0], mix.inputs[1])
links.new(glass.outputs[0], mix.inputs[2])
links.new(mix.outputs[0], output.inputs["Surface"])
program, _ = compiled()
report(operations=[line["op"] for line in program.lines])
"""
    ).report
    assert run["operations"] == ["diffuse"]


def test_a_value_in_a_shader_socket_shines(run_blender):
    told = run_tree(
        run_blender,
        """
nodes.remove(shader)
rgb = nodes.new("ShaderNodeRGB")
rgb.outputs[0].default_value = (1, 2, 3, 1)
links.new(rgb.outputs[0], output.inputs["Surface"])
""",
    )
    assert (told["color"], told["strength"]) == ([1, 2, 3, 1], [1, 1, 1, 1])


def test_an_unsupported_node_gives_one_message_and_a_neutral_value(run_blender):
    told = run_tree(
        run_blender,
        """
forget("ShaderNodeTexWave")
wave = nodes.new("ShaderNodeTexWave")
wave.name = "My Wave"
links.new(wave.outputs["Color"], shader.inputs["Color"])
links.new(wave.outputs["Fac"], shader.inputs["Strength"])
""",
    )
    assert told["color"] == told["strength"] == [0.5] * 4
    (text,) = told["texts"]
    assert "'Material'" in text and "'My Wave'" in text and "not supported" in text


def test_an_unsupported_shader_is_rendered_diffuse_in_its_colour(run_blender):
    run = run_blender(
        START
        + """
forget("ShaderNodeBsdfToon")
toon = nodes.new("ShaderNodeBsdfToon")
toon.inputs["Color"].default_value = (1, 0.5, 0.25, 1)
links.new(toon.outputs[0], output.inputs["Surface"])
program, texts = compiled()
report(color=told(program.operands(program.line("diffuse"))[1]), texts=texts)
"""
    ).report
    assert run["color"] == [1, 0.5, 0.25, 1]
    assert len(run["texts"]) == 1 and "'Toon BSDF'" in run["texts"][0]


@pytest.mark.parametrize("kind", ["value", "shader"])
def test_a_loop_of_nodes_is_named_and_the_rest_compiles(run_blender, kind):
    lines = {
        "value": """
shader = emission(tree, output)
a, b = nodes.new("ShaderNodeMath"), nodes.new("ShaderNodeMath")
links.new(a.outputs[0], b.inputs[0])
links.new(b.outputs[0], a.inputs[0])
links.new(a.outputs[0], shader.inputs["Strength"])
""",
        "shader": """
a, b, shader = nodes.new("ShaderNodeMixShader"), nodes.new("ShaderNodeMixShader"), nodes.new("ShaderNodeEmission")
links.new(a.outputs[0], b.inputs[1])
links.new(b.outputs[0], a.inputs[1])
links.new(shader.outputs[0], a.inputs[2])
links.new(a.outputs[0], output.inputs["Surface"])
""",
    }[kind]
    run = run_blender(
        START
        + lines
        + """
program, texts = compiled()
report(operations=[line["op"] for line in program.lines], texts=texts)
"""
    ).report
    assert "emission" in run["operations"]
    (text,) = run["texts"]
    assert "'Material'" in text and "loop" in text


def test_a_material_without_nodes_is_its_viewport_colour_and_an_empty_tree_is_black(run_blender):
    run = run_blender(
        START
        + """
plain = bpy.data.materials.new("Plain")
plain.diffuse_color, plain.pass_index = (0.25, 0.5, 0.75, 1), 9
if plain.use_nodes:  # since 5.0 always
    shader = scenes.diffuse_alone(plain.node_tree)
    shader.inputs["Color"].default_value = plain.diffuse_color
item.data.materials.append(plain)
item.data.materials.append(None)
sent, _, texts = recording_core.export()
program = sent.materials[1]["surface"]
bare = len(sent.materials) - 1 if bpy.app.version >= (5, 0, 0) else -1  # since 5.0 what has no material is Principled
report(plain=told(program.operands(program.line("diffuse"))[1]), empty=sent.materials[0]["surface"].lines,
       index=sent.materials[1]["pass_index"], slots=sent.material_lists, bare=bare, texts=texts)
"""
    ).report
    assert run["plain"] == [0.25, 0.5, 0.75, 1]
    assert run["empty"] == []
    assert run["index"] == 9
    assert run["slots"] == [[0, 1, run["bare"]]]
    assert run["texts"] == []


PRINCIPLED = """
node = nodes.new("ShaderNodeBsdfPrincipled")
links.new(node.outputs[0], output.inputs["Surface"])
numbers = [each for each in node.inputs if each.type == "VALUE" and each.name in NAMES]
for number, each in enumerate(numbers):
    each.default_value = (number + 1) / 32
program, texts = compiled()
operands = program.operands(program.line(OPERATION))
compared = [(value, each) for name, value in zip(NAMES, operands) for each in numbers if each.name == name]
wrong = [each.name for value, each in compared if abs(value[0] - each.default_value) > 1e-6]
report(count=len(operands), compared=len(compared), wrong=wrong, unlinked=[operands[NAMES.index(n)] for n in NORMALS],
       texts=texts, tangent=told(operands[NAMES.index("Tangent")]))
node.inputs[scenes.SUBSURFACE].default_value = 0.5
found = {}
for method in node.bl_rna.properties["subsurface_method"].enum_items.keys():
    node.subsurface_method = method
    program, texts = compiled()
    line = program.line(OPERATION)
    found[method] = [program.operands(line)[len(NAMES)][0], len(line["operands"]), line["ints"], len(texts)]
report(found=found, version=bpy.app.version)
"""
DISNEY = [
    *("weight", "Base Color", "Metallic", "Specular", "Specular Tint", "Roughness", "Anisotropic"),
    *("Anisotropic Rotation", "Sheen", "Sheen Tint", "Clearcoat", "Clearcoat Roughness", "IOR", "Transmission"),
    *("Transmission Roughness", "Emission", "Emission Strength", "Alpha", "Normal", "Clearcoat Normal", "Tangent"),
]
LAYERS = [
    *("weight", "Base Color", "Metallic", "Specular IOR Level", "Specular Tint", "Roughness", "Anisotropic"),
    *("Anisotropic Rotation", "Sheen Weight", "Sheen Roughness", "Sheen Tint", "Coat Weight", "Coat Roughness"),
    *("Coat IOR", "Coat Tint", "Emission Color", "Emission Strength", "Alpha", "IOR", "Transmission Weight"),
    *("Normal", "Coat Normal", "Tangent", "Diffuse Roughness"),
]


def test_principled_takes_its_sockets_by_name_and_those_of_subsurface_scattering_where_it_has_a_share(run_blender):
    has_layers = run_blender("import bpy\nreport(found=bpy.app.version >= (4, 0, 0))").report["found"]
    names, operation = (LAYERS, "principled_layers") if has_layers else (DISNEY, "principled")
    normals = [name for name in names if name.endswith("Normal")]
    run = run_blender(
        START + f"NAMES, OPERATION, NORMALS = {names!r}, {operation!r}, {normals!r}\n" + PRINCIPLED
    ).report
    assert run["count"] == len(names)
    assert run["compared"] >= 14
    assert run["wrong"] == []
    assert run["unlinked"] == [None, None]
    assert run["tangent"] == ["radial_tangent", "", [2]]  # Blender's own, around the object
    assert run["texts"] == []
    count = len(names) + (4 if has_layers else 5)  # layers have no colour of their own below the surface
    version = tuple(run["version"])
    more = [int(version < (5, 0)), int(version >= (5, 0)), int(version >= (4, 5))] if has_layers else []
    assert run["found"]["BURLEY"] == [0.5, count, [3, *more], 0]
    walk = [0.5, count, [0 if has_layers else 1, *more], 0]
    legacy = run["found"].get("RANDOM_WALK_LEGACY")  # 5.2, where the plain one is another
    assert legacy in (None, walk) and run["found"]["RANDOM_WALK"] == (
        walk if legacy is None else [0.5, count, [2, *more], 0]
    )


def test_ramps_and_curves_become_tables_of_blenders_own_values(run_blender):
    run = run_blender(
        START
        + """
shader = emission(tree, output)
ramp, curves, value = nodes.new("ShaderNodeValToRGB"), nodes.new("ShaderNodeRGBCurve"), nodes.new("ShaderNodeFloatCurve")
ramp.color_ramp.elements[0].color = (1, 0, 0, 0.5)
point = curves.mapping.curves[1].points.new(0.5, 0.9)
curves.mapping.update()
links.new(ramp.outputs["Color"], curves.inputs["Color"])
links.new(curves.outputs[0], shader.inputs["Color"])
links.new(ramp.outputs["Alpha"], shader.inputs["Strength"])
program, texts = compiled()
tables = [line for line in program.lines if line["op"] == "table"]
table_of_ramp, table_of_curves = tables[0], tables[1]
report(sizes=[len(line["floats"]) for line in tables], ramp=table_of_ramp["floats"][:4], texts=texts,
       middle=table_of_curves["floats"][4 * 128 : 4 * 128 + 3], interpolate=table_of_ramp["ints"],
       expected=[curves.mapping.evaluate(c, curves.mapping.evaluate(curves.mapping.curves[3], 128 / 255))
                 for c in list(curves.mapping.curves)[:3]])
ramp.color_ramp.interpolation = "CONSTANT"
program, _ = compiled()
report(constant=next(line for line in program.lines if line["op"] == "table")["ints"])
"""
    ).report
    assert set(run["sizes"]) == {1024}
    assert run["ramp"] == [1, 0, 0, 0.5]
    assert run["middle"] == pytest.approx(run["expected"], abs=1e-6)
    assert (run["interpolate"], run["constant"]) == ([1], [0])


def test_blenders_own_spaces_of_normal_maps_turn_two_axes(run_blender):
    told = run_tree(
        run_blender,
        """
node = nodes.new("ShaderNodeNormalMap")
node.space = "BLENDER_OBJECT"
node.inputs["Color"].default_value = (0.25, 0.5, 1, 1)
links.new(node.outputs[0], shader.inputs["Color"])
""",
    )
    operation, text, ints, strength, color = told["color"]
    assert (operation, text, ints, strength) == ("normal_map", "OBJECT", [-1], [1] * 4)
    assert color == ["combine", "", [], [0.25] * 4, [0.5] * 4, [0] * 4]


def test_the_ways_in_which_images_go_on_are_those_of_blender_and_of_the_core(run_blender):
    run = run_blender(
        """
import bpy
from rayleaf import _core
from rayleaf.export.nodes import textures
of_node = {item.identifier for item in bpy.types.ShaderNodeTexImage.bl_rna.properties["extension"].enum_items}
report(unknown=sorted(of_node - set(textures._EXTENSIONS)),
       core={name: int(getattr(_core.shading.Extension, name)) for name in textures._EXTENSIONS}, sent=textures._EXTENSIONS)
"""
    ).report
    assert run["unknown"] == []
    assert run["core"] == run["sent"]
    assert "MIRROR" in run["sent"]
