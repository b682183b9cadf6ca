"""The ray cache as published against tracing, on a mirror sheet: speed, share traced, samples, error.

One thread, its processor time, geometry alone: both return the reflected ray. The sheet is 10 x 10 units of 100 bicubic
patches, C2 at their borders, seen by 600 x 600 camera rays, row by row. First frame: an empty tree. Repeated: the same
rays again. Orbit: frames 2 to 10 while the camera moves by one degree each. The error is that of the answers against the
tracer that filled the tree, as the mean distance of RGB values in [0, 1] that a smooth surrounding of several frequencies
gives to both (0 for rays that miss), and as the angle of the interpolated directions.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from rayleaf import _core

Doubles = NDArray[np.float64]

REPEATS = 3
PIXELS = 600
ORBIT_FRAMES = 9
PATCHES = 10
CUBIC_OPEN = (4, False, False, False)
# The paper's 0.05 on a sheet of 10 units, as a share of half its side; its angle and depth.
SETTINGS = {"distance_threshold": 0.01, "angle_threshold": np.radians(30), "depth_limit": 28}


def unit(vectors: Doubles) -> Doubles:
    """Vectors of length 1."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def sheet() -> Any:
    """Waves of about a third of a unit."""
    step = 10 / PATCHES
    place = (np.arange(PATCHES + 3) - 1) * step - 5
    x, y = np.meshgrid(place, place)
    z = 0.35 * np.sin(0.9 * x + 0.4) * np.cos(0.8 * y) + 0.1 * np.sin(1.7 * y - 0.6 * x)
    points = np.stack([x, y, z, np.ones_like(x)], axis=2)
    return _core.trace.PatchSurface("sheet", [(points, CUBIC_OPEN, CUBIC_OPEN, True, 0)])


def camera_rays(degrees: float) -> tuple[Doubles, Doubles]:
    """From 12 units away, 35 degrees above the sheet, turned around the vertical."""
    turn, rise = np.radians(degrees + 20), np.radians(35)
    eye = 12 * np.array([np.cos(turn) * np.cos(rise), np.sin(turn) * np.cos(rise), np.sin(rise)])
    forward = unit(-eye)
    right = unit(np.cross(forward, [0, 0, 1]))
    up = np.cross(right, forward)
    place = (np.arange(PIXELS) + 0.5) / PIXELS - 0.5
    x, y = np.meshgrid(place, place)
    directions = unit(forward + 0.85 * (x.reshape(-1, 1) * right + y.reshape(-1, 1) * up))
    return np.broadcast_to(eye, directions.shape).copy(), directions


def surrounding(answers: dict[str, Any]) -> Doubles:
    """RGB that the reflected rays see, far away; black where nothing reflects."""
    d = answers["exit_direction"]
    colors = np.empty((len(d), 3))
    for channel, (a, b, c) in enumerate(((7, 3, 2), (2, 9, 4), (5, 2, 8))):
        waves = np.sin(a * d[:, 0] + channel) + np.sin(b * d[:, 1] + c * d[:, 2]) + np.sin(19 * d[:, channel])
        colors[:, channel] = 0.5 + waves / 6
    return np.where(answers["hit"][:, None], colors, 0.0)


def errors(got: dict[str, Any], truth: dict[str, Any]) -> tuple[float, float]:
    """Mean RGB distance over all rays, and mean angle in degrees over interpolated ones."""
    rgb = np.linalg.norm(surrounding(got) - surrounding(truth), axis=1).mean()
    interpolated = (got["answered_by"] == _core.ri_tree.ANSWERS.index("interpolated")) & truth["hit"]
    chord = np.linalg.norm(got["exit_direction"] - truth["exit_direction"], axis=1)[interpolated]
    return float(rgb), float(np.degrees(2 * np.arcsin(np.minimum(chord / 2, 1))).mean())


def shares(before: dict[str, Any], after: dict[str, Any]) -> dict[str, float]:
    """Which share of the rays in between was answered how, per cent."""
    counts = {name: after["answers"][name] - before["answers"][name] for name in after["answers"]}
    total = sum(counts.values())
    return {name: 100 * count / total for name, count in counts.items() if count}


def check(truth: dict[str, Any], got: dict[str, Any]) -> None:
    """Hits agree but for silhouettes, traced answers are the tracer's own, bit by bit."""
    assert (truth["hit"] != got["hit"]).mean() < 0.01
    names = _core.ri_tree.ANSWERS
    traced = np.isin(got["answered_by"], [i for i, name in enumerate(names) if name.startswith("traced")])
    np.testing.assert_array_equal(truth["exit_direction"][traced], got["exit_direction"][traced])
    rgb, _ = errors(got, truth)
    assert rgb < 0.05, rgb


def run() -> list[dict[str, Any]]:
    """Rows of times, speed-ups, shares, samples, errors."""
    shape = sheet()
    origins, directions = camera_rays(0)
    speed: dict[str, list[float]] = {"tracing": [], "first frame": [], "repeated frame": [], "orbit frame": []}
    facts: dict[str, tuple[str, float]] = {}
    for repeat in range(REPEATS):
        tree = _core.ri_tree.ReferenceTree(shape, "MIRROR", **SETTINGS)
        tree.trace(origins, directions)  # dices what the rays meet
        truth = tree.trace(origins, directions)
        empty = tree.statistics()
        first = tree.ask(origins, directions)
        filled = tree.statistics()
        again = tree.ask(origins, directions)
        speed["tracing"].append(truth["seconds"] / len(origins) * 1e9)
        speed["first frame"].append(truth["seconds"] / first["seconds"])
        speed["repeated frame"].append(truth["seconds"] / again["seconds"])
        orbit = traced_orbit = 0.0
        for frame in range(1, ORBIT_FRAMES + 1):
            rays = camera_rays(frame)
            traced_orbit += tree.trace(*rays)["seconds"]
            orbit += tree.ask(*rays)["seconds"]
        speed["orbit frame"].append(traced_orbit / orbit)
        if repeat > 0:
            continue
        check(truth, first)
        rgb, degrees = errors(first, truth)
        facts["error of the first frame"] = ("mean RGB distance", rgb)
        facts["error of interpolated directions"] = ("degrees", degrees)
        for name, share in shares(empty, filled).items():
            facts[f"first frame: {name}"] = ("% of rays", share)
        traced = sum(share for name, share in shares(empty, filled).items() if name.startswith("traced"))
        facts["first frame: traced in all"] = ("% of rays", traced)
        facts["samples of the first frame"] = ("a ray", filled["samples_taken"] / len(origins))
        facts["samples of the orbit frames"] = (
            "a ray",
            (tree.statistics()["samples_taken"] - filled["samples_taken"]) / len(origins) / ORBIT_FRAMES,
        )
        facts["held after the first frame"] = ("MB", filled["bytes"] / 1e6)
        facts["held after the orbit"] = ("MB", tree.statistics()["bytes"] / 1e6)
    rows = [{"name": "tracing", "unit": "ns a ray", "values": speed.pop("tracing")}]
    rows += [
        {"name": f"reference, {name}", "unit": "times as fast as tracing", "values": v} for name, v in speed.items()
    ]
    rows += [{"name": name, "unit": unit_name, "values": [value]} for name, (unit_name, value) in facts.items()]
    return rows
