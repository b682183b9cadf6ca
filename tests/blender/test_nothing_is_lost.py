"""Nothing that is set in a file is lost without a word: it is rendered, or named by a message."""

import pytest

START = """
import bpy, numpy as np, scenes, recording_core
import property_walk as walk
scene = scenes.empty_scene()
core = recording_core.install()
"""

NODES = """
from functools import partial
from compiled_nodes import compiled, node as made, supported_kinds
from rayleaf.export.nodes import sky

# Thousands of small skies.
sky.sky_table, sky.whole_sky_table = (partial(table, width=16, height=8) for table in (sky.sky_table, sky.whole_sky_table))
images = [bpy.data.images.new(name, 4, 4) for name in "AB"]
place = scenes.add(None, "Place")
place.location = (1, 2, 3)
bpy.context.view_layer.update()
other_text = bpy.data.texts.new("D")

def look(node):
    "What each output of the node sends, and what is said of it."
    return [(vars(each.emitter.program), each.registers, each.names, each.wanted, each.texts) for each in compiled(core, node)]

def ramp(node):
    node.color_ramp.elements[0].color = (1, 0.5, 0.25, 0.5)
    return True

def curve(node):
    node.mapping.curves[0].points[0].location = (0.25, 0.5)
    return True

MAPPING = dict(translation=(1, 0, 0), rotation=(1, 0, 0), scale=(2, 1, 1), mapping_x="Y", use_min=True, mapping="CUBE")
OF_POINTERS = {
    "color_ramp": [walk.Change("color_ramp", "other", ramp)],
    "mapping": [walk.Change("mapping", "other", curve)],
    "texture_mapping": [walk.Change(f"texture_mapping.{key}", "other", walk.setter(f"texture_mapping.{key}", value))
                        for key, value in MAPPING.items()],
    "color_mapping": [],  # of the viewport alone
    "image_user": [],  # of sequences: test_export_images.py
    "sample_attribute_items": [],  # of Raycast: their outputs are named
}

def changes_of(kind):
    node, base = made(kind), bpy.types.ShaderNode
    shared = {prop.identifier for prop in base.bl_rna.properties}
    fixed = [prop.identifier for prop in node.bl_rna.properties if prop.is_readonly and prop.identifier not in shared]
    result = walk.property_changes(node, base, {"Image": images[1], "Object": place, "Text": other_text}) + walk.input_changes(node)
    return result + [change for name in fixed for change in OF_POINTERS[name]]

# Other settings of a node, under which others count than as it is made.
VARIANTS = {
    "ShaderNodeBsdfPrincipled": ["node.inputs[scenes.SUBSURFACE].default_value = 0.5"],
    "ShaderNodeTexSky": ["node.sky_type = 'PREETHAM'", "node.sky_type = 'HOSEK_WILKIE'", "node.altitude = 500.0"],
    "ShaderNodeBsdfHairPrincipled": [
        "node.parametrization = 'MELANIN'",
        "node.parametrization = 'ABSORPTION'",
        *(["node.model = 'HUANG'"] if "model" in bpy.types.ShaderNodeBsdfHairPrincipled.bl_rna.properties else []),
    ],
}

def has(kind, name):
    "Whether this Blender's node has a property or an input."
    return name in {change.name for change in changes_of(kind)}

def made_as(kind, variant):
    node = made(kind)
    exec(variant)
    return node

def unnoticed(kind):
    "What no variant of the node notices."
    found = None
    for variant in ["", *VARIANTS.get(kind, ())]:
        lost = walk.unnoticed(lambda: made_as(kind, variant), changes_of(kind), look, 2)
        names = {(change.name, change.value) for change in lost}
        found = names if found is None else found & names
    return sorted(found)

kinds = supported_kinds()
"""

