"""Curve objects as swept curves, and what goes as Blender's mesh instead."""

import numpy as np

CURVES = """
import bpy, scenes, recording_core
import numpy as np

def curve(name="Curve", kind="BEZIER", points=((0, 0, 0), (1, 1, 0), (2, 0, 0.5)), handles="AUTO", cyclic=False, **settings):
    data = bpy.data.curves.new(name, "CURVE")
    data.dimensions = settings.pop("dimensions", "3D")
    for key, value in settings.items():
        setattr(data, key, value)
    add_spline(data, kind, points, handles, cyclic)
    return scenes.add(data, name)

def add_spline(data, kind, points, handles="AUTO", cyclic=False):
    spline = data.splines.new(kind)
    own = spline.bezier_points if kind == "BEZIER" else spline.points
    own.add(len(points) - 1)
    spline.use_cyclic_u = cyclic
    for point, co in zip(own, points):
        point.co = co if kind == "BEZIER" else (*co, 1)
        if kind == "BEZIER":
            point.handle_left_type = point.handle_right_type = handles
    return spline

def ring_centers(item, around):
    mesh = item.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    return np.array([vertex.co for vertex in mesh.vertices]).reshape(-1, around, 3).mean(axis=1)

scene = scenes.empty_scene()
"""


def test_a_bevelled_curve_arrives_once_with_its_points_and_settings(run_blender):
    run = run_blender(
        CURVES
        + """
tube = curve("Tube", bevel_depth=0.1, extrude=0.2, bevel_resolution=3, fill_mode="HALF", twist_mode="Z_UP", use_fill_caps=True)
for _ in range(4):
    tube.data.materials.append(bpy.data.materials.new("Any"))
spline = tube.data.splines[0]
spline.bezier_points[1].radius, spline.bezier_points[2].tilt, spline.radius_interpolation = 2.0, 0.5, "EASE"
add_spline(tube.data, "POLY", [(0, 0, 5), (1, 0, 5)]).material_index = 3
add_spline(tube.data, "BEZIER", [(0, 0, 6), (1, 0, 6)]).radius_interpolation = "EASE"
curve("Thread")
sent, told, texts = recording_core.export()
(one,) = sent.curves
report(name=one.name, settings=one.settings, left_out=told.left_out, exact=told.exact, meshes=len(sent.meshes), texts=texts,
       instances=sent.instances["names"],
       splines=[dict(kind=s.kind, counts=s.counts.tolist(), points=s.points.tolist(), radii=s.more["radii"].tolist(),
                     tilts=s.more["tilts"].tolist(), slot=s.more["material_slot"], mode=s.more["radius_interpolation"],
                     handles=None if s.more["handles"] is None else list(s.more["handles"].shape)) for s in one.splines])
"""
    ).report
    assert run["exact"] == run["instances"] == ["Tube"] and run["meshes"] == 0
    assert run["left_out"] == {"Thread": "curve without faces"}
    settings = run["settings"]
    assert (settings["fill"], settings["twist"], settings["fill_caps"]) == ("HALF", "Z_UP", True)
    assert np.allclose([settings["bevel_depth"], settings["extrude"], settings["offset"]], [0.1, 0.2, 0])
    assert settings["profile"] is None and settings["taper"] is None
    bezier, poly = run["splines"]
    assert (bezier["kind"], bezier["counts"], bezier["mode"], bezier["handles"]) == (
        "BEZIER",
        [3, 2],
        "EASE",
        [5, 2, 3],
    )
    assert bezier["radii"] == [1, 2, 1, 1, 1] and bezier["tilts"] == [0, 0, 0.5, 0, 0]
    assert (poly["kind"], poly["counts"], poly["slot"], poly["points"][1]) == ("POLY", [2], 3, [1, 0, 5, 1])


