"""Curve objects whose silhouettes are compared with Blender's: those whose frames or rings Blender makes in a way of their own."""

import itertools

import numpy as np
from curve_cases import bezier, points_spline

# A profile to one side of the spine, so that half a turn of the frame is seen.
ASIDE = {"bevel_mode": "OBJECT", "bevel_object": "wedge", "offset": 0.2}
TAPER = {"taper_object": "taper line", "taper_radius_mode": "MULTIPLY"}
BENT, STRAIGHT, FREE = ("AUTO", "AUTO"), ("VECTOR", "VECTOR"), ("FREE", "FREE")


def _case(name, settings, spline):
    return {"name": name, "settings": settings, "splines": [spline]}


def _tangent_cases(rng, resolution):
    """Second derivatives that vanish, that end on the other side, that bend both ways in a plane."""
    aside = {**ASIDE, "twist_mode": "TANGENT"}
    for cyclic, kinds in itertools.product((False, True), ([("AUTO", "VECTOR"), BENT], [("VECTOR", "FREE"), FREE])):
        spline = bezier(rng, 5, kinds, cyclic, resolution_u=resolution)
        yield _case(f"tangent twist from vector handles {kinds[0]}, closed {cyclic}", aside, spline)
    for number in range(4):
        yield _case(f"tangent twist to the end {number}", aside, bezier(rng, 3, resolution_u=resolution))
        yield _case(f"tangent twist to the seam {number}", aside, bezier(rng, 4, "FREE", True, resolution_u=resolution))
    tilted = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    for number, twist in itertools.product(range(2), ("TANGENT", "Z_UP")):
        spline = bezier(rng, 4, "FREE", False, "2D", resolution_u=resolution)
        turn = tilted if twist == "TANGENT" else np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]])
        for field in ("co", "handle_left", "handle_right"):
            spline[field] = (np.array(spline[field]) @ turn).tolist()
        yield _case(f"{twist} in a plane {number}", {**ASIDE, "twist_mode": twist}, spline)


def _seam_cases(rng, resolution):
    """Where closed splines meet their beginning: corners, tapers, straight segments."""
    for twist, number in itertools.product(("MINIMUM", "Z_UP"), range(2)):
        spline = bezier(rng, 5, "AUTO", True, resolution_u=resolution)
        spline["handle_left_type"][4], spline["handle_right_type"][4] = "VECTOR", "FREE"
        for field in ("co", "handle_left", "handle_right"):
            spline[field] = (np.array(spline[field]) * (1, 1, 2)).tolist()
        yield _case(f"{twist} that closes at a corner {number}", {**ASIDE, "offset": 0.6, "twist_mode": twist}, spline)
    kinds = {
        "polygon": lambda flat: points_spline(rng, "POLY", 5, True, flat),
        "straight end": lambda flat: bezier(
            rng, 4, [STRAIGHT, BENT, BENT, STRAIGHT], True, flat, resolution_u=resolution
        ),
        "straight begin": lambda flat: bezier(
            rng, 4, [STRAIGHT, STRAIGHT, BENT, BENT], True, flat, resolution_u=resolution
        ),
        "bent": lambda flat: bezier(rng, 4, "AUTO", True, flat, resolution_u=resolution),
        "endpoint": lambda flat: points_spline(
            rng, "NURBS", 5, True, flat, order_u=4, use_endpoint_u=True, resolution_u=resolution
        ),
    }
    for (name, make), flat, turned in itertools.product(kinds.items(), ("3D", "2D"), (False, True)):
        spline = make(flat)
        if turned:
            for field in ("co", "handle_left", "handle_right"):
                if field in spline:
                    spline[field] = (np.array(spline[field]) * ([1, -1, 1, 1][: len(spline[field][0])])).tolist()
        settings = {**ASIDE, **TAPER, "dimensions": flat}
        settings |= {"fill_mode": "NONE"} if flat == "2D" else {"twist_mode": "Z_UP"}
        yield _case(f"taper around a {flat} spline, {name}, turned {turned}", settings, spline)
    settings = {**ASIDE, **TAPER, "taper_radius_mode": "ADD", "use_map_taper": True, "twist_mode": "MINIMUM"}
    settings |= {"bevel_factor_start": 0.2, "bevel_factor_end": 0.7}
    yield _case("added taper on a closed range", settings, kinds["straight end"]("3D"))


def _corner_cases(rng, resolution):
    """Corners of NURBS splines, which lie between two samples of Blender's."""
    for flat, cyclic in itertools.product(("3D", "2D"), (False, True)):
        settings = {"bevel_depth": 0.4, "extrude": 0.3, "fill_mode": "FRONT", "dimensions": flat, "offset": 0.2}
        settings |= {"fill_mode": "NONE"} if flat == "2D" else {"twist_mode": "MINIMUM"}
        bezier_knots = {"order_u": 4, "use_bezier_u": True, "use_endpoint_u": True}
        for count, flags in ((5, {"order_u": 2}), (9 if cyclic else 7, bezier_knots)):
            spline = points_spline(rng, "NURBS", count, cyclic, flat, resolution_u=resolution, **flags)
            if not cyclic:
                spline["co"] = (np.array(spline["co"]) * (0.8, 1.8, 1, 1)).tolist()
            yield _case(f"NURBS corners {flat}, order {flags['order_u']}, closed {cyclic}", settings, spline)


def _two_ring_cases(rng, resolution):
    """Closed splines of two rings, which Blender leaves open, without caps."""
    for kind, flat in itertools.product(("BEZIER", "POLY"), ("3D", "2D")):
        if kind == "POLY":
            spline = points_spline(rng, kind, 2, True, flat)
        else:
            spline = bezier(rng, 2, "VECTOR", True, flat, resolution_u=resolution)
        settings = {"bevel_depth": 0.3, "extrude": 0.2, "use_fill_caps": True, "dimensions": flat, **TAPER}
        settings |= {"fill_mode": "NONE"} if flat == "2D" else {"fill_mode": "HALF", "twist_mode": "MINIMUM"}
        settings |= {"bevel_factor_start": 0.2, "bevel_factor_end": 0.7}
        yield _case(f"two rings, {kind} in {flat}", settings, spline)


def silhouette_cases(resolution):
    """All cases; `resolution`: of the splines. The helpers are those of random curves."""
    rng = np.random.default_rng(5)
    parts = (_tangent_cases, _seam_cases, _corner_cases, _two_ring_cases)
    return [case for part in parts for case in part(rng, resolution)]
