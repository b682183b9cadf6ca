"""Whole scenes that hypothesis draws, of all kinds of shapes, materials, lamps, cameras and settings: light is finite and
never negative, and neither threads nor the cache's size show in it. What it finds is kept as an example here."""

import numpy as np
import path_scenes
import scenes
import strand_shapes
import swept_support
from core import subdivision_cages as cages
from hypothesis import HealthCheck, example, given, settings
from hypothesis import strategies as st

POINTS = np.array([[-0.8, 0, 0], [-0.2, 0.6, 0.3], [0.4, -0.6, -0.2], [0.8, 0.1, 0.4]])
SHAPES = {
    "surface": lambda core, scene: scene.add_surface("surface", [scenes.sphere_spline(core)]),
    "mesh": lambda core, scene: scene.add_mesh("mesh", scenes.CUBE_VERTICES, scenes.CUBE_TRIANGLES),
    "curve": lambda core, scene: scene.add_curve(
        swept_support.curve("NURBS", POINTS, order=4, endpoint=True, bevel_depth=0.15, fill_caps=True)
    ),
    "strand": lambda core, scene: scene.add_shape(strand_shapes.strand(POINTS, 0.1, basis="CATMULL_ROM")),
    "subdivision": lambda core, scene: scene.add_shape(cages.cube().surface()),
}
CLOSURES = {
    "diffuse": ("diffuse", 1.0, 0.7),
    "mirror": ("glossy", 1.0, 0.9, 0.0, "GGX"),
    "rough": ("glossy", 1.0, 0.9, 0.4, "GGX"),
    "glass": ("glass", 1.0, 0.9, 0.0, 1.5, "GGX"),
    "frosted": ("glass", 1.0, 0.9, 0.3, 1.3, "GGX"),
    "clear": ("transparent", 1.0, 0.8),
    "light": ("emission", 1.0, 1.0, 2.0),
}
number = st.floats(-1.0, 1.0, width=32)
thing = st.tuples(
    st.sampled_from(sorted(SHAPES)),
    st.lists(st.sampled_from(sorted(CLOSURES)), min_size=1, max_size=2, unique=True),
    st.tuples(number, number, number),  # place
    st.tuples(*[st.sampled_from([1e-3, 0.3, 1.0, -0.5])] * 3),  # size along each axis; negative: mirrored
)
lamp = st.tuples(
    st.sampled_from(["POINT", "SUN", "SPOT", "RECTANGLE", "DISK"]),
    st.tuples(number, number, number),
    st.sampled_from([1e-3, 1.0, 1e3]),
    st.sampled_from([0.0, 1e-6, 0.5]),  # its size
)
setting = st.fixed_dictionaries(
    {
        "integrator": st.sampled_from(["PATH", "DISTRIBUTION"]),
        "film_transparent": st.booleans(),
        "tessellation_factor": st.sampled_from([0.25, 1.0, 8.0]),
        "stochastic_levels": st.booleans(),
        "samples": st.integers(1, 3),
        "seed": st.integers(0, 1000),
    }
)
# Found.
PASSES_TOO_MUCH = ("mesh", ["clear", "rough"], (0.0, 0.0, 0.0), (0.3, 0.3, 1e-3))
FEW = dict(
    integrator="PATH", film_transparent=True, tessellation_factor=0.25, stochastic_levels=False, samples=1, seed=1
)


def build(core, things, lamps, offset, kind):
    scene = core.SceneDescription()
    for i, (shape, closures, place, sizes) in enumerate(things):
        material = path_scenes.material(core, scene, *[CLOSURES[name] for name in closures], name=f"material {i}")
        matrix = scenes.matrix(np.array(place) + offset)
        matrix[:3, :3] = np.diag(sizes)
        scene.add_instance(f"thing {i}", SHAPES[shape](core, scene), matrix, material)
    for i, (name, place, power, size) in enumerate(lamps):
        matrix = scenes.matrix(2 * np.array(place) + offset)
        more = dict(radius=size, angle=size, size_x=size, size_y=size, spot_size=1.0)
        scene.add_lamp(f"lamp {i}", name, matrix, (power,) * 3, **more)
    scene.set_world(scenes.background(core, (0.3, 0.4, 0.5)))
    half = 0.4 if kind == "PERSPECTIVE" else 1.6
    camera = scenes.matrix((offset, offset, offset + 4))
    scene.set_camera(kind, camera, (-half, -half), (half, half), 0.01, 100.0)
    return scene


@settings(max_examples=40, deadline=None, suppress_health_check=list(HealthCheck))
@given(
    things=st.lists(thing, min_size=1, max_size=4),
    lamps=st.lists(lamp, max_size=2),
    offset=st.sampled_from([0.0, 1e3, 1e6]),
    kind=st.sampled_from(["PERSPECTIVE", "ORTHOGRAPHIC"]),
    rays=st.sampled_from(["OFF", "ON"]),
    chosen=setting,
)
@example(things=[PASSES_TOO_MUCH], lamps=[], offset=0.0, kind="PERSPECTIVE", rays="OFF", chosen=FEW)  # alpha below 0
def test_drawn_scenes_are_finite_and_the_same_for_any_threads_and_caches(
    core, things, lamps, offset, kind, rays, chosen
):
    passes = path_scenes.ALL_PASSES
    pictures = []
    for threads, megabytes in ((1, 30.0), (2, 0.0), (2, 0.05)):
        scene = build(core, things, lamps, offset, kind)
        interpolation = core.RayInterpolation(rays, cache_bytes=int(megabytes * 2**20), rays_per_cell=0.5)
        machine = dict(
            threads=threads, geometry_cache_megabytes=megabytes, ray_interpolation=interpolation, tile_size=4
        )
        pictures.append(scenes.render(core, scene, width=8, height=8, passes=passes, **chosen, **machine))
    first, *others = pictures
    for name, values in first.items():
        assert np.isfinite(values).all(), name
        if name not in ("position", "normal", "uv"):
            assert (values >= 0).all(), name
        for other in others:
            np.testing.assert_array_equal(values, other[name], err_msg=name)
    assert first["combined"][..., 3].max() <= 1
