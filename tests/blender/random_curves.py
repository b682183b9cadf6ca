"""Curve objects of random settings, as pure functions of a seed: every handle, knot, twist, taper and range beside every other."""

import numpy as np

HANDLES = ("AUTO", "VECTOR", "FREE", "ALIGNED")
INTERPOLATIONS = ("LINEAR", "CARDINAL", "BSPLINE", "EASE")
MAPPINGS = ("RESOLUTION", "SEGMENTS", "SPLINE")
TWISTS = ("TANGENT", "MINIMUM", "Z_UP")


def _walk(rng, count, cyclic):
    """Points of a curve that wanders, or goes round."""
    if cyclic:
        angle = (np.arange(count) + rng.uniform(-0.3, 0.3, count)) * 2 * np.pi / count
        radius = rng.uniform(0.8, 2.0, count)
        return np.stack([radius * np.cos(angle), radius * np.sin(angle), rng.uniform(-1, 1, count)], axis=1)
    if rng.random() < 0.5:
        return np.stack([np.arange(count), rng.uniform(-1, 1, count), rng.uniform(-1, 1, count)], axis=1)
    return np.cumsum(rng.normal(size=(count, 3)), axis=0)


def _common(rng, kind, points, cyclic, resolution):
    count = len(points)
    spline = {"type": kind, "co": points.tolist(), "settings": {"use_cyclic_u": cyclic, "resolution_u": resolution}}
    if rng.random() < 0.5:
        spline["radius"] = rng.uniform(0.5, 1.5, count).tolist()
    if rng.random() < 0.4:
        spline["tilt"] = rng.uniform(-1.5, 1.5, count).tolist()
    return spline


def _bezier(rng, points, cyclic, resolution):
    count = len(points)
    spline = _common(rng, "BEZIER", points, cyclic, resolution)
    kinds = HANDLES if rng.random() < 0.7 else (str(rng.choice(HANDLES)),)
    flat = np.array([1.0, 1.0, 0.0 if not points[:, 2].any() else 1.0])
    for side in ("left", "right"):
        spline[f"handle_{side}"] = (points + rng.uniform(-0.8, 0.8, (count, 3)) * flat).tolist()
        spline[f"handle_{side}_type"] = [str(kind) for kind in rng.choice(kinds, count)]
    spline["settings"] |= {
        f"{name}_interpolation": str(rng.choice(INTERPOLATIONS)) for name in ("radius", "tilt") if name in spline
    }
    return spline


def _nurbs(rng, points, cyclic, resolution):
    order = int(rng.integers(2, 7))
    spline = _common(rng, "NURBS", points, cyclic, resolution)
    weights = rng.uniform(0.5, 2, len(points)) if rng.random() < 0.5 else np.ones(len(points))
    spline["co"] = np.column_stack([points, weights]).tolist()
    endpoint, bezier = (bool(flag) for flag in rng.random(2) < (0.5, 0.3))
    spline["settings"] |= {"order_u": order, "use_endpoint_u": endpoint, "use_bezier_u": bezier}
    return spline


def _poly(rng, points, cyclic, resolution):
    spline = _common(rng, "POLY", points, cyclic, resolution)
    spline["co"] = np.column_stack([points, np.ones(len(points))]).tolist()
    return spline


def _profile(rng):
    """Settings of the bevel. Profiles that are not round, and lie to one side, tell how a frame is turned."""
    settings = {"bevel_depth": 0.12, "bevel_resolution": 8, "offset": float(rng.choice([0.0, 0.0, 0.3]))}
    choice = rng.random()
    if choice < 0.25:
        settings["extrude"] = 0.3
        settings["fill_mode"] = str(rng.choice(["FULL", "HALF", "FRONT", "BACK"]))
    elif choice < 0.4:
        settings |= {"bevel_depth": 0.0, "extrude": 0.3}
    elif choice < 0.8:
        settings |= {"bevel_mode": "OBJECT", "bevel_object": str(rng.choice(["wedge", "arc"]))}
    return settings


def _taper(rng):
    return {
        "taper_object": str(rng.choice(["taper line", "taper wave"])),
        "taper_radius_mode": str(rng.choice(["OVERRIDE", "MULTIPLY", "ADD"])),
        "use_map_taper": bool(rng.random() < 0.5),
    }


def _range(rng):
    start, end = rng.uniform(0, 0.45), rng.uniform(0.55, 1)
    if rng.random() < 0.2:
        start = 0.0
    return {
        "bevel_factor_start": float(start),
        "bevel_factor_end": float(end),
        "bevel_factor_mapping_start": str(rng.choice(MAPPINGS)),
        "bevel_factor_mapping_end": str(rng.choice(MAPPINGS)),
    }


def random_case(seed, resolution, kind=None):
    """A curve object as curve_objects.py makes it; kind: of its spline, or any."""
    rng = np.random.default_rng(seed)
    flat, cyclic = bool(rng.random() < 0.3), bool(rng.random() < 0.4)
    points = _walk(rng, int(rng.integers(2, 8)), cyclic)
    if flat:
        points[:, 2] = 0
    elif rng.random() < 0.15:  # in a plane of its own
        points = points * (1, 1, 0) @ np.linalg.qr(rng.normal(size=(3, 3)))[0]
    settings = _profile(rng)
    if flat:
        settings |= {"dimensions": "2D", "fill_mode": str(rng.choice(["NONE", "NONE", "BOTH", "FRONT"]))}
    else:
        settings["twist_mode"] = str(rng.choice(TWISTS))
    if rng.random() < 0.35:
        settings |= _taper(rng)
    if rng.random() < 0.35:
        settings |= _range(rng)
    settings["use_fill_caps"] = bool(rng.random() < 0.3)
    kind = kind or str(rng.choice(["BEZIER", "BEZIER", "NURBS", "POLY"]))
    make = {"BEZIER": _bezier, "NURBS": _nurbs, "POLY": _poly}[kind]
    return {"name": f"random {seed}", "settings": settings, "splines": [make(rng, points, cyclic, resolution)]}


def _thread(name, points, resolution, cyclic=False, kind="POLY"):
    """A helper's curve: one spline in the plane."""
    spline = {"type": kind, "settings": {"use_cyclic_u": cyclic, "resolution_u": resolution}}
    spline["co"] = [(*point, 0) if kind == "BEZIER" else (*point, 0, 1) for point in points]
    if kind == "BEZIER":
        spline["handle_left_type"] = spline["handle_right_type"] = ["AUTO"] * len(points)
    return {"name": name, "settings": {}, "splines": [spline], "helper": True}


def helper_cases(resolution):
    """The bevel and taper objects that random cases name."""
    return [
        _thread("wedge", [(0.3, 0.05), (-0.1, 0.12), (-0.1, -0.1), (0.1, -0.05)], resolution, True),
        _thread("arc", [(0.3, 0.1), (0.0, 0.2), (-0.1, -0.1)], 16, False, "BEZIER"),
        _thread("taper line", [(0, 0.4), (0.3, 1.2), (1, 0.7)], resolution),
        _thread("taper wave", [(0, 1.0), (0.5, 0.4), (1, 1.4)], resolution, False, "BEZIER"),
    ]
