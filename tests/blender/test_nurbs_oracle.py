"""Blender's own tessellation of NURBS and Bezier splines lies on the exact ones, at the parameters where Blender took it.

Blender computes in single precision, so its parameters are replayed in single precision too. Coordinates are below 1.
"""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

# Measured: 5.1e-7 on surfaces, 2.8e-7 on NURBS curves (8.5e-7 by Blender 5.0, which sums otherwise), 1.4e-6 on Bezier
# curves, which Blender draws by forward differences. All are a few float roundings of sums of up to 36 products, or of a
# dozen accumulated differences.
SURFACE_TOLERANCE = 1e-6
CURVE_TOLERANCE = 9e-7
BEZIER_TOLERANCE = 3e-6
# Blender adds up surface parameters step by step and may end past the domain by some 1e-6 of it, on the polynomial that
# follows. Speed there, in units per domain: degree 5, differences up to 2, weights within a factor of 16, a few spans.
OVERSHOOT_SPEED = 500.0


@pytest.fixture(scope="module")
def oracle(tmp_path_factory):
    """{kind: [(name, arrays)]} of all splines that the script tessellated."""
    path = tmp_path_factory.mktemp("oracle") / "oracle.npz"
    script = Path(__file__).with_name("nurbs_oracle_script.py")
    command = [
        os.environ.get("BLENDER") or "/usr/bin/blender",
        "--background",
        "--factory-startup",
        "--python-exit-code",
        "1",
    ]
    command += ["--python", str(script), "--", str(path)]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    with np.load(path) as file:
        arrays = dict(file)
    columns = {
        name: np.split(arrays[name], np.cumsum(arrays[f"{name}_size"])[:-1]) for name in ("vertices", "points", "types")
    }
    splines: dict[str, list[tuple[str, dict[str, np.ndarray]]]] = {"surface": [], "curve": [], "bezier": []}
    for i, kind in enumerate(arrays["kind"]):
        case = {"u": arrays["u"][i], "v": arrays["v"][i], "types": columns["types"][i], "version": arrays["version"]}
        case["vertices"] = columns["vertices"][i].reshape(-1, 3)
        case["points"] = columns["points"][i].reshape((-1, 3, 3) if kind == "bezier" else (-1, 4))
        splines[kind].append((f"{kind} {i}", case))
    return splines


def flags(settings):
    return [bool(flag) for flag in settings[1:4]]


def domain(core, settings):
    """Begin and end of a direction's knot domain."""
    order, cyclic, _, _, count, _ = settings
    knots = core.implied_knots(count, order, *flags(settings))
    return knots[order - 1], knots[count + (order - 1 if cyclic else 0)]


def step_of(begin, end, settings, total):
    return np.float32(end - begin) / np.float32(total if settings[1] else total - 1)


def accumulated_parameters(core, settings):
    """Surface parameters of one direction as Blender makes them, over [0, 1]."""
    begin, end = domain(core, settings)
    total = settings[4] * settings[5]
    steps = np.full(total, step_of(begin, end, settings, total), np.float32)
    steps[0] = begin
    return (np.add.accumulate(steps, dtype=np.float32).astype(np.float64) - begin) / (end - begin)


def curve_parameters(core, case):
    """Curve parameters as Blender makes them, over [0, 1]. Since 5.0 they are not rounded."""
    settings, total = case["u"], len(case["vertices"])
    if tuple(case["version"]) >= (5, 0, 0):
        return np.arange(total) / (total if settings[1] else total - 1)
    begin, end = domain(core, settings)
    steps = np.arange(total, dtype=np.float32) * step_of(begin, end, settings, total)
    return ((np.float32(begin) + steps).astype(np.float64) - begin) / (end - begin)


def surface_of(core, case):
    u, v = case["u"], case["v"]
    by_direction = [flag for pair in zip(flags(u), flags(v)) for flag in pair]
    points = case["points"].astype(np.float64).reshape(v[4], u[4], 4)
    return core.NurbsSpline(points, u[0], v[0], *by_direction)


def describe(name, case):
    return f"{name}: order, cyclic, endpoint, bezier, count, resolution: u {case['u']} v {case['v']}"