_DISPERSION = "Transmission Dispersion"
# What counts only together with something that is named when it is set.
WITH_NAMED = {
    # Since 4.0 and later:
    ("ShaderNodeBsdfPrincipled", f"input {_DISPERSION} Abbe Number"): (f"input {_DISPERSION} Scale", "other"),
    **{("ShaderNodeBsdfGlass", f"input {name}"): ("input Anisotropy", "other") for name in ("Rotation", "Tangent")},
}
# What no renderer reads.
UNREAD = {
    **{f"input {name} Attribute": "of grids, which nothing that is rendered has" for name in ("Color", "Density")},
    "input Temperature Attribute": "the same",
    **{f"input {name}_Rotation": "of geometry nodes: shaders have no rotations" for name in "AB"},
    "input Weight": "hidden, and Blender's own",
    "input LightIndex": "of loops over lights, which are Eevee's",
    "active_index": "which of a Raycast's attributes the user interface shows",
    "use_alpha": "of the compositor's node, which shares the definition",
}


def test_every_property_and_input_of_every_node_is_rendered_or_named(run_blender):
    run = run_blender(
        START
        + NODES
        + f"""
lost = {{kind: [list(each) for each in unnoticed(kind)] for kind in kinds}}
there = [each for each in {sorted(WITH_NAMED)!r} if each[0] in kinds and has(*each)]
report(lost=lost, count=sum(len(changes_of(kind)) for kind in kinds), there=there)
""",
        timeout=300,  # hundreds of pictures
    ).report
    assert run["count"] > 350
    lost = {(kind, name) for kind, changes in run["lost"].items() for name, _ in changes if name not in UNREAD}
    assert lost == {tuple(each) for each in run["there"]}


def test_what_counts_only_with_something_unsupported_is_named_with_that(run_blender):
    run = run_blender(
        START
        + NODES
        + f"""
named = []
for kind, name, value in {sorted({(kind, *named) for (kind, _), named in WITH_NAMED.items()})!r}:
    if kind not in kinds or (name and not has(kind, name)):
        continue
    node = made(kind)
    if name:
        (change,) = [each for each in changes_of(kind) if (each.name, each.value) == (name, value)]
        assert change.apply(node)
    named.append([kind, sum(len(texts) for *_, texts in look(node))])
report(named=named)
"""
    ).report
    if not run["named"]:
        pytest.skip("this Blender has none of them")
    assert all(count > 0 for _, count in run["named"]), run["named"]


# What lamps have and Cycles does not read either: Eevee's, and what is left of older renderers.
NOT_OF_CYCLES = {
    *("specular_factor", "diffuse_factor", "volume_factor", "use_custom_distance", "cutoff_distance", "distance"),
    *("falloff_type", "linear_attenuation", "quadratic_attenuation", "constant_coefficient", "linear_coefficient"),
    *("quadratic_coefficient", "shadow_buffer_size", "shadow_buffer_clip_start", "shadow_buffer_bias"),
    *("shadow_buffer_samples", "shadow_color", "use_contact_shadow", "contact_shadow_distance", "contact_shadow_bias"),
    *("contact_shadow_thickness", "shadow_cascade_max_distance", "shadow_cascade_count", "shadow_cascade_exponent"),
    *("shadow_cascade_fade", "use_square"),
    # Since 4.2, of Eevee.
    *("shadow_filter_radius", "shadow_maximum_resolution", "use_absolute_resolution", "use_shadow_jitter"),
    *("shadow_jitter_overblur", "transmission_factor"),
}
NOT_LIGHT = {
    "show_cone": "of the viewport",
    "cycles.use_multiple_importance_sampling": "how Cycles samples",
    "cycles.is_caustics_light": "how Cycles samples",
}


