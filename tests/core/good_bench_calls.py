"""Calls that hold of what the core binds for tests and benchmarks alone."""

import numpy as np
import rayleaf_rivals as rivals
from core import shapes
from core.good_arguments import (
    ROWS,
    UP,
    baseline,
    CELL,
    Call,
    HEMISPHERE,
    NUMBERS,
    PATCH_SPLINE,
    RAYS,
    SURFACE_ROWS,
    T,
    TRIANGLE,
    TRIPLES,
    closures,
    ctor,
    flat,
    later,
    method,
    plane,
    points,
    program,
    rival,
    store,
    swept,
    tracer,
    tree,
)
from rayleaf import _core

distribution = _core.distribution
ri_tree = _core.ri_tree
shading = _core.shading
trace = _core.trace

BENCH_CALLS: dict[str, Call] = {
    "distribution.glossy_differential": ctor(
        distribution.glossy_differential,
        incoming=ROWS,
        direction=UP,
        surface=SURFACE_ROWS,
        scattered=UP,
        density=1.0,
        eta=1.0,
        rays=4,
    ),
    "distribution.path_differential": ctor(
        distribution.path_differential,
        incoming=ROWS,
        direction=UP,
        surface=SURFACE_ROWS,
        scattered=UP,
        roughness=0.5,
        diffuse=True,
    ),
    "distribution.hemisphere_differential": ctor(
        distribution.hemisphere_differential, incoming=ROWS, direction=UP, cosine=0.5, rays=4
    ),
    "distribution.shadow_differential": ctor(
        distribution.shadow_differential, incoming=ROWS, direction=UP, distance=1.0, density=1.0, delta=False, rays=4
    ),
    "distribution.hemisphere_directions": ctor(
        distribution.hemisphere_directions, rays=8, random=np.full((HEMISPHERE, 2), 0.5, np.float32)
    ),
    "distribution.hemisphere_shape": ctor(distribution.hemisphere_shape, rays=8),
    "distribution.hemisphere_record": ctor(
        distribution.hemisphere_record,
        rays=8,
        normal=UP,
        radiance=np.ones(HEMISPHERE, np.float32),
        distance=np.ones(HEMISPHERE, np.float32),
        radius_limits=(0.1, 1.0),
    ),
    "distribution.branch_pairs": ctor(distribution.branch_pairs, pixel=1, samples=2, count=3, tag=4, dimension=5),
    "ri_tree.quality_settings": ctor(ri_tree.quality_settings, error=0.01),
    "ri_tree.RayCache.ask": method(tree, "ask", **RAYS, distances=T.astype(np.float32), angles=T.astype(np.float32)),
    "ri_tree.RayCache.trace": method(tree, "trace", **RAYS),
    "ri_tree.RayCache.next_frame": method(tree, "next_frame"),
    "ri_tree.RayCache.statistics": method(tree, "statistics"),
    "ri_tree.FastTree.changes": method(
        tree,
        "changes",
        **RAYS,
        origin_steps=np.zeros((2, 2, 3), np.float32),
        direction_steps=np.zeros((2, 2, 3), np.float32),
    ),
    "ri_tree.FastTree.samples": method(tree, "samples", direction=0, places=np.zeros((2, 4), np.uint32)),
    "rivals.RivalTracer": ctor(rivals.RivalTracer, objects=[(flat(), "MIRROR", 1.0)], method="NEWTON"),
    "rivals.RivalTracer.trace": method(rival, "trace", **RAYS),
    "rivals.FlopCounter": later(rivals.FlopCounter, tracer=rival),
    "rivals.FlopCounter.count": method(lambda: rivals.FlopCounter(rival()), "count", **RAYS),
    "rivals.ImagePlane": ctor(rivals.ImagePlane, shape=shapes.nurbs_sphere(), kind="MIRROR"),
    "rivals.ImagePlane.look": method(plane, "look", eye=(0, 0, 5), corner=(-1, -1, -2), right=(1, 0, 0), up=(0, 1, 0)),
    "rivals.ImagePlane.statistics": method(plane, "statistics"),
    "rivals.ObjectSet": later(rivals.ObjectSet, parts=lambda: [(shapes.nurbs_sphere(), tree())]),
    "rivals.ObjectSet.ask": method(
        lambda: rivals.ObjectSet([(shapes.nurbs_sphere(), tree())]),
        "ask",
        **RAYS,
        distances=T.astype(np.float32),
        angles=T.astype(np.float32),
        points=np.zeros((2, 2)),
        left=np.full(2, -1, np.int32),
    ),
    "shading.TextureStore": ctor(shading.TextureStore, memory_limit=1 << 24),
    "shading.TextureStore.add_file": method(store, "add_file", name="a", path="nowhere", space=shading.ColorSpace.SRGB),
    "shading.TextureStore.add_pixels": method(
        store, "add_pixels", name="a", pixels=np.ones((2, 3, 4), np.float32), space=shading.ColorSpace.SRGB
    ),
    "shading.TextureStore.lookup": method(
        store,
        "lookup",
        id=0,
        uv=NUMBERS,
        duv_dx=NUMBERS,
        duv_dy=NUMBERS,
        extension=shading.Extension.REPEAT,
        interpolation=shading.Interpolation.LINEAR,
    ),
    "shading.TextureStore.statistics": method(store, "statistics"),
    "shading.Points.values": method(points, "values", program=program(), register=0),
    "shading.Points.results": method(points, "results", program=program()),
    "shading.Points.closures": method(points, "closures", program=program(), index=0),
    "shading.surface_points": ctor(
        shading.surface_points,
        position=TRIPLES,
        normal=TRIPLES,
        outgoing=TRIPLES,
        uv=NUMBERS,
        facet_normal=TRIPLES,
        dp_du=TRIPLES,
        dp_dv=TRIPLES,
        dp_dx=TRIPLES,
        dp_dy=TRIPLES,
        object_to_world=np.eye(4),
    ),
    "shading.world_directions": ctor(shading.world_directions, direction=TRIPLES, dd_dx=TRIPLES, dd_dy=TRIPLES),
    "shading.Closures.evaluate": method(closures, "evaluate", outgoing=UP, incoming=TRIPLES, facet_normal=UP),
    "shading.Closures.density": method(closures, "density", outgoing=UP, incoming=TRIPLES, facet_normal=UP),
    "shading.Closures.sample": method(closures, "sample", outgoing=UP, facet_normal=UP, random=TRIPLES),
    "shading.Closures.evaluate_medium": method(closures, "evaluate_medium", outgoing=UP, incoming=TRIPLES),
    "shading.Closures.sample_medium": method(closures, "sample_medium", outgoing=UP, random=TRIPLES),
    "shading.Closures.has_smooth_lobes": method(closures, "has_smooth_lobes"),
    "shading.Closures.albedo": method(closures, "albedo", outgoing=UP, kind=shading.LobeKind.DIFFUSE),
    "trace.GeometryCacheSettings": ctor(trace.GeometryCacheSettings, megabytes=1.0),
    "trace.TriangleMesh": ctor(
        trace.TriangleMesh, name="mesh", **TRIANGLE, material_slots=np.zeros(1, np.int32), uv=np.zeros((3, 2))
    ),
    "trace.PatchSurface": ctor(trace.PatchSurface, name="surface", splines=[PATCH_SPLINE]),
    "trace.PatchSurface.normal_at": method(shapes.nurbs_sphere, "normal_at", patch=0, u=0.5, v=0.5),
    "trace.SweptSurface": later(trace.SweptSurface, curve=swept),
    "trace.SweptSurface.rings": method(lambda: trace.SweptSurface(swept()), "rings", places=T),
    "trace.Tracer": ctor(trace.Tracer, instances=[(shapes.nurbs_sphere(), np.eye(4), 31)]),
    "trace.Tracer.closest_hits": method(
        tracer, "closest_hits", **RAYS, t_min=T, t_max=T + 9, width=T, spread=T, starts=np.zeros((2, 4), np.uint32)
    ),
    "trace.Tracer.occluded": method(tracer, "occluded", **RAYS, t_min=T, t_max=T + 9),
    "trace.Tracer.timed_closest": method(
        tracer, "timed_closest", **RAYS, width=T, spread=T, starts=np.zeros((2, 4), np.uint32)
    ),
    "trace.Tracer.bounds": method(tracer, "bounds"),
    "trace.Tracer.statistics": method(tracer, "statistics"),
    "trace.simd_targets": ctor(trace.simd_targets),
    "trace.use_simd_target": ctor(trace.use_simd_target, name=""),
    "trace.diced_patch": ctor(trace.diced_patch, surface=shapes.nurbs_sphere(), patch=0),
    "trace.grid_candidates": ctor(trace.grid_candidates, surface=shapes.nurbs_sphere(), patch=0, **RAYS),
    "trace.moved": ctor(trace.moved, matrices=np.stack([np.eye(4), shapes.moved(1.0)]), time=0.5),
    "trace.closest_in_packets": later(
        trace.closest_in_packets,
        tracer=tracer,
        origins=lambda: RAYS["origins"],
        directions=lambda: RAYS["directions"],
        starts=lambda: np.zeros((2, 4), np.uint32),
    ),
    "trace.occluded_in_packets": later(
        trace.occluded_in_packets,
        tracer=tracer,
        origins=lambda: RAYS["origins"],
        directions=lambda: RAYS["directions"],
        t_max=lambda: T + 9,
    ),
    "trace.cracks": later(
        trace.cracks,
        tracer=tracer,
        origins=lambda: RAYS["origins"],
        directions=lambda: RAYS["directions"],
        width=lambda: T,
        spread=lambda: T,
        inside=lambda: False,
    ),
    "rivals.EmbreeBaseline": ctor(
        rivals.EmbreeBaseline, surface=shapes.nurbs_sphere(), primitive="GRID", pixel_angle=0.1
    ),
    "rivals.EmbreeBaseline.timed_closest": method(baseline, "timed_closest", **RAYS, width=T, spread=T),
}
for _of, _make in (("ri_tree.FastTree", ri_tree.FastTree), ("rivals.ReferenceTree", rivals.ReferenceTree)):
    BENCH_CALLS[_of] = ctor(_make, shape=shapes.nurbs_sphere(), kind="MIRROR")
    BENCH_CALLS[f"{_of}.final_cells"] = method(lambda make=_make: tree(make=make), "final_cells", **RAYS)
    BENCH_CALLS[f"{_of}.corner_rays"] = method(lambda make=_make: tree(make=make), "corner_rays", cell=CELL)
    BENCH_CALLS[f"{_of}.center_ray"] = method(lambda make=_make: tree(make=make), "center_ray", cell=CELL)
    BENCH_CALLS[f"{_of}.levels"] = method(lambda make=_make: tree(make=make), "levels", direction=0, depth=3)
    BENCH_CALLS[f"{_of}.box"] = method(lambda make=_make: tree(make=make), "box")
    BENCH_CALLS[f"{_of}.lines"] = method(lambda make=_make: tree(make=make), "lines", **RAYS)