def test_surfaces_exist_where_blender_draws_them(core, oracle):
    drawn = 0
    for name, case in oracle["surface"]:
        problem = surface_of(core, case).problem()
        assert (problem is None) == (len(case["vertices"]) > 0), f"{describe(name, case)}: {problem}"
        assert problem is None or problem[0] == "DRAWS_NOTHING"
        drawn += problem is None
    assert 0 < drawn < len(oracle["surface"])


def test_every_vertex_of_a_nurbs_surface_lies_on_the_exact_one_at_its_parameters(core, oracle):
    seen = set()
    for name, case in oracle["surface"]:
        surface = surface_of(core, case)
        if surface.problem():
            continue
        u = accumulated_parameters(core, case["u"])
        v = accumulated_parameters(core, case["v"])
        assert len(case["vertices"]) == len(u) * len(v), describe(name, case)
        grid_u, grid_v = (grid.ravel() for grid in np.meshgrid(u, v, indexing="ij"))
        error = np.abs(surface.to_bezier().positions(grid_u, grid_v) - case["vertices"]).max(axis=1)
        overshoot = np.maximum(grid_u - 1, 0) + np.maximum(grid_v - 1, 0)
        excess = (error - SURFACE_TOLERANCE - OVERSHOOT_SPEED * overshoot).max()
        assert excess <= 0, f"{describe(name, case)}: off by {error.max()}"
        assert overshoot.max() < 4e-6, describe(name, case)
        seen.add((*flags(case["u"]), *flags(case["v"])))
        seen.add((case["u"][0], case["v"][0]))
    assert len(seen) == 64 + 25, "not every combination of flags and of orders was drawn"


def test_nurbs_curves_that_blender_cannot_evaluate_show_their_control_points(core, oracle):
    shown = 0
    for name, case in oracle["curve"]:
        problem = core.NurbsCurve(case["points"], case["u"][0], *flags(case["u"])).problem()
        if problem:
            assert problem[0] == "DRAWS_CONTROL_POLYGON"
            assert np.array_equal(case["vertices"], case["points"][:, :3]), describe(name, case)
            shown += 1
    assert shown > 0


def test_every_vertex_of_a_nurbs_curve_lies_on_the_exact_one_at_its_parameter(core, oracle):
    seen = set()
    for name, case in oracle["curve"]:
        curve = core.NurbsCurve(case["points"], case["u"][0], *flags(case["u"]))
        if curve.problem():
            continue
        t = curve_parameters(core, case)
        error = np.abs(curve.to_bezier().positions(t) - case["vertices"]).max()
        assert error <= CURVE_TOLERANCE, f"{describe(name, case)}: off by {error}"
        seen.add((case["u"][0], *flags(case["u"])))
    assert len(seen) == 5 * 8, "not every combination of order and flags was drawn"


def bezier_parameters(case, resolution=5):
    """Parameters of a Bezier curve's vertices: `resolution` for each segment, one where both its handles are VECTOR."""
    types, count = case["types"], len(case["points"])
    segments = count if case["u"][1] else count - 1
    t = []
    for i in range(segments):
        straight = types[i][1] == "VECTOR" and types[(i + 1) % count][0] == "VECTOR"
        steps = 1 if straight else resolution
        t += [(i + k / steps) / segments for k in range(steps)]
    return np.array(t if case["u"][1] else [*t, 1.0])


def test_every_vertex_of_a_bezier_curve_lies_on_the_exact_one_for_all_handle_types(core, oracle):
    checked = 0
    for name, case in oracle["bezier"]:
        curve = core.BezierSpline(case["points"], bool(case["u"][1]))
        if curve.problem():
            assert len(case["points"]) < 2, name
            continue
        t = bezier_parameters(case)
        assert len(t) == len(case["vertices"]), name
        error = np.abs(curve.to_bezier().positions(t) - case["vertices"]).max()
        assert error <= BEZIER_TOLERANCE, f"{name}, types {case['types'].tolist()}: off by {error}"
        checked += 1
    assert checked == 17 * 2 * 3
