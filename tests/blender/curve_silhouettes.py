"""Inside Blender: whether the exact surface of a curve object covers the pixels that Blender's own mesh covers."""

import numpy as np

# Pixels along a side of a picture, and how far from a silhouette they do not count: as far as facets and rounding move it.
SIDE = 256
MARGIN = 1
# A quad bends by less than this part of the whole mesh, or is met in so many steps each way.
PLANE, QUAD_STEPS = 5e-4, 8


def _quads_as_triangles(corners):
    """(n, 4, 3) -> (m, 3, 3): bilinear surfaces between four corners, in steps where these are not in a plane."""
    bend = np.linalg.norm(corners[:, 0] - corners[:, 1] + corners[:, 2] - corners[:, 3], axis=1)
    size = np.ptp(corners.reshape(-1, 3), axis=0).max() if len(corners) else 0.0
    result = []
    for chosen, steps in ((bend <= PLANE * size, 1), (bend > PLANE * size, QUAD_STEPS)):
        share = np.arange(steps + 1) / steps
        s, t = share[:, None, None, None], share[None, :, None, None]
        a, b, c, d = corners[chosen].transpose(1, 0, 2)
        net = (1 - s) * ((1 - t) * a + t * b) + s * ((1 - t) * d + t * c)
        low, right, far, left = net[:-1, :-1], net[:-1, 1:], net[1:, 1:], net[1:, :-1]
        result += [np.stack(part, axis=-2).reshape(-1, 3, 3) for part in ((low, right, far), (low, far, left))]
    return np.concatenate(result)


def mesh_triangles(item, depsgraph):
    """(n, 3, 3): Blender's evaluated mesh. Its quads are the surfaces between two rings, not their halves."""
    evaluated = item.evaluated_get(depsgraph)
    mesh = evaluated.to_mesh()
    mesh.calc_loop_triangles()
    vertices = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", vertices)
    triangles, polygons = np.empty(len(mesh.loop_triangles) * 3, np.int32), np.empty(len(mesh.loop_triangles), np.int32)
    mesh.loop_triangles.foreach_get("vertices", triangles)
    mesh.loop_triangles.foreach_get("polygon_index", polygons)
    corners, sizes, starts = np.empty(len(mesh.loops), np.int32), *np.empty((2, len(mesh.polygons)), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    mesh.polygons.foreach_get("loop_total", sizes)
    mesh.polygons.foreach_get("loop_start", starts)
    evaluated.to_mesh_clear()
    vertices = vertices.reshape(-1, 3).astype(float)
    quads = corners[starts[sizes == 4][:, None] + np.arange(4)]
    others = triangles.reshape(-1, 3)[sizes[polygons] != 4]
    return np.concatenate([_quads_as_triangles(vertices[quads]), vertices[others]])


def mesh_of(core, triangles):
    """Triangles (n, 3, 3) as a shape."""
    corners = np.arange(3 * len(triangles), dtype=np.int32).reshape(-1, 3)
    return core.trace.TriangleMesh("mesh", triangles.reshape(-1, 3).astype(np.float32), corners)


def views(triangles, seed):
    """(frame, center, half side) of parallel projections in which triangles (n, 3, 3) are seen whole, along the frame's last row."""
    low, high = triangles.min(axis=(0, 1)), triangles.max(axis=(0, 1))
    rng = np.random.default_rng(seed)
    for turned in (False, True, True):
        frame = np.linalg.qr(rng.normal(size=(3, 3)))[0].T if turned else np.eye(3)
        yield frame, (low + high) / 2, 0.55 * np.linalg.norm(high - low)


def covered(core, shape, frame, center, half):
    """(SIDE, SIDE): which parallel rays through a square meet a shape."""
    places = (np.arange(SIDE) + 0.5) / SIDE * 2 - 1
    x, y = np.meshgrid(places * half, places * half)
    origins = center + x.reshape(-1, 1) * frame[0] + y.reshape(-1, 1) * frame[1] - 4 * half * frame[2]
    eye = tuple(center - 4 * half * frame[2])
    tracer = core.trace.Tracer([(shape, np.eye(4), 31)], pixel_angle=0.25 / SIDE, eye=eye)
    hits = tracer.closest_hits(origins, np.tile(frame[2], (len(origins), 1)))
    return (hits["instance"] >= 0).reshape(SIDE, SIDE)


def widened(mask):
    """A mask and all pixels within MARGIN of it."""
    padded = np.pad(mask, MARGIN)
    size = 2 * MARGIN + 1
    return np.logical_or.reduce([padded[i : i + SIDE, j : j + SIDE] for i in range(size) for j in range(size)])


def difference(ours, blenders):
    """How many pixels one of two masks covers and the other does not, even near by."""
    return int((ours & ~widened(blenders)).sum() + (blenders & ~widened(ours)).sum())


def off_pixels(core, shape, fine, coarse, seed):
    """Of the worst of some views: by how many pixels a shape differs from Blender's fine mesh, and the coarse mesh from the fine one."""
    meshes = [mesh_of(core, triangles) for triangles in (fine, coarse)]
    found = []
    for view in views(fine, seed):
        ours, blenders, coarser = (covered(core, each, *view) for each in (shape, *meshes))
        found.append((difference(ours, blenders), difference(coarser, blenders), int(blenders.sum())))
    off, unsettled, pixels = max(found, key=lambda each: each[0] - each[1])
    return {"off": off, "unsettled": unsettled, "pixels": pixels}
