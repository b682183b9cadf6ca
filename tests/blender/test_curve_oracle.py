"""Blender's meshes of curve objects lie on the surfaces that Rayleaf renders for them.

One Blender makes all cases of curve_cases.py. The reference in curve_reference.py says where every ring of Blender's mesh has to be.
"""

import base64
import json
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest
from curve_range import cut_rings, is_whole, tapered_radius, visible_range
from curve_reference import (
    bevel_object_profile,
    frames_2d,
    frames_3d,
    profile_of,
    reversed_spine,
    rings,
    runs_backwards,
)
from curve_spine import spine_of

WIDTHS = {"handle_left": 3, "handle_right": 3, "radius": 1, "tilt": 1}
# By how much a coordinate of a sample is off: Blender sums forward differences and multiplies knot parameters in single precision.
# Measured: 3e-5 at the end of closed NURBS splines, less elsewhere.
ROUNDING = 5e-5
# What the distance along a ray is more than the distance: rays are not all perpendicular to the surface. Measured: 4e-5.
TRACING = 1e-4
# Of an error above this, rays of a twentieth may not know.
MISSED = 0.02


def unpacked(text, kind=np.float32):
    return np.frombuffer(base64.b64decode(text), kind)


def spline_of(saved):
    """A spline as the script saved it, with arrays in double precision."""
    spline = dict(saved)
    for name, width in {"co": 3 if saved["type"] == "BEZIER" else 4, **WIDTHS}.items():
        if name in saved:
            values = unpacked(saved[name]).astype(float)
            spline[name] = values.reshape(-1, width) if width > 1 else values
    return spline


@pytest.fixture(scope="module")
def cases(tmp_path_factory, addons):
    """Every case with the mesh that Blender made of it."""
    path = tmp_path_factory.mktemp("curves") / "curves.json"
    script = Path(__file__).with_name("curve_oracle_script.py")
    command = [os.environ.get("BLENDER") or "/usr/bin/blender", "--background", "--factory-startup"]
    command += ["--python-exit-code", "1", "--python", str(script), "--", str(path), str(addons)]
    done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stdout + done.stderr
    return json.loads(path.read_text())


def angles(a, b):
    return np.arctan2(np.linalg.norm(np.cross(a, b), axis=1), (a * b).sum(axis=1))


def allowed_error(spine, twist):
    """(n,): by how much of its size a ring of Blender's may be off, because it takes directions from its neighbours.

    A chord's direction is off by half of how the tangent turns along it. Between two equal chords that cancels but for its square;
    where the tangent breaks it does not, and counts the more the sharper the corner. MINIMUM carries such errors on. Rounding counts
    by the length of a chord.
    """
    chord = np.linalg.norm(np.roll(spine.position, -1, axis=0) - spine.position, axis=1)
    shorter = np.maximum(np.minimum(chord, np.roll(chord, 1)), 1e-9)
    uneven_chords = np.abs(chord - np.roll(chord, 1)) / (chord + np.roll(chord, 1))
    turning = angles(spine.after, np.roll(spine.before, -1, axis=0))
    turning[spine.straight] = 0
    bend = turning + np.roll(turning, 1)
    opening = np.linalg.norm(spine.before + spine.after, axis=1) / 2
    corner = angles(spine.before, spine.after) > 1e-4
    # A segment that meets another of different speed has chords of different length around their point: first order too.
    uneven = corner | spine.straight | np.roll(spine.straight, 1) | (np.roll(spine.segment, 1) != spine.segment)
    error = np.where(uneven, bend / np.maximum(opening, 1e-6), bend * (bend + uneven_chords))
    change = np.abs(turning - np.roll(turning, 1)) * ~uneven
    error += np.max([np.roll(change, i) for i in range(-2, 3)], axis=0) + ROUNDING / shorter
    if twist == "Z_UP":  # the frame is fixed by the horizontal part of the direction
        error /= np.maximum(np.linalg.norm(spine.direction[:, :2], axis=1), 1e-6)
    if twist == "TANGENT":  # the frame is fixed by the angle between direction and second derivative
        error /= np.maximum(np.sin(angles(spine.second, spine.direction)), 1e-6)
    return np.cumsum(error) + error if twist == "MINIMUM" else error


def is_defined(case, spline):
    """False where Blender leaves frames to chance."""
    if case["settings"].get("twist_mode") != "TANGENT":
        return True
    return spline["type"] == "BEZIER" and not any(
        right and spline["vector"][(i + 1) % len(spline["vector"])][0] for i, (_, right) in enumerate(spline["vector"])
    )


def oriented_spine(core, spline, flat):
    spine = spine_of(core, spline)
    return reversed_spine(spine) if flat and spine.cyclic and runs_backwards(spine) else spine


def profiles_of(core, case, helpers):
    """The polygons of a case's profile."""
    if "bevel_object" not in case["settings"]:
        return [profile_of(case["settings"], case.get("widget"))[0]]
    bevel = helpers[case["settings"]["bevel_object"]]
    return [bevel_object_profile(core, spline_of(saved), bevel["scale"]) for saved in bevel["splines"]]


