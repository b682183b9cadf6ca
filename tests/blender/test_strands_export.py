"""Hair as strands: particle hair and hair curves, their radii and what shading reads of them."""

import numpy as np
import pytest

HAIR = """
import bpy, scenes, recording_core
import numpy as np

recording_core.install()
scene = scenes.empty_scene()
scene.render.resolution_x = scene.render.resolution_y = 4

def rendered():
    # What a render sends: only there children and steps are those of a render.
    bpy.ops.render.render()
    return recording_core.RECORDED[-1]

def hairy(count=20, children=0):
    item = scenes.quad("Scalp")
    item.location, item.rotation_euler, item.scale = (1, 2, 3), (0.3, 0.2, 0.1), (2, 2, 2)
    item.modifiers.new("Hair", "PARTICLE_SYSTEM")
    settings = item.particle_systems[0].settings
    settings.type, settings.count, settings.hair_length, settings.render_step = "HAIR", count, 0.5, 2
    settings.root_radius, settings.tip_radius, settings.radius_scale = 1.0, 0.5, 0.1
    if children:
        settings.child_type, settings.rendered_child_count = "SIMPLE", children
    return item, settings

def told(strands):
    return {key: value.tolist() if hasattr(value, "tolist") else value for key, value in strands.items()
            if key not in ("attributes", "point_attributes")}
"""


def test_particle_hair_arrives_in_object_space_with_its_radii(run_blender):
    run = run_blender(
        HAIR
        + """
hairy()
(sent,) = rendered().strands
report(sent=told(sent))
"""
    )
    sent = run.report["sent"]
    points, radii = np.array(sent["points"]).reshape(20, 5, 3), np.array(sent["radii"]).reshape(20, 5)
    assert sent["offsets"] == list(range(0, 101, 5)) and sent["form"] == "ROUND" and sent["basis"] == "CATMULL_ROM"
    # Roots on the unit square in its own space; the hair is a quarter long there (half in the world, scale 2).
    assert np.abs(points[:, 0, 2]).max() < 1e-6 and points[:, 0, :2].min() >= 0 and points[:, 0, :2].max() <= 1
    assert np.allclose(points[:, -1, 2], 0.25, atol=1e-5)
    # Half the diameters, evenly along the length from root to tip, and closed there.
    shares = points[:, :4, 2] / points[:, 4:, 2]
    assert np.allclose(radii[:, :4], 0.05 - 0.025 * shares, atol=1e-5) and np.all(radii[:, 4] == 0)


def test_children_are_rendered_instead_of_their_parents(run_blender):
    run = run_blender(
        HAIR
        + """
item, settings = hairy(10, 7)
counts = [len(rendered().strands[0]["offsets"]) - 1]
settings.use_parent_particles = True
counts.append(len(rendered().strands[0]["offsets"]) - 1)
report(counts=counts)
"""
    )
    assert run.report["counts"] == [70, 80]


def test_children_that_are_cut_end_where_they_are_cut(run_blender):
    run = run_blender(
        HAIR
        + """
item, settings = hairy(10, 7)
settings.render_step = 4
settings.child_length = 0.4
(sent,) = rendered().strands
report(sent=told(sent))
"""
    )
    points, radii = (np.array(run.report["sent"][name]) for name in ("points", "radii"))
    points, radii = points.reshape(70, 17, 3), radii.reshape(70, 17)
    # Blender says that the points beyond the cut lie at the world's origin, which is far from here.
    along = np.linalg.norm(np.diff(points, axis=1), axis=2)
    assert 0.05 < along.sum(axis=1).min() and along.sum(axis=1).max() < 0.2  # of 0.25
    assert (along[:, -1] == 0.0).all() and np.linalg.norm(points - points[:, :1], axis=2).max() < 0.2
    assert np.allclose(radii[:, 0], 0.05) and np.all(radii[:, -1] == 0)
    np.testing.assert_allclose(radii[:, 5], 0.05 - 0.025 * along[:, :5].sum(axis=1) / along.sum(axis=1), atol=2e-3)


