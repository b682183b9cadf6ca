"""Derivatives of samples by their line, against finite differences, and the fourth-order error that follows."""

import numpy as np
import pytest
from core import ri_tree_support as support
from core import shapes
from core.test_fast_tree import fast_tree

PLACES = 2**31  # of a lattice axis
STEP = 2**20  # 2^-11 of the root cell's side, 2^-10 of its half: rounding of floats over it is 1e-4


def lattice_points(tree, directions, origins):
    """Places of the lines of rays of one dominant direction."""
    direction, shares = tree.lines(origins, directions)
    most = np.bincount(direction).argmax()
    return int(most), np.round(shares[direction == most] * PLACES).astype(np.uint32)


@pytest.mark.parametrize("kind", ["SIMPLE", "MIRROR", "GLASS", "VOLUME"])
def test_changes_of_samples_agree_with_finite_differences(kind):
    tree = fast_tree(shapes.nurbs_torus(), kind, ior=1.3, facet_tolerance=2.0**-22)
    origins, directions = support.scattered_rays(400, spread=0.9)
    direction, places = lattice_points(tree, directions, origins)
    assert len(places) > 40
    center = tree.samples(direction, places)
    checked = 0
    for axis in range(4):
        offset = np.zeros(4, np.int64)
        offset[axis] = STEP
        above = tree.samples(direction, (places + offset).astype(np.uint32))
        below = tree.samples(direction, (places - offset).astype(np.uint32))
        alike = center["hit"]
        for name in ("hit", "exit_class", "interior_hits", "total_reflections"):
            alike = alike & (above[name] == center[name]) & (below[name] == center[name])
        step = 2 * STEP / PLACES * 2  # in half sides
        slopes = (above["values"].astype(float) - below["values"]) / step
        differences = np.abs(slopes - center["changes"][:, :, axis])[alike]
        size = 1 + np.abs(center["changes"][:, :, axis])[alike]
        # Differences are of second order in the step; close to silhouettes and total reflection higher derivatives are
        # large, so not all lines can be judged.
        relative = np.max(differences / size, axis=1)
        assert np.median(relative) < 1e-3 and np.quantile(relative, 0.8) < 1e-2, (axis, np.sort(relative))
        checked += int(alike.sum())
    assert checked > 60


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["MIRROR", "GLASS"])
def test_the_error_is_of_fourth_order_in_the_cells_sides(kind):
    """Four more halvings halve every side: a sixteenth of the error, down to that of float leaves and facets."""
    rays = support.rays_towards(np.array([0.0, -0.6, 0.2]), 0.1, 200)
    errors, depths, threshold = [], [], 1.0
    for _ in range(3):
        settings = {"distance_threshold": threshold, "direction_threshold": np.inf, "angle_threshold": np.inf}
        tree = fast_tree(shapes.nurbs_sphere(), kind, depth_limit=40, mixed_depth_limit=40, **settings)
        got, truth = tree.ask(*rays), tree.trace(*rays)
        assert (got["answered_by"] == support.INTERPOLATED).all(), support.counts(got)
        depths.append({cell[1] for cell in tree.final_cells(*rays)})
        errors.append(np.median(support.angles(got["exit_direction"], truth["exit_direction"])))
        threshold = 0.999 * got["error"].min()  # next time none of these cells is close enough
    assert all(max(before) < min(after) for before, after in zip(depths, depths[1:])), depths
    ratios = np.array(errors[:-1]) / errors[1:]
    assert (ratios > 8).all(), (errors, ratios, depths)


def turned(directions, steps):
    """Unit directions, moved."""
    return support.shapes.unit(directions + steps)


@pytest.mark.parametrize("kind", ["SIMPLE", "MIRROR", "GLASS"])
@pytest.mark.parametrize("scale, center", [(1.0, (0, 0, 0)), (50.0, (300, -200, 1000))])
def test_changes_of_interpolated_answers_agree_with_finite_differences(kind, scale, center):
    """In two directions of the four-dimensional space of lines at once, beginning away from the box."""
    tree = fast_tree(shapes.nurbs_sphere(scale=scale, center=center), kind, ior=1.2, cache_bytes=10**9)
    origins, directions, by_origin, by_direction = support.rays_with_steps(scale, center)
    got = tree.changes(origins, directions, by_origin.astype(np.float32), by_direction.astype(np.float32))
    answers = tree.ask(origins, directions)
    assert (got["known"] == (answers["answered_by"] == support.INTERPOLATED)).all() and got["known"].mean() > 0.8
    step = 1e-6
    for i in range(2):
        sides = []
        for sign in (1, -1):
            moved = origins + sign * step * by_origin[:, i]
            sides.append(tree.ask(moved, turned(directions, sign * step * by_direction[:, i])))
        # Both in the same cell: answers may jump from cell to cell.
        cells = [tree.final_cells(origins + s * by_origin[:, i], turned(directions, s * by_direction[:, i]))
                 for s in (step, -step)]  # fmt: skip
        same = got["known"] & np.array([a == b for a, b in zip(*cells)])
        assert same.mean() > 0.7
        for name, unit in (("normal", 1.0), ("exit_position", scale), ("exit_direction", 1.0)):
            if kind != "GLASS" and name != "normal":
                continue
            slope = (sides[0][name] - sides[1][name]) / (2 * step)
            off = np.abs(slope - got[name][:, i])[same] / unit
            # Values are floats: the difference over a step of 1e-6 may be off by 2^-24 / 1e-6, some per cent.
            assert off.max() < 0.3 and np.median(off) < 0.03, (name, np.sort(off.max(axis=1))[-5:])


def test_changes_of_what_is_traced_or_missed_are_not_known():
    tree = fast_tree(shapes.nurbs_sphere(), "MIRROR", distance_threshold=0.0)
    origins, directions = support.scattered_rays(100)
    origins[0], directions[1] = np.nan, 0
    zeros = np.zeros((100, 2, 3), np.float32)
    got = tree.changes(origins, directions, zeros, zeros)
    assert not got["known"].any() and not got["normal"].any()