def expected_rings(core, case, helpers, spline):
    """[(rings, allowed errors)] of each profile of a case, at the places of Blender's rings."""
    settings = case["settings"]
    flat, twist = settings.get("dimensions") == "2D", settings.get("twist_mode", "")
    spine = oriented_spine(core, spline, flat)
    frames = frames_2d(spine) if flat else frames_3d(spine, twist, case["closed_twist"])
    allowed = np.minimum(allowed_error(spine, twist), 2) * np.linalg.norm(frames[:, 0], axis=1)
    visible = visible_range(spine, settings)
    position, radius, places = spine.position, spine.radius, np.arange(len(spine.position), dtype=float)
    if not is_whole(spine, visible):
        position, frames, radius, places = cut_rings(spine, frames, spine.radius, *visible, flat)
        # A place on a curved segment is between two samples; Blender's ring there is on the chord.
        allowed = np.maximum(allowed[np.floor(places).astype(int)], allowed[np.ceil(places).astype(int)])
    if "taper_object" in settings:
        taper = spine_of(core, spline_of(helpers[settings["taper_object"]]["splines"][0])).position[:, :2]
        fitted = visible if settings["use_map_taper"] else None
        radius = tapered_radius(radius, taper, settings["taper_radius_mode"], places, len(spine.position), fitted)
    for profile in profiles_of(core, case, helpers):
        expected = rings(position, frames, radius, profile, settings["offset"])
        size = np.linalg.norm(expected - position[:, None], axis=2).max(axis=1)
        yield expected, ROUNDING + size * allowed


def checked_cases(cases):
    """(case, spline) where Blender's frames are defined."""
    for case in cases:
        spline = spline_of(case["splines"][0])
        if not case.get("helper") and is_defined(case, spline):
            yield case, spline


@pytest.fixture(scope="module")
def helpers(cases):
    return {case["name"]: case for case in cases if case.get("helper")}


def test_the_reference_says_where_blender_puts_every_ring(core, cases, helpers):
    checked = 0
    for case, spline in checked_cases(cases):
        vertices = unpacked(case["mesh"]["vertices"]).reshape(-1, 3)
        for expected, allowed in expected_rings(core, case, helpers, spline):
            count = expected.shape[0] * expected.shape[1]
            assert len(vertices) >= count, f"{case['name']}: {len(vertices)} vertices, {count} expected"
            error = np.linalg.norm(vertices[:count].reshape(expected.shape) - expected, axis=2).max(axis=1)
            vertices = vertices[count:]
            worst = int((error - allowed).argmax())
            where = f"{case['name']}, ring {worst} of {len(error)}"
            assert (error <= allowed).all(), f"{where}: off by {error[worst]}, allowed {allowed[worst]}"
        assert len(vertices) == 0, f"{case['name']}: {len(vertices)} vertices too many"
        checked += 1
    assert checked > 270


def steps(radius_rings):
    """(rings,): how much rings differ in size from their neighbours."""
    size = np.linalg.norm(radius_rings - radius_rings.mean(axis=1, keepdims=True), axis=2).max(axis=1)
    change = np.abs(np.diff(size))
    return np.maximum(np.append(change, 0), np.insert(change, 0, 0))


def test_blenders_mesh_lies_on_the_surface_that_is_rendered(core, cases, helpers):
    checked = 0
    for case, spline in checked_cases(cases):
        if case["distances"] is None:
            continue
        distances, moved = unpacked(case["distances"], float).reshape(-1, 2).T
        coarse = "bevel_factor_start" in case["settings"] and not spine_of(core, spline).straight.all()
        for expected, allowed in expected_rings(core, case, helpers, spline):
            count = expected.shape[0] * expected.shape[1]
            error, shift = distances[:count].reshape(expected.shape[:2]), moved[:count].reshape(expected.shape[:2])
            distances, moved = distances[count:], moved[count:]
            # On closed splines a taper reaches its end one sample early. Rays need not be perpendicular to a wall that widens.
            allowed = 1.5 * allowed + 4 * steps(expected) * coarse
            excess = error - allowed[:, None] - shift - TRACING
            # Where Blender's ring may be anywhere, rays may miss.
            excess[np.isinf(error) & (allowed[:, None] > MISSED)] = -1
            if coarse:
                # A cut lies between two samples, on a chord, and has the radius of the sample cut away; and where a taper jumps at
                # the seam of a closed spline, Blender has a cone for what is a flat ring in the limit.
                excess[[0, -1]] = -1
            worst = np.unravel_index(excess.argmax(), excess.shape)
            where = f"{case['name']}, ring {worst[0]} of {len(error)}, point {worst[1]}"
            assert excess[worst] <= 0, f"{where}: off by {error[worst]}, allowed {allowed[worst[0]]} + {shift[worst]}"
        checked += 1
    assert checked > 270
