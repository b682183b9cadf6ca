"""Inside Blender: curve objects as the dictionaries of curve_cases.py and random_curves.py describe them."""

import bpy
import numpy as np

BEZIER_FIELDS = (("co", 3), ("handle_left", 3), ("handle_right", 3), ("radius", 1), ("tilt", 1))
POINT_FIELDS = (("co", 4), ("radius", 1), ("tilt", 1))


def set_all(target, values):
    for name, value in values.items():
        setattr(target, name, value)


def add_spline(curve, wanted):
    """Append one spline as the case describes it."""
    spline = curve.splines.new(wanted["type"])
    points = spline.bezier_points if wanted["type"] == "BEZIER" else spline.points
    points.add(len(wanted["co"]) - 1)
    for name, width in BEZIER_FIELDS if wanted["type"] == "BEZIER" else POINT_FIELDS:
        if name in wanted:
            points.foreach_set(name, np.asarray(wanted[name], np.float32).ravel())
    for side in ("left", "right"):
        for point, kind in zip(points, wanted.get(f"handle_{side}_type", ())):
            setattr(point, f"handle_{side}_type", kind)
    set_all(spline, wanted.get("settings", {}))


def add_widget(profile, places, handles):
    """Give the profile widget its points."""
    for x, y in places:
        profile.points.add(x, y)
    for point, handle in zip(profile.points, handles, strict=True):
        point.handle_type_1 = point.handle_type_2 = handle
    profile.update()


def add_object(name, data):
    item = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(item)
    return item


def make_curve(case, helpers):
    """The object of a case; `helpers` are the bevel and taper objects made so far."""
    curve = bpy.data.curves.new(case["name"], "CURVE")
    settings = dict(case["settings"])
    curve.dimensions = settings.pop("dimensions", "3D")
    for key in ("bevel_object", "taper_object"):
        if settings.get(key):
            settings[key] = helpers[settings[key]]
    set_all(curve, settings)
    if "widget" in case:
        add_widget(curve.bevel_profile, *case["widget"])
    for wanted in case["splines"]:
        add_spline(curve, wanted)
    item = add_object(case["name"], curve)
    item.scale = case.get("scale", (1, 1, 1))
    return item