def test_every_property_of_every_lamp_is_rendered_or_named(run_blender):
    run = run_blender(
        START
        + """
from rayleaf.export import lights
from rayleaf.messages import Messages
import addon_utils
addon_utils.enable("cycles")

def strength(lamp):
    lamp.node_tree.nodes["Emission"].inputs["Strength"].default_value = 3
    return True

def made(kind):
    lamp = bpy.data.lights.new("Lamp", kind)
    walk.keep_two(bpy.data.lights, lamp)
    lamp.use_nodes = True  # Blender makes the nodes
    lamp.use_nodes = False
    if kind == "AREA":
        lamp.size_y = 3
    return lamp

def look(lamp):
    if lights.is_portal(lamp):
        return "a portal"
    item, messages = bpy.data.objects.new("Lamp", lamp), Messages()
    sent = lights.describe(core, item, np.eye(4), 63, None, messages)
    bpy.data.objects.remove(item)
    return {**sent, "matrix": None, "name": ""}, [text.partition(": ")[2] for text in messages.texts]

lost = {}
for kind in ("POINT", "SUN", "SPOT", "AREA"):
    lamp = made(kind)
    changes = walk.property_changes(lamp, bpy.types.ID, {}) + [walk.Change("node_tree", "other", strength)]
    for prop in lamp.cycles.bl_rna.properties:
        if not prop.is_readonly and prop.identifier != "name":
            for value in walk.other_values(lamp.cycles, prop, {}):
                path = f"cycles.{prop.identifier}"
                changes.append(walk.Change(path, str(value), walk.setter(path, value)))
    lost[kind] = sorted({change.name for change in walk.unnoticed(lambda: made(kind), changes, look, 1)})
report(lost=lost)
"""
    ).report["lost"]
    portal = {"cycles.is_portal"}  # of area lamps alone
    for kind, names in run.items():
        known = NOT_OF_CYCLES | set(NOT_LIGHT) | (set() if kind == "AREA" else portal)
        assert set(names) - known == set(), kind
    assert "cycles.is_portal" not in run["AREA"]


def test_lamps_of_later_blenders_have_exposure_temperature_and_power_by_area(run_blender):
    run = run_blender(
        START
        + """
from types import SimpleNamespace
from rayleaf.export import lights
from rayleaf.messages import Messages
lamp = SimpleNamespace(type="POINT", color=(1, 0.5, 0.25), energy=100, use_nodes=False, use_shadow=True, shadow_soft_size=0.5,
                       exposure=2, use_temperature=True, temperature_color=(0.5, 1, 2), normalize=False, cycles=None)
messages = Messages()

def described():
    return lights.describe(core, SimpleNamespace(name="Lamp", data=lamp), np.eye(4), 63, None, messages)

by_area = described()["strength"]
lamp.normalize = True
sent = described()
lamp.use_temperature, lamp.exposure = False, 0
report(by_area=by_area, warm=sent["strength"], plain=described()["strength"],
       texts=messages.texts)
"""
    ).report
    assert run["warm"] == [200, 200, 200]
    assert run["plain"] == [100, 50, 25]
    assert all(abs(strength - 200 * 0.25 * 3.14159265) < 1e-4 for strength in run["by_area"])
    assert run["texts"] == []


def test_portals_do_not_shine_and_are_told_of(run_blender):
    run = run_blender(
        START
        + """
for name in ("Portal", "Lamp"):
    scenes.add(bpy.data.lights.new(name, "AREA"), name)
bpy.data.lights["Portal"].cycles.is_portal = True
sent, report_of_export, texts = recording_core.export()
report(lamps=[lamp["name"] for lamp in sent.lamps], texts=texts)
"""
    ).report
    assert run["lamps"] == ["Lamp"]
    assert len(run["texts"]) == 1 and "'Portal'" in run["texts"][0]


