"""Curve objects that between them have every setting: what the oracle inside Blender makes and its test checks.

A case is a dictionary: name, settings of the curve data block, splines; `helper` marks a bevel or taper object. Cases are pure
functions of their numbers, so that the test can make the same list.
"""

import itertools

import numpy as np

RESOLUTION = 48
INTERPOLATIONS = ("LINEAR", "CARDINAL", "BSPLINE", "EASE")


def _walk(rng, count, dimensions):
    """Points of a curve that advances along x and swings."""
    points = np.stack([np.arange(count) * 1.0, rng.uniform(-1, 1, count), rng.uniform(-0.8, 0.8, count)], axis=1)
    if dimensions == "2D":
        points[:, 2] = 0
    return points


def _ring(rng, count, dimensions):
    """Points around the origin."""
    angle = np.arange(count) * 2 * np.pi / count
    radius = rng.uniform(1.4, 2.2, count)
    points = np.stack([radius * np.cos(angle), radius * np.sin(angle), rng.uniform(-0.6, 0.6, count)], axis=1)
    if dimensions == "2D":
        points[:, 2] = 0
    return points


def bezier(rng, count=4, handles="AUTO", cyclic=False, dimensions="3D", spread=0.5, **settings):
    """A Bezier spline; handles: a type for all, or a list of (left, right). `spread`: how far free handles are from a straight line."""
    points = (_ring if cyclic else _walk)(rng, count, dimensions)
    pairs = (
        [(handles, handles)] * count if isinstance(handles, str) else [handles[i % len(handles)] for i in range(count)]
    )
    offsets = rng.uniform(-spread, spread, (2, count, 3))
    if dimensions == "2D":
        offsets[:, :, 2] = 0
    return {
        "type": "BEZIER",
        "co": points.tolist(),
        "handle_left": (points - (0.3, 0, 0) + offsets[0]).tolist(),
        "handle_right": (points + (0.3, 0, 0) + offsets[1]).tolist(),
        "handle_left_type": [pair[0] for pair in pairs],
        "handle_right_type": [pair[1] for pair in pairs],
        "radius": rng.uniform(0.6, 1.4, count).tolist(),
        "tilt": rng.uniform(-1, 1, count).tolist(),
        "settings": {"use_cyclic_u": cyclic, "resolution_u": RESOLUTION, **settings},
    }


def points_spline(rng, kind, count=5, cyclic=False, dimensions="3D", **settings):
    """A NURBS or POLY spline."""
    points = (_ring if cyclic else _walk)(rng, count, dimensions)
    weights = rng.uniform(0.6, 1.6, (count, 1)) if kind == "NURBS" else np.ones((count, 1))
    return {
        "type": kind,
        "co": np.concatenate([points, weights], axis=1).tolist(),
        "radius": rng.uniform(0.6, 1.4, count).tolist(),
        "tilt": rng.uniform(-1, 1, count).tolist(),
        "settings": {"use_cyclic_u": cyclic, "resolution_u": RESOLUTION, **settings},
    }


def splines_of_every_kind(rng, dimensions="3D"):
    """(label, spline) over types, seams, corners and straight parts."""
    mixed = [("AUTO", "AUTO"), ("AUTO", "VECTOR"), ("VECTOR", "VECTOR"), ("VECTOR", "FREE"), ("FREE", "FREE")]
    for cyclic in (False, True):
        seam = "closed" if cyclic else "open"
        yield f"auto {seam}", bezier(rng, 4, "AUTO", cyclic, dimensions)
        yield f"free {seam}", bezier(rng, 4, "FREE", cyclic, dimensions)
        yield f"vector {seam}", bezier(rng, 4, "VECTOR", cyclic, dimensions)
        yield f"mixed {seam}", bezier(rng, 6, mixed, cyclic, dimensions)
        yield f"poly {seam}", points_spline(rng, "POLY", 5, cyclic, dimensions)
        yield f"nurbs {seam}", points_spline(rng, "NURBS", 6, cyclic, dimensions, order_u=4, use_endpoint_u=not cyclic)
        yield f"nurbs loose {seam}", points_spline(rng, "NURBS", 7, cyclic, dimensions, order_u=3)
        yield f"nurbs bezier {seam}", points_spline(
            rng, "NURBS", 9 if cyclic else 7, cyclic, dimensions, order_u=4, use_bezier_u=True, use_endpoint_u=True
        )
    yield "two points", points_spline(rng, "POLY", 2, False, dimensions)