def test_what_cannot_be_exact_goes_as_a_mesh_and_the_report_says_why(run_blender):
    run = run_blender(
        CURVES
        + """
tube = dict(bevel_depth=0.1)
square = [(1, 0, 0), (0, 1, 0), (-1, 0, 0)]
curve("Exact", **tube)
curve("Modified", **tube).modifiers.new("Bend", "SIMPLE_DEFORM")
curve("Flat", **tube).data.splines[0].use_smooth = False
curve("Filled", dimensions="2D", fill_mode="BOTH", cyclic=True, points=square, **tube)
uneven = curve("Uneven", dimensions="2D", fill_mode="BOTH", cyclic=True, points=square, **tube)
uneven.data.splines[0].bezier_points[1].radius = 2.0
curve("Crossed", "POLY", [(0, 0, 0), (1, 1, 0), (1, 0, 0), (0, 1, 0)], cyclic=True, dimensions="2D", fill_mode="BOTH")
curve("Outline", dimensions="2D", fill_mode="NONE", cyclic=True, points=square, **tube)
curve("Profile", bevel_mode="PROFILE", **tube)
for count in (150, 400):
    round_widget = curve(f"Profile of {count} points", bevel_mode="PROFILE", **tube).data.bevel_profile
    for angle in np.linspace(0, np.pi / 2, count)[1:-1]:
        round_widget.points.add(np.cos(angle), np.sin(angle))
curve("Tangent", twist_mode="TANGENT", **tube)
curve("Corners", twist_mode="TANGENT", handles="VECTOR", **tube)
keyed = curve("Absolute", **tube)
keyed.shape_key_add(), keyed.shape_key_add()
keyed.data.shape_keys.use_relative = False
aligned = curve("Aligned", handles="ALIGNED", **tube)
aligned.shape_key_add(), aligned.shape_key_add()
bent = curve("Bent bevel")
bent.modifiers.new("Bend", "SIMPLE_DEFORM")
curve("By a bent bevel", bevel_mode="OBJECT", bevel_object=bent)
curve("By a tube", taper_object=bpy.data.objects["Exact"], **tube)
sent, told, _ = recording_core.export()
report(exact=told.exact, evaluated=told.evaluated, names=sorted(sent.instances["names"]))
"""
    ).report
    assert sorted(run["exact"]) == ["Exact", "Filled", "Outline", "Profile", "Profile of 150 points", "Tangent"]
    assert run["evaluated"] == {
        "Modified": "modifier Bend",
        "Flat": "flat shading",
        "Uneven": "filled area that is not flat, for the radius changes",
        "Crossed": "filled area whose outlines cross",
        "Profile of 400 points": "profile widget of too many points",
        "Corners": "tangent twist, which Blender leaves undefined on straight segments and NURBS",
        "Absolute": "absolute shape keys",
        "Aligned": "shape keys with aligned handles",
        "By a bent bevel": "bevel object with a modifier, absolute shape keys or an offset",
        "By a tube": "taper object with a modifier, faces or absolute shape keys",
    }
    assert run["names"] == sorted([*run["exact"], *run["evaluated"]])


def test_splines_without_directions_go_as_a_mesh_and_those_without_points_as_nothing(run_blender):
    run = run_blender(
        CURVES
        + """
tube = dict(bevel_depth=0.1)
curve("Line", points=[(0, 0, 0), (1, 0.3, 0.2), (2, 0.6, 0.4)], twist_mode="TANGENT", **tube)
there_and_back = [(0, 0, 0), (2, 0.7, 0.3), (1, 0.35, 0.15), (1, 2, 1)]
curve("There and back", "POLY", there_and_back, **tube)
curve("Corner back", handles="VECTOR", points=there_and_back, **tube)
curve("Sharp", "POLY", [(0, 0, 0), (2, 0.7, 0.3), (1, 0.36, 0.15), (1, 2, 1)], **tube)
curve("Open ends", "POLY", [(0, 0, 0), (2, 0.7, 0.3)], **tube)
bpy.data.curves["Open ends"].splines.new("POLY").use_cyclic_u = True
curve("Two rings", "POLY", [(0, 0, 0), (2, 0.7, 0.3)], cyclic=True, **tube)
for twist in ("MINIMUM", "TANGENT"):
    curve(f"Nothing {twist}", twist_mode=twist, **tube).data.splines.clear()
curve("Back in 2D", "POLY", [(0, 0, 0), (2, 0, 0), (1, 0, 0)], dimensions="2D", fill_mode="NONE", **tube)
sent, told, _ = recording_core.export()
report(exact=told.exact, evaluated=told.evaluated)
"""
    ).report
    exact = ["Back in 2D", "Nothing MINIMUM", "Nothing TANGENT", "Open ends", "Sharp", "Two rings"]
    assert sorted(run["exact"]) == exact
    assert run["evaluated"] == {
        "Line": "tangent twist, which Blender leaves undefined on straight segments and NURBS",
        "There and back": "spline that turns straight back, where Blender's rings have no direction",
        "Corner back": "spline that turns straight back, where Blender's rings have no direction",
    }