SETTINGS = {
    "knows no motion": (
        "scene.render.use_motion_blur = scene.rayleaf.use_irradiance_cache = True;"
        "scene.rayleaf.integrator = 'DISTRIBUTION'",
        "Scene 'Scene'",
    ),
    "the pass Shadow": ("layer.use_pass_shadow = True", "View layer 'ViewLayer'"),
    "shader AOV 'Rayleaf Mask'": ("layer.aovs.add().name = 'Rayleaf Mask'", "View layer 'ViewLayer'"),
    "knows no light groups": (
        "layer.lightgroups.add(name='Sun'); scene.rayleaf.integrator = 'DISTRIBUTION';"
        "scene.rayleaf.use_irradiance_cache = True",
        "View layer 'ViewLayer'",
    ),
    "shadow catchers": ("item.is_shadow_catcher = True; scene.rayleaf.integrator = 'DISTRIBUTION'", "Object 'Quad'"),
    "shading offset": ("scenes.set_shadow_terminator(item, 'SHADING', 0.1); item.update_tag()", "Object 'Quad'"),
}


def test_settings_of_scene_layer_object_material_and_world_are_named_with_what_they_belong_to(run_blender):
    run = run_blender(
        "import addon_utils, bpy, scenes, recording_core\n"
        + "found = {}\n"
        + f"for text, (line, _) in {SETTINGS!r}.items():"
        + """
    scene = scenes.empty_scene()
    addon_utils.enable("cycles")
    layer, item = bpy.context.view_layer, scenes.quad()
    material, tree, output = scenes.material()
    nodes, links = tree.nodes, tree.links
    item.data.materials.append(material)
    scene.world = bpy.data.worlds.new("World")
    assert recording_core.export()[2] == []
    exec(line)
    for each in (material, scene, scene.world):
        each.update_tag()
    layer.update()
    found[text] = recording_core.export()[2]
report(found=found)
"""
    ).report["found"]
    for text, (_, subject) in SETTINGS.items():
        assert len(run[text]) == 1, (text, run[text])
        assert run[text][0].startswith(f"{subject}: ") and text in run[text][0], (text, run[text])


def test_an_aov_node_writes_where_its_output_is_asked_for(run_blender):
    run = run_blender(
        START
        + """
item = scenes.quad()
material, tree, output = scenes.material()
item.data.materials.append(material)
inner = scenes.group("Group", "NodeSocketColor", "NodeSocketColor")
for owner, name in ((tree, "Own"), (inner, "Inside"), (tree, "Unasked")):
    scenes.set_aov(owner.nodes.new("ShaderNodeOutputAOV"), name)
tree.nodes.new("ShaderNodeGroup").node_tree = inner
for name in ("Own", "Inside"):
    bpy.context.view_layer.aovs.add().name = name
sent, _, texts = recording_core.export()
(program,) = [made for made in sent.materials if made["name"] == "Material"]
report(texts=texts, written=[line["ints"] for line in program["surface"].lines if line["op"] == "aov"])
"""
    ).report
    assert run["texts"] == []
    assert sorted(run["written"]) == [[0], [1]]


def test_a_view_layer_filters_the_scene_and_may_set_its_own_samples(run_blender):
    run = run_blender(
        START
        + """
scenes.quad("Ground")
hairy = scenes.quad("Hairy")
hairy.modifiers.new("Particles", "PARTICLE_SYSTEM")
hairy.particle_systems[0].settings.type, hairy.particle_systems[0].settings.count = "HAIR", 3
scene.world = bpy.data.worlds.new("World")
layer = bpy.context.view_layer
for name in ("use_sky", "use_solid", "use_strand"):
    setattr(layer, name, False)
    layer.update()
    sent = recording_core.export()[0]
    setattr(layer, name, True)
    report(**{name: [sorted(set(sent.instances["names"])), len(sent.meshes), len(sent.strands), sent.world is not None]})
layer.samples, scene.rayleaf.samples = 5, 7
bpy.ops.render.render()
counts = [core.Session.last.settings.samples]
layer.samples = 0
bpy.ops.render.render()
report(samples=[*counts, core.Session.last.settings.samples])
"""
    ).report
    assert run["use_sky"] == [["Ground", "Hairy"], 2, 1, False]
    assert run["use_solid"] == [["Hairy"], 0, 1, True]
    assert run["use_strand"] == [["Ground", "Hairy"], 2, 0, True]
    assert run["samples"] == [5, 7]
