"""Directed lines as points of line space, and the corner rays of its cells."""

from fractions import Fraction

import numpy as np
import pytest
from core import ri_tree_support as support
from core import shapes

DIRECTIONS = range(6)


def axes_of(direction):
    axis = direction // 2
    return axis, (axis + 1) % 3, (axis + 2) % 3


def some_cells(tree, direction, seed, count=40):
    random = np.random.default_rng(seed)
    for _ in range(count):
        depth = int(random.integers(0, 61))
        levels = tree.levels(direction, depth)
        yield direction, depth, [int(random.integers(0, 2**level)) for level in levels], levels


@pytest.mark.parametrize("direction", DIRECTIONS)
def test_corner_rays_are_the_integers_of_the_cell_rounded_once(direction):
    """Against exact fractions. The cube's box is exact: half of it is 1/2 or 1, plus 2^-10 of that."""
    tree = support.tree_of(shapes.cube(), "SIMPLE")
    half = Fraction(tree.box()[1][0])
    assert [Fraction(-x) for x in tree.box()[0]] == [half] * 3 and half.denominator <= 2**11
    axis, b, c = axes_of(direction)
    sense = -1 if direction % 2 else 1
    for _, depth, index, levels in some_cells(tree, direction, 10 + direction):
        origins, directions = tree.corner_rays((direction, depth, index))
        for corner in range(16):
            share = [Fraction(index[k] + (corner >> k & 1), 2 ** levels[k]) for k in range(4)]
            side = [2 * half, 2 * half, Fraction(1), Fraction(1)]
            p, q, m, n = (Fraction(float(side[k] * (2 * share[k] - 1))) for k in range(4))
            front = -sense * half
            assert origins[corner][axis] == front, (depth, index, corner)
            assert origins[corner][b] == float(p + m * front), (depth, index, corner)
            assert origins[corner][c] == float(q + n * front), (depth, index, corner)
            exact = np.array([float(x) for x in (m, n)])
            np.testing.assert_allclose(directions[corner][[b, c]] / directions[corner][axis], exact, atol=3e-16)


@pytest.mark.parametrize("name", ["cube", "nurbs_torus", "lumpy_torus"])
def test_a_lattice_point_has_one_ray_whatever_cell_it_is_a_corner_of(name):
    tree = support.tree_of(getattr(shapes, name)(), "SIMPLE")
    compared = 0
    for direction in DIRECTIONS:
        for _, depth, index, levels in some_cells(tree, direction, 20 + direction):
            here = np.concatenate(tree.corner_rays((direction, depth, index)), axis=1)
            # The same corner of the descendant that lies in it.
            deeper = min(depth + 7, 60)
            more = [after - before for before, after in zip(levels, tree.levels(direction, deeper))]
            for corner in (0, 5, 10, 15):
                inside = [((i + (corner >> k & 1)) << more[k]) - (corner >> k & 1) for k, i in enumerate(index)]
                there = np.concatenate(tree.corner_rays((direction, deeper, inside)), axis=1)
                np.testing.assert_array_equal(here[corner], there[corner])
            # The upper corners are the lower ones of the next cell along each axis.
            for k in range(4):
                if index[k] + 1 == 2 ** levels[k]:
                    continue
                beside = np.concatenate(
                    tree.corner_rays((direction, depth, [i + (j == k) for j, i in enumerate(index)])), axis=1
                )
                upper = [corner for corner in range(16) if corner >> k & 1]
                np.testing.assert_array_equal(here[upper], beside[[corner - (1 << k) for corner in upper]])
                compared += 1
    assert compared > 100


@pytest.mark.parametrize("name", ["cube", "nurbs_torus", "lumpy_torus"])
def test_the_line_of_a_corner_ray_is_that_corner(name):
    tree = support.tree_of(getattr(shapes, name)(), "SIMPLE")
    for direction in DIRECTIONS:
        for _, depth, index, levels in some_cells(tree, direction, 30 + direction, 20):
            origins, directions = tree.corner_rays((direction, depth, index))
            found, shares = tree.lines(origins, directions)
            corners = np.array([[index[k] + (corner >> k & 1) for k in range(4)] for corner in range(16)])
            expected = corners / 2.0 ** np.array(levels)
            # If a slope is 1, another axis is equally dominant.
            plain = (expected[:, 2:] > 0).all(axis=1) & (expected[:, 2:] < 1).all(axis=1)
            assert (found[plain] == direction).all()
            np.testing.assert_allclose(shares[plain], expected[plain], atol=1e-14)


def test_a_line_does_not_depend_on_the_length_of_its_direction_nor_on_its_start():
    tree = support.tree_of(shapes.nurbs_torus(), "SIMPLE")
    origins, directions = support.scattered_rays(2000)
    direction, shares = tree.lines(origins, directions)
    assert set(direction) == set(DIRECTIONS)
    for moved, scale in ((0.0, 1e-150), (0.0, 3e150), (2.5, 1.0)):
        again, same = tree.lines(origins + moved * directions, scale * directions)
        np.testing.assert_array_equal(direction, again)
        np.testing.assert_allclose(shares, same, atol=1e-14)


def test_every_line_that_meets_the_box_lies_inside_the_root_cell():
    for shape in (shapes.cube(), support.square(), support.cuboid((1e-5, 1, 0.02))):
        tree = support.tree_of(shape, "SIMPLE")
        low, high = (np.array(corner) for corner in tree.box())
        random = np.random.default_rng(3)
        points = random.uniform(low, high, (5000, 3))
        directions = shapes.random_directions(random, 5000)
        _, shares = tree.lines(points, directions)
        assert ((shares > 0) & (shares < 1)).all()


def test_ties_of_the_dominant_direction_go_to_the_first_axis():
    tree = support.tree_of(shapes.cube(), "SIMPLE")
    signs = [(1, 1, 1), (-1, 1, 1), (1, -1, -1), (-1, -1, -1), (0, 1, 1), (0, -1, 1), (0, 1, -1), (1, 0, -1)]
    directions = np.array(signs, float)
    found, _ = tree.lines(np.zeros((len(signs), 3)), directions)
    np.testing.assert_array_equal(found, [0, 1, 0, 1, 2, 3, 2, 0])


@pytest.mark.parametrize("half", [(1, 1, 1), (1, 1, 1e-6), (1e-6, 1, 1e-6), (0.2, 1, 0.6)])
def test_the_longest_side_is_halved(half):
    """The side of a slope is measured as its length over the half extent."""
    tree = support.tree_of(support.cuboid(half), "SIMPLE")
    low, high = (np.array(corner) for corner in tree.box())
    sides = (high - low) / 2
    extent = sides.max() / (1 + 2.0**-10)
    for direction in (0, 2, 4):
        axis, b, c = axes_of(direction)
        lengths = np.array([sides[b] + sides[axis], sides[c] + sides[axis], extent, extent])
        for depth in range(60):
            before, after = (np.array(tree.levels(direction, d)) for d in (depth, depth + 1))
            (halved,) = np.nonzero(after - before)[0]
            longest = (lengths / 2.0**before).max()
            # Equal sides may differ by the rounding of the extent here.
            assert lengths[halved] / 2.0 ** before[halved] >= longest * (1 - 1e-12)