def test_shape_keys_move_points_handles_radius_and_tilt_as_they_move_blenders_mesh(run_blender):
    run = run_blender(
        CURVES
        + """
item = curve(bevel_depth=0.01, bevel_resolution=0, points=[(0, 0, 0), (1, 0, 0), (2, 1, 0), (3, 0, 1)])
spline = item.data.splines[0]
spline.resolution_u = 8
spline.bezier_points[2].handle_left_type = "VECTOR"
spline.bezier_points[3].handle_left_type = "FREE"
add_spline(item.data, "POLY", [(0, 5, 0), (1, 5, 0)])
item.shape_key_add(name="Basis")
key = item.shape_key_add(name="Key")
key.data[1].co, key.data[1].radius, key.data[2].tilt = (1, 2, 1), 3.0, 1.0
key.data[3].handle_left, key.data[5].co = (2, 2, 2), (1, 7, 0)
key.value = 0.5
sent = recording_core.export()[0]
(bezier, poly) = sent.curves[0].splines
report(points=bezier.points.tolist(), handles=bezier.more["handles"].tolist(), radii=bezier.more["radii"].tolist(),
       tilts=bezier.more["tilts"].tolist(), poly=poly.points.tolist(), centers=ring_centers(item, 4).tolist())
"""
    ).report
    points, handles = np.array(run["points"])[:, :3], np.array(run["handles"])
    t = np.arange(8)[:, None] / 8
    expected = [
        (1 - t) ** 3 * a + 3 * (1 - t) ** 2 * t * b + 3 * (1 - t) * t**2 * c + t**3 * d
        for a, b, c, d in zip(points[:-1], handles[:-1, 1], handles[1:, 0], points[1:])
    ]
    centers = np.array(run["centers"])
    assert np.abs(np.concatenate([*expected, points[-1:]]) - centers[:25]).max() < 1e-5
    assert np.abs(np.array(run["poly"])[:, :3] - centers[25:]).max() < 1e-5
    assert points[1].tolist() == [1, 1, 0.5] and run["radii"] == [1, 2, 1, 1] and run["tilts"] == [0, 0, 0.5, 0]


def test_closed_2d_splines_run_as_blender_turns_them(run_blender):
    """Blender's rings tell the way: they follow the points or run against them."""
    run = run_blender(
        CURVES
        + """
corners = np.array([(1, 0, 0), (0, 1, 0), (-1, 0, 0), (0, -1, 0)], float)
item = curve(kind="POLY", points=3 * corners, cyclic=True, dimensions="2D", fill_mode="NONE", bevel_depth=0.01, bevel_resolution=0)
for scale, shift, way in ((2, 0, 1), (2, 0.1, -1), (1, 0, 1), (0.2, 0.1, -1), (1, 9, 1), (1, 12, -1)):
    add_spline(item.data, "POLY", (scale * corners + (shift, 0, 0))[::way], cyclic=True)
(sent,) = recording_core.export()[0].curves
(poly,) = sent.splines
report(sent=poly.points[:, :3].reshape(-1, 4, 3).tolist(), drawn=ring_centers(item, 4).reshape(-1, 4, 3).tolist())
"""
    ).report
    for number, (sent, drawn) in enumerate(zip(np.array(run["sent"]), np.array(run["drawn"]), strict=True)):
        assert np.abs(sent - drawn).max() < 1e-5, f"spline {number}: {sent.tolist()}, Blender's rings {drawn.tolist()}"