ROUND = {"bevel_depth": 0.2, "bevel_resolution": 3}
PROFILES = {
    "round": ROUND,
    "half": {**ROUND, "fill_mode": "HALF"},
    "front": {**ROUND, "fill_mode": "FRONT"},
    "back": {**ROUND, "fill_mode": "BACK"},
    "round extruded": {**ROUND, "extrude": 0.3},
    "half extruded": {**ROUND, "extrude": 0.3, "fill_mode": "HALF"},
    "front extruded": {**ROUND, "extrude": 0.3, "fill_mode": "FRONT"},
    "back extruded": {**ROUND, "extrude": 0.3, "fill_mode": "BACK"},
    "ribbon": {"extrude": 0.3},
    "offset": {**ROUND, "offset": 1.3},
    "negative depth": {"bevel_depth": -0.2, "bevel_resolution": 3},
}
# Fill modes of 2D curves, by the names that Blender has for 3D too: BOTH is not taken, NONE is.
PROFILES_2D = {
    "round": {**ROUND, "fill_mode": "NONE"},
    "ribbon": {"extrude": 0.3, "fill_mode": "NONE"},
    "extruded": {**ROUND, "extrude": 0.3, "fill_mode": "NONE", "offset": 0.9},
}


def _case(name, settings, *splines, **more):
    return {"name": name, "settings": settings, "splines": list(splines), **more}


def frame_cases(rng):
    """Every spline under every twist, 3D and 2D."""
    for label, spline in splines_of_every_kind(rng):
        for twist in ("Z_UP", "MINIMUM", "TANGENT"):
            if twist == "TANGENT" and spline["type"] != "BEZIER":
                continue
            yield _case(f"{label}, {twist}", {**ROUND, "twist_mode": twist}, spline)
    for label, spline in splines_of_every_kind(rng, "2D"):
        for profile, settings in PROFILES_2D.items():
            yield _case(f"2D {label}, {profile}", {**settings, "dimensions": "2D"}, spline)


def interpolation_cases(rng):
    for tilt, radius in itertools.product(INTERPOLATIONS, repeat=2):
        for cyclic in (False, True):
            spline = bezier(rng, 5, "AUTO", cyclic, tilt_interpolation=tilt, radius_interpolation=radius)
            yield _case(f"tilt {tilt}, radius {radius}, cyclic {cyclic}", {**ROUND, "twist_mode": "Z_UP"}, spline)


def profile_cases(rng):
    for name, settings in PROFILES.items():
        for kind in ("auto", "poly", "mixed"):
            spline = {"auto": lambda: bezier(rng), "poly": lambda: points_spline(rng, "POLY", 4)}.get(
                kind, lambda: bezier(rng, 5, [("AUTO", "VECTOR"), ("VECTOR", "FREE"), ("FREE", "FREE")], spread=0.15)
            )()
            yield _case(f"profile {name}, {kind}", {**settings, "twist_mode": "MINIMUM"}, spline)


# Profile widgets: places of the points between (1, 0) and (0, 1), and the handles of all.
WIDGETS = {
    "straight": ([], ["AUTO", "AUTO"]),
    "wavy": ([(0.8, 0.5), (0.3, 0.6), (0.2, 0.9)], ["AUTO"] * 5),
    "edged": ([(1.0, 0.4), (0.5, 0.4), (0.5, 0.8)], ["VECTOR", "VECTOR", "VECTOR", "AUTO", "AUTO"]),
}


def widget_cases(rng):
    """Bevels by the profile widget, every fill mode, with and without extrusion."""
    for name, fill, extrude in itertools.product(WIDGETS, ("FULL", "HALF", "FRONT", "BACK"), (0.0, 0.3)):
        settings = {"bevel_mode": "PROFILE", "bevel_depth": 0.2, "bevel_resolution": 23, "twist_mode": "MINIMUM"}
        settings |= {"extrude": extrude, "fill_mode": fill, "offset": 0.1}
        yield _case(f"widget {name}, {fill}, extruded by {extrude}", settings, bezier(rng), widget=WIDGETS[name])


