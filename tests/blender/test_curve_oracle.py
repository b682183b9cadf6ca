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
from curve_reference import frames_2d, frames_3d, profile_of, reversed_spine, rings, runs_backwards
from curve_spine import spine_of

WIDTHS = {"handle_left": 3, "handle_right": 3, "radius": 1, "tilt": 1}
# By how much a coordinate of a sample is off: Blender sums forward differences and multiplies knot parameters in single precision.
# Measured: 3e-5 at the end of closed NURBS splines, less elsewhere.
ROUNDING = 5e-5


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
def cases(tmp_path_factory):
    """Every case with the mesh that Blender made of it."""
    path = tmp_path_factory.mktemp("curves") / "curves.json"
    script = Path(__file__).with_name("curve_oracle_script.py")
    command = [os.environ.get("BLENDER") or "/usr/bin/blender", "--background", "--factory-startup"]
    command += ["--python-exit-code", "1", "--python", str(script), "--", str(path)]
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


def test_the_reference_says_where_blender_puts_every_ring(core, cases):
    checked = 0
    for case in cases:
        settings, spline = case["settings"], spline_of(case["splines"][0])
        if not is_defined(case, spline):
            continue
        flat, twist = settings.get("dimensions") == "2D", settings.get("twist_mode", "")
        spine = spine_of(core, spline)
        if flat and spine.cyclic and runs_backwards(spine):
            spine = reversed_spine(spine)
        frames = frames_2d(spine) if flat else frames_3d(spine, twist)
        profile, _ = profile_of(settings)
        expected = rings(spine.position, frames, spine.radius, profile, settings["offset"])
        found = unpacked(case["mesh"]["vertices"]).reshape(expected.shape)
        size = np.linalg.norm(expected - spine.position[:, None], axis=2).max(axis=1)
        error = np.linalg.norm(found - expected, axis=2).max(axis=1)
        widening = np.linalg.norm(frames[:, 0], axis=1)
        allowed = ROUNDING + size * widening * np.minimum(allowed_error(spine, twist), 2)
        worst = int((error - allowed).argmax())
        assert (
            error <= allowed
        ).all(), f"{case['name']}, ring {worst} of {len(error)}: off by {error[worst]}, allowed {allowed[worst]}"
        checked += 1
    assert checked > 150