def test_reversed_beziers_and_nurbs_begin_where_blender_begins_them(run_blender):
    run = run_blender(
        CURVES
        + """
points = [(2, 0, 0), (0, 1, 0), (-2, 0, 0), (0.3, -1, 0), (1, -1, 0)]
for kind in ("BEZIER", "NURBS"):
    item = curve(kind, kind, points, cyclic=True, dimensions="2D", fill_mode="NONE", bevel_depth=0.01, bevel_resolution=0)
    item.data.splines[0].resolution_u = 64
    item.data.splines[0].order_u = 3
    if kind == "BEZIER":
        item.data.splines[0].bezier_points[1].handle_right_type = item.data.splines[0].bezier_points[2].handle_left_type = "VECTOR"
    (spline,) = [c for c in recording_core.export()[0].curves if c.name == kind][0].splines
    straight = spline.more["straight"]
    report(**{kind: dict(points=spline.points[:, :3].tolist(), drawn=ring_centers(item, 4).tolist(),
                         straight=None if straight is None else straight.tolist())})
"""
    ).report
    bezier = run["BEZIER"]
    points, drawn = np.array(bezier["points"]), np.array(bezier["drawn"])
    assert np.linalg.norm(drawn[0] - points[-1]) < 0.1, "a closed Bezier spline begins at its last point"
    passed = [int(np.linalg.norm(drawn - point, axis=1).argmin()) for point in points[:-1]]
    assert passed == sorted(passed), "the points follow in the order of the rings"
    begin = bezier["straight"].index(True)
    assert bezier["straight"].count(True) == 1
    legs = {tuple(np.round(points[i][:2])) for i in (begin, begin + 1)}
    assert legs == {(0, 1), (-2, 0)}
    points, drawn = np.array(run["NURBS"]["points"]), np.array(run["NURBS"]["drawn"])
    assert np.linalg.norm(drawn[0] - (points[0] + points[1]) / 2) < 0.05, "order 3 begins amid its first two points"
    assert np.dot(drawn[8] - drawn[0], points[1] - points[0]) > 0


def test_bevel_and_taper_objects_arrive_in_profile_coordinates(run_blender):
    run = run_blender(
        CURVES
        + """
bevel = curve("Bevel", "POLY", [(1, 2, 0), (3, 4, 0)])
bevel.scale = (2, 0.5, 7)
taper = curve("Taper", "POLY", [(1, 0.5, 0), (3, 2, 0)])
backwards = curve("Backwards", "POLY", [(3, 0.5, 0), (1, 2, 0)])
shape = dict(bevel_mode="OBJECT", bevel_object=bevel, bevel_depth=9, extrude=9)
curve("A", taper_object=taper, taper_radius_mode="MULTIPLY", use_map_taper=True, **shape)
curve("B", taper_object=backwards, taper_radius_mode="ADD", **shape)
curve("C", taper_object=backwards, taper_radius_mode="OVERRIDE", **shape).data.splines[0].bezier_points[1].radius = 5
curve("No bevel", bevel_mode="OBJECT", bevel_depth=1)
curve("Empty bevel", bevel_mode="OBJECT", bevel_object=scenes.add(bpy.data.curves.new("Nothing", "CURVE")))
curve("Bevelled bevel", bevel_mode="OBJECT", bevel_object=curve("Tube", bevel_depth=1))
sent, told, _ = recording_core.export()
found = {c.name: c for c in sent.curves}
report(names=sorted(found), left_out=sorted(told.left_out), profile=found["A"].settings["profile"][0].points.tolist(),
       depth=[found["A"].settings[k] for k in ("bevel_depth", "extrude")],
       taper=found["A"].settings["taper"].points.tolist(), mode=found["A"].settings["taper_radius"],
       none=[found[n].settings["taper"] is None for n in "BC"], radii=[found[n].splines[0].more["radii"].tolist() for n in "BC"])
"""
    ).report
    assert run["names"] == ["A", "B", "C", "Tube"]
    assert {"No bevel", "Empty bevel", "Bevelled bevel", "Bevel", "Taper", "Backwards"} <= set(run["left_out"])
    assert run["profile"] == [[-2, 1, 0, 1], [-6, 2, 0, 1]] and run["depth"] == [0, 0]
    assert run["taper"] == [[1, 0.5, 0, 1], [3, 2, 0, 1]] and run["mode"] == "MULTIPLY"
    assert run["none"] == [True, True] and run["radii"] == [[2, 2, 2], [1, 1, 1]]