def test_hair_is_rendered_though_its_emitter_is_not(run_blender):
    run = run_blender(
        HAIR
        + """
item, settings = hairy()
item.show_instancer_for_render = False
recorded = rendered()
report(kinds=[kind for kind, _ in recorded.shapes], instances=recorded.instances["names"])
"""
    )
    assert run.report == {"kinds": ["strands"], "instances": ["Scalp"]}


def test_a_strand_carries_the_uv_and_colour_of_its_root(run_blender):
    run = run_blender(
        HAIR
        + """
item, settings = hairy()
colors = item.data.vertex_colors.new(name="Col")
for loop, color in zip(colors.data, [(0, 0, 0, 1), (1, 0, 0, 1), (1, 1, 0, 1), (0, 1, 0, 1)]):
    loop.color = color
material, tree, output = scenes.material()
item.data.materials.append(material)
diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
tree.links.new(diffuse.outputs[0], output.inputs[0])
mix, uv, color = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("MixRGB", "UVMap", "VertexColor"))
uv.uv_map, color.layer_name = "UVMap", "Col"
tree.links.new(uv.outputs[0], mix.inputs[1])
tree.links.new(color.outputs[0], mix.inputs[2])
tree.links.new(mix.outputs[0], diffuse.inputs[0])
recorded = rendered()
(sent,) = recorded.strands
values = {name: sent["attributes"][number].tolist() for name, number in recorded.attributes.items()
          if number in sent["attributes"]}
report(values=values, roots=sent["points"].reshape(20, -1, 3)[:, 0, :2].tolist())
"""
    )
    values, roots = run.report["values"], np.array(run.report["roots"])
    assert np.allclose(values["UVMap"], roots, atol=1e-5)
    # Bytes of an encoded colour between the corners 0 and 1, made linear by nobody: the ends of the range are exact.
    colors = np.array(values["Col"])
    assert colors.shape == (20, 3) and np.allclose(colors[:, 2], 0)
    assert np.all((colors[:, 0] > 0.5) == (roots[:, 0] > 0.5)) and np.all((colors[:, 1] > 0.5) == (roots[:, 1] > 0.5))


def test_a_flat_setting_and_a_primitive_to_compare_with_reach_the_core(run_blender):
    run = run_blender(
        HAIR
        + """
hairy()
forms = []
for shape, primitive in (("ROUND", "EXACT"), ("RIBBON", "EXACT"), ("ROUND", "SPHERES"), ("RIBBON", "EMBREE_ROUND")):
    scene.rayleaf.strand_shape, scene.rayleaf.curve_primitive = shape, primitive
    forms.append(rendered().strands[0]["form"])
report(forms=forms)
"""
    )
    assert run.report["forms"] == ["ROUND", "RIBBON", "SPHERES", "EMBREE_ROUND"]


def test_hair_curves_arrive_with_bad_radii_made_zero(run_blender):
    run = run_blender(
        HAIR
        + """
bpy.ops.object.curves_random_add()
data = bpy.context.object.data
data.attributes["radius"].data[3].value = float("nan")
data.attributes["radius"].data[4].value = -1.0
data.attributes["position"].data[9].vector = (float("inf"), 0, 0)
recorded = rendered()
(sent,) = recorded.strands
report(sent=told(sent), points=len(data.points), curves=len(data.curves))
"""
    )
    sent = run.report["sent"]
    counts = np.diff(sent["offsets"])
    assert len(counts) == run.report["curves"] - 1 and counts.sum() == len(sent["points"]) == run.report["points"] - 8
    assert sent["radii"][3] == sent["radii"][4] == 0 and np.isfinite(sent["points"]).all()


@pytest.mark.parametrize("kind, basis, points", [("CATMULL_ROM", "CATMULL_ROM", 8), ("POLY", "LINEAR", 8)])
def test_hair_curves_of_a_type_arrive_as_what_they_are(run_blender, kind, basis, points):
    run = run_blender(
        HAIR
        + f"""
bpy.ops.object.curves_random_add()
scenes.set_curve_types(bpy.context.object.data, {kind!r})
(sent,) = rendered().strands
report(sent=told(sent))
"""
    )
    sent = run.report["sent"]
    assert sent["basis"] == basis and set(np.diff(sent["offsets"])) == {points}