def helper_cases(rng):
    """Bevel and taper objects."""
    square = {
        **points_spline(rng, "POLY", 4, True),
        "co": [(0.2, 0.1, 0, 1), (-0.2, 0.1, 0, 1), (-0.2, -0.1, 0, 1), (0.15, -0.1, 0, 1)],
    }
    star = {**points_spline(rng, "POLY", 6, True)}
    star["co"] = [
        (0.25 * r * np.cos(a), 0.25 * r * np.sin(a), 0, 1) for r, a in zip((1, 0.4) * 3, np.arange(6) * np.pi / 3)
    ]
    arc = bezier(rng, 3, "AUTO", False, "2D", resolution_u=12)
    loop = bezier(rng, 4, "AUTO", True, "2D", resolution_u=12)
    nurbs = points_spline(rng, "NURBS", 5, True, "2D", order_u=4, resolution_u=12)
    for name, splines, scale in (
        ("square", [square], (1, 1, 1)),
        ("star", [star], (1, 1, 1)),
        ("arc", [arc], (0.2, 0.3, 1)),
        ("loop", [loop], (0.15, -0.1, 2)),
        ("nurbs loop", [nurbs], (0.1, 0.1, 1)),
        ("several", [square, arc], (0.5, 0.5, 1)),
    ):
        yield _case(name, {}, *splines, helper=True, scale=scale)
    yield _case("taper bezier", {}, bezier(rng, 3, "AUTO", resolution_u=192), helper=True)
    yield _case(
        "taper poly",
        {},
        {**points_spline(rng, "POLY", 4), "co": [(2, 1, 0, 1), (2.5, 0.2, 0, 1), (4, -0.5, 0, 1), (5, 1.5, 0, 1)]},
        helper=True,
    )
    yield _case(
        "taper backwards", {}, {**points_spline(rng, "POLY", 2), "co": [(2, 1, 0, 1), (1, 0.2, 0, 1)]}, helper=True
    )


def bevel_object_cases(rng):
    for name in ("square", "star", "arc", "loop", "nurbs loop", "several"):
        for twist, cyclic in itertools.product(("Z_UP", "MINIMUM"), (False, True)):
            settings = {"bevel_mode": "OBJECT", "bevel_object": name, "twist_mode": twist, "offset": 0.1}
            yield _case(f"bevel object {name}, {twist}, cyclic {cyclic}", settings, bezier(rng, 4, "AUTO", cyclic))
        settings = {"bevel_mode": "OBJECT", "bevel_object": name, "dimensions": "2D", "fill_mode": "NONE"}
        yield _case(f"2D bevel object {name}", settings, points_spline(rng, "POLY", 5, True, "2D"))


RANGES = ((0.2, 0.7), (0.85, 0.15), (0.0, 0.33), (0.5, 1.0))
MAPPINGS = ("RESOLUTION", "SEGMENTS", "SPLINE")


def range_cases(rng):
    mixed = [("AUTO", "AUTO"), ("AUTO", "VECTOR"), ("VECTOR", "VECTOR"), ("VECTOR", "AUTO")]
    for (start, end), first, last in itertools.product(RANGES, MAPPINGS, MAPPINGS):
        kind = ("auto", "mixed", "poly", "nurbs")[(len(first) + len(last) + int(100 * start)) % 4]
        spline = {
            "auto": lambda: bezier(rng, 5),
            "mixed": lambda: bezier(rng, 6, mixed),
            "poly": lambda: points_spline(rng, "POLY", 6),
            "nurbs": lambda: points_spline(rng, "NURBS", 6, order_u=4, use_endpoint_u=True),
        }[kind]()
        settings = {"bevel_factor_start": start, "bevel_factor_end": end}
        settings |= {"bevel_factor_mapping_start": first, "bevel_factor_mapping_end": last}
        yield _case(
            f"range {start} {first} to {end} {last}, {kind}", {**ROUND, "twist_mode": "Z_UP", **settings}, spline
        )


def flat_range_cases(rng):
    """Cuts of mitred straight segments."""
    for kind, (start, end) in itertools.product(("POLY", "BEZIER"), ((0.1, 0.45), (0.3, 0.85))):
        spline = bezier(rng, 5, "VECTOR", False, "2D") if kind == "BEZIER" else points_spline(rng, kind, 6, False, "2D")
        settings = {**PROFILES_2D["extruded"], "dimensions": "2D", "bevel_factor_start": start, "bevel_factor_end": end}
        yield _case(f"2D range {start} to {end}, {kind}", settings, spline)


def taper_cases(rng):
    for taper, mode, fitted in itertools.product(
        ("taper bezier", "taper poly", "taper backwards"), ("OVERRIDE", "MULTIPLY", "ADD"), (False, True)
    ):
        settings = {"taper_object": taper, "taper_radius_mode": mode, "use_map_taper": fitted}
        settings |= {"bevel_factor_start": 0.1, "bevel_factor_end": 0.8}
        yield _case(f"{taper}, {mode}, fitted {fitted}", {**ROUND, "twist_mode": "MINIMUM", **settings}, bezier(rng, 4))
        closed = bezier(rng, 4, "AUTO", True)
        yield _case(f"{taper}, {mode}, fitted {fitted}, closed", {**ROUND, "twist_mode": "Z_UP", **settings}, closed)


def all_cases():
    """Every case, helpers first."""
    rng = np.random.default_rng(11)
    parts = (
        helper_cases,
        frame_cases,
        interpolation_cases,
        profile_cases,
        widget_cases,
        bevel_object_cases,
        range_cases,
        flat_range_cases,
        taper_cases,
    )
    return [case for part in parts for case in part(rng)]