def test_copies_and_instances_of_a_curve_share_one_shape(run_blender):
    run = run_blender(
        CURVES
        + """
item = curve("First", bevel_depth=0.1)
scenes.add(item.data, "Second")
inside = bpy.data.collections.new("Inside")
hidden = scenes.add(item.data, "Third", inside)
for place in range(3):
    empty = scenes.add(None, f"Empty {place}")
    empty.instance_type, empty.instance_collection = "COLLECTION", inside
sent, told, _ = recording_core.export()
report(curves=len(sent.curves), meshes=len(sent.meshes), shapes=sent.instances["shapes"], exact=sorted(told.exact))
"""
    ).report
    assert run["curves"] == 1 and run["meshes"] == 0
    assert run["shapes"] == [0] * 5
    assert run["exact"] == ["First", "Second", "Third"]


def test_a_hundred_thousand_splines_export_as_soon_as_blender_evaluates_them(run_blender):
    run = run_blender(
        CURVES
        + """
import time
for kind in ("POLY", "BEZIER"):
    data = bpy.data.curves.new(kind, "CURVE")
    data.dimensions, data.bevel_depth, data.bevel_resolution = "3D", 0.01, 0
    for _ in range(50_000):
        spline = data.splines.new(kind)
        (spline.bezier_points if kind == "BEZIER" else spline.points).add(1)
    scenes.add(data, kind)
began = time.process_time()
depsgraph = bpy.context.evaluated_depsgraph_get()
middle = time.process_time()
sent, told, texts = recording_core.export()
report(evaluated=middle - began, exported=time.process_time() - middle, exact=sorted(told.exact), texts=texts,
       counts=[int(curve.splines[0].counts.sum()) for curve in sent.curves])
"""
    ).report
    assert run["exact"] == ["BEZIER", "POLY"] and run["counts"] == [100_000, 100_000] and run["texts"] == []
    # Measured: about as long as Blender takes. A look at every spline before for each would take a thousand times as long.
    assert run["exported"] < 10 * run["evaluated"] + 5


def test_edits_and_frames_are_seen_and_the_render_resolution_counts(run_blender):
    run = run_blender(
        CURVES
        + """
item = curve("Tube", bevel_depth=0.1)
point = item.data.splines[0].bezier_points[2]
item.data.keyframe_insert("bevel_depth", frame=1)
point.keyframe_insert("co", frame=1)
item.data.bevel_depth, point.co = 0.5, (2, 4, 0)
item.data.keyframe_insert("bevel_depth", frame=11)
point.keyframe_insert("co", frame=11)
from rayleaf.versions import animation_curves
for curves in (animation_curves(item.data),):
    for each in curves:
        for key in each.keyframe_points:
            key.interpolation = "LINEAR"

def told():
    (sent,) = recording_core.export()[0].curves
    (spline,) = sent.splines
    return [sent.settings["bevel_depth"], spline.points[2].tolist(), spline.more["resolution"]]

frames = []
for frame in (1, 6, 11):
    bpy.context.scene.frame_set(frame)
    frames.append(told())
item.data.animation_data_clear()
item.data.bevel_depth, item.data.render_resolution_u = 0.7, 40
bpy.context.view_layer.update()
report(frames=frames, edited=told())
"""
    ).report
    depths, points, _ = zip(*run["frames"])
    assert np.allclose(depths, [0.1, 0.3, 0.5])
    assert np.allclose(points, [[2, 0, 0.5, 1], [2, 2, 0.25, 1], [2, 4, 0, 1]])
    assert np.isclose(run["edited"][0], 0.7) and run["edited"][2] == 40
