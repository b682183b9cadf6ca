"""The SIMD kernels against plain NumPy in the same precision, and against each other."""

import numpy as np
import pytest
from core import shapes

trace = shapes.trace
F = np.float32


def bernstein(degree, count):
    """The basis at k / count in float, rounded once from double: (degree + 1, count + 1)."""
    t = np.arange(count + 1) / count
    values = [np.ones_like(t)]
    for k in range(degree):
        lower = values
        values = [lower[0] * (1 - t)]
        values += [lower[i] * (1 - t) + lower[i - 1] * t for i in range(1, k + 1)]
        values.append(lower[k] * t)
    return np.array(values).astype(F)


def symmetric_sum(terms):
    """The kernels' order: pairs from both ends, then the middle one. In float."""
    degree = len(terms) - 1
    total = terms[0] + terms[degree]
    for i in range(1, (degree + 1) // 2):
        total = total + (terms[i] + terms[degree - i])
    return total + terms[degree // 2] if degree % 2 == 0 else total


def single_patch(degree_u, degree_v, rational, seed):
    """A surface of one Bezier patch that keeps its coordinates in local space, and its control points."""
    random = np.random.default_rng(seed)
    points = random.uniform(-1, 1, (degree_v + 1, degree_u + 1, 4)).astype(F).astype(float)
    points[..., 3] = random.choice([0.5, 1.0, 2.0], points.shape[:2]) if rational else 1.0
    points[0, 0, :3], points[-1, -1, :3] = -1.0, 1.0  # the box decides centre 0 and scale 1
    clamped = (False, True, False)
    surface = trace.PatchSurface("patch", [(points, (degree_u + 1, *clamped), (degree_v + 1, *clamped), True, 0)])
    return surface, points


@pytest.mark.parametrize("target", trace.simd_targets())
@pytest.mark.parametrize("rational", [False, True])
@pytest.mark.parametrize("degrees", [(1, 1), (2, 3), (3, 3), (4, 5), (5, 2)])
def test_dicing_equals_its_numpy_twin_bit_by_bit(degrees, rational, target, any_target):
    assert trace.use_simd_target(target)
    surface, points = single_patch(*degrees, rational, seed=sum(degrees))
    homogeneous = points.copy()
    homogeneous[..., :3] *= points[..., 3:]
    control = homogeneous.astype(F)
    along_v = bernstein(degrees[1], 16)
    curves = symmetric_sum([along_v[j][:, None, None] * control[j][None] for j in range(degrees[1] + 1)])
    along_u = bernstein(degrees[0], 16)
    grid = symmetric_sum([along_u[i][None, :, None] * curves[:, i][:, None] for i in range(degrees[0] + 1)])
    expected = grid[..., :3] / grid[..., 3:] if rational else grid[..., :3]
    np.testing.assert_array_equal(trace.diced_patch(surface, 0), expected)


CORNER_ERROR = F(2.0**-19)  # how far single precision may move a corner aside


def first_candidates(grid, origins, directions):
    """All 512 facets, one after the other, in float: (t of the nearest corner, triangle) of the first that the true ray
    may hit."""
    results = []
    for origin, direction in zip(origins.astype(F), directions.astype(F)):
        z = int(np.argmax(np.abs(direction)))
        x, y = (z + 1) % 3, (z + 2) % 3
        scale = F(1) / direction[z]
        shear_x, shear_y = direction[x] * scale, direction[y] * scale
        moved = grid - origin
        depth = moved[..., z]
        px, py = moved[..., x] - shear_x * depth, moved[..., y] - shear_y * depth
        corner = lambda i, j: (px[j : 16 + j, i : 16 + i], py[j : 16 + j, i : 16 + i], depth[j : 16 + j, i : 16 + i])
        edge = lambda p, q: p[0] * q[1] - p[1] * q[0]
        a, b, c, d = corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)
        size = lambda p: np.abs(p[0]) + np.abs(p[1])
        error = (((size(a) + size(b)) + (size(c) + size(d))) + CORNER_ERROR) * CORNER_ERROR
        best = (np.inf, -1)
        for half, (p, q, r) in enumerate(((a, b, c), (a, c, d))):
            pq, qr, rp = edge(p, q), edge(q, r), edge(r, p)
            edges = np.stack([pq, qr, rp])
            inside = (edges.min(axis=0) >= -error) | (edges.max(axis=0) <= error)
            depths = np.stack([p[2], q[2], r[2]]) * scale
            t = depths.min(axis=0)
            for j, i in np.argwhere(inside & (depths.max(axis=0) >= 0)):
                best = min(best, (float(t[j, i]), 2 * (16 * int(j) + int(i)) + half))
        results.append(best)
    return np.array([t for t, _ in results]), np.array([k for _, k in results])


def kernel_rays(grid, count):
    random = np.random.default_rng(41)
    targets = grid.reshape(-1, 3)[random.integers(0, 289, count)].astype(float)
    targets[: count // 2] += random.normal(scale=0.02, size=(count // 2, 3))
    origins = random.uniform(-1, 1, (count, 3))
    directions = shapes.unit(targets - origins)
    directions[:20] = np.eye(3)[random.integers(0, 3, 20)]  # along the axes: two components are zero
    origins[:20] = targets[-20:] - directions[:20]
    return origins.astype(F), directions.astype(F)


def test_a_choice_of_instruction_set_hides_none_of_the_others(any_target):
    targets = trace.simd_targets()
    assert len(targets) >= 2
    for target in targets:
        assert trace.use_simd_target(target)
        assert trace.simd_targets() == targets


@pytest.mark.parametrize("target", trace.simd_targets())
def test_the_grid_kernel_equals_its_numpy_twin(target, any_target):
    assert trace.use_simd_target(target)
    surface, _ = single_patch(3, 3, False, seed=5)
    grid = trace.diced_patch(surface, 0)
    origins, directions = kernel_rays(grid, 300)
    t, triangle = trace.grid_candidates(surface, 0, origins, directions)
    expected_t, expected_triangle = first_candidates(grid, origins, directions)
    assert (expected_triangle >= 0).mean() > 0.5
    np.testing.assert_array_equal(triangle, expected_triangle)
    np.testing.assert_array_equal(t, expected_t.astype(F))


@pytest.mark.parametrize("width", [0.0, 0.02], ids=["fine", "levels"])
def test_all_instruction_sets_give_the_same_bits(width, any_target):
    random = np.random.default_rng(42)
    origins = 2 * shapes.random_directions(random, 5000)
    directions = shapes.unit(0.9 * shapes.random_directions(random, 5000) - origins)
    results = []
    for target in trace.simd_targets():
        assert trace.use_simd_target(target)
        tracer = trace.Tracer([(shapes.nurbs_torus(), np.eye(4), 31), (shapes.lumpy_torus(), np.eye(4), 31)])
        wide = np.full(len(origins), width, np.float32)
        results.append(tracer.closest_hits(origins, directions, width=wide, spread=wide))
    for other in results[1:]:
        for key, value in results[0].items():
            np.testing.assert_array_equal(value, other[key], err_msg=key)


def test_neighbouring_patches_share_the_bits_of_their_border():
    surface = shapes.lumpy_torus()  # 16 patches along u, 24 along v, closed in both directions
    grids = np.array([trace.diced_patch(surface, i) for i in range(surface.element_count)]).reshape(24, 16, 17, 17, 3)
    np.testing.assert_array_equal(grids[:, :, :, 16], np.roll(grids, -1, axis=1)[:, :, :, 0])
    np.testing.assert_array_equal(grids[:, :, 16], np.roll(grids, -1, axis=0)[:, :, 0])


def test_a_pole_is_one_point_in_all_patches_around_it():
    surface = shapes.nurbs_sphere()
    grids = np.array([trace.diced_patch(surface, i) for i in range(surface.element_count)])
    for pole in (-1.0, 1.0):
        vertices = grids[np.abs(grids[..., 2] - pole) < 1e-6]
        assert len(vertices) == 4 * 17
        assert len(np.unique(vertices, axis=0)) == 1


def test_a_border_run_backwards_has_the_same_vertices():
    random = np.random.default_rng(43)
    points = np.ones((4, 4, 4))
    points[..., :3] = random.uniform(-1, 1, (4, 4, 3)).astype(F)
    points[0, 0, :3], points[-1, -1, :3] = -1.0, 1.0
    bezier = (4, False, True, False)
    grid = [
        trace.diced_patch(trace.PatchSurface("p", [(p.copy(), bezier, bezier, True, 0)]), 0)
        for p in (points, points[::-1, ::-1], points.transpose(1, 0, 2))
    ]
    # Borders only: inside, rounding may depend on which direction is evaluated first.
    for side in (np.s_[0], np.s_[16], np.s_[:, 0], np.s_[:, 16]):
        np.testing.assert_array_equal(grid[0][side], grid[1][::-1, ::-1][side])
        np.testing.assert_array_equal(grid[0][side], grid[2].transpose(1, 0, 2)[side])
