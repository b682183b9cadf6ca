"""Paths traced many at once give the bits of paths traced alone."""

import numpy as np
import path_scenes
import pytest
import scenes
import shading_support
import swept_support


def passes_of(core, scene, **settings):
    session = path_scenes.render(core, scene, size=12, samples=7, passes=path_scenes.ALL_PASSES, **settings)
    return {name: session.pass_pixels(name) for name in path_scenes.ALL_PASSES}


@pytest.mark.parametrize(
    "settings",
    [
        {},
        {"threads": 3, "tile_size": 5},
        {"resident_megabytes": 0.0},
        {"filter_glossy": 1.0},
        {"reflective_caustics": False, "refractive_caustics": False},
    ],
)
@pytest.mark.parametrize("paths", [1, 17, 512, 4096])
def test_streams_of_any_size_give_the_bits_of_single_paths(core, paths, settings):
    scene = path_scenes.varied_scene(core)
    alone = passes_of(core, scene, stream_paths=0, **settings)
    together = passes_of(core, scene, stream_paths=paths, **settings)
    for name in path_scenes.ALL_PASSES:
        np.testing.assert_array_equal(together[name], alone[name], err_msg=name)
    assert np.ptp(alone["combined"]) > 0


@pytest.mark.parametrize("seed", range(4))
def test_streams_of_nasty_scenes_give_the_bits_of_single_paths(core, seed):
    scene = path_scenes.nasty_scene(core, np.random.default_rng(seed))
    pictures = [path_scenes.picture(core, scene, size=6, samples=4, stream_paths=paths) for paths in (0, 64)]
    np.testing.assert_array_equal(pictures[0], pictures[1])
    assert np.isfinite(pictures[0]).all()


def test_streams_count_the_rays_of_single_paths(core):
    scene = path_scenes.varied_scene(core)
    counts = [path_scenes.render(core, scene, stream_paths=paths).statistics()["rays"] for paths in (0, 100)]
    assert counts[0] == counts[1]
    assert counts[0]["camera"] > 0 and counts[0]["shadow"] > 0


def test_what_nobody_asks_of_rays_is_left_out_and_leaves_the_picture_alone(core):
    """An image, though nothing shows it, makes paths carry the distance of their neighbours."""
    pictures = []
    for with_image in (False, True):
        scene = path_scenes.varied_scene(core)
        if with_image:
            scene.add_image_pixels("unseen", np.ones((2, 2, 4), np.float32), "LINEAR")
        for paths in (0, 100):
            pictures.append(passes_of(core, scene, stream_paths=paths))
    for other in pictures[1:]:
        for name in path_scenes.ALL_PASSES:
            np.testing.assert_array_equal(other[name], pictures[0][name], err_msg=name)


def test_streams_of_curves_and_hair_give_the_bits_of_single_paths(core, any_target):
    """A tapered tube, hair and a ribbon among each other: traced in packets, shaded without changes of the normal."""
    scene = path_scenes.varied_scene(core)
    plain = path_scenes.material(core, scene, ("diffuse", 1.0, (0.7, 0.6, 0.4)), name="plain")
    taper = swept_support.splines("NURBS", [[0, 0.2, 0], [1, 1, 0], [2, 0.3, 0]], order=3, endpoint=True)
    tube = swept_support.curve(
        "BEZIER", swept_support.BEND_POINTS, swept_support.BEND_HANDLES, bevel_depth=0.15, fill_caps=True, taper=taper
    )
    scene.add_instance("tube", scene.add_curve(tube), path_scenes.matrix((-0.8, 0, 0.7)), plain)
    random = np.random.default_rng(6)
    roots = random.uniform(-0.6, 0.6, (60, 1, 3))
    points = (roots + np.cumsum(random.normal(0, 0.1, (60, 5, 3)), axis=1)).reshape(-1, 3)
    offsets = np.arange(0, len(points) + 1, 5, dtype=np.int32)
    for form, place in (("ROUND", 0.2), ("RIBBON", 0.6)):
        hair = core.Strands(form, points, np.full(len(points), 0.02, np.float32), offsets, form=form)
        scene.add_instance(form, scene.add_shape(hair), path_scenes.matrix((place, 0.2, 1)), plain)
    alone = passes_of(core, scene, stream_paths=0)
    for target in core.trace.simd_targets():
        assert core.trace.use_simd_target(target)
        together = passes_of(core, scene, stream_paths=512)
        for name in path_scenes.ALL_PASSES:
            np.testing.assert_array_equal(together[name], alone[name], err_msg=f"{name} by {target}")


def scene_of_lobes(core, bump_shadow, clearing):
    """Balls that scatter by a diffuse lobe, by rough facets, or by both; some with normals bent from the surface's."""
    scene = path_scenes.varied_scene(core)
    bent, facing = (0.3, -0.2, 1.0), (0.0, 0.0, 1.0)
    lying = (1.0, 0.3, 0.2)  # its mirror looks into the surface from much of where it is seen
    metal = shading_support.layers(metallic=1.0, roughness=0.3, specular_tint=(0.3, 0.9, 1.0), anisotropic=0.8)
    materials = [
        [("diffuse", 1.0, (0.7, 0.6, 0.4))],
        [("diffuse", 1.0, (0.7, 0.6, 0.4), 0.5)],
        [("diffuse", 1.0, 0.8, 0.0, bent), ("glossy", 0.5, 0.9, 0.4, bent, "GGX")],
        [("diffuse", 0.5, 0.9, 0.0, facing), ("glossy", 0.5, 0.9, 0.05, bent, "GGX")],
        [("glossy", 0.5, 0.9, 0.5, "GGX"), ("diffuse", 0.5, 0.9, 0.0)],
        [("glossy", 1.0, (1.0, 0.7, 0.4), 1.0, "GGX")],
        [("glossy", 1.0, 0.8, 0.3, "BECKMANN")],
        shading_support.principled(roughness=0.4),
        shading_support.principled(roughness=0.2, metallic=1.0, anisotropic=0.7, base_color=(0.9, 0.6, 0.2)),
        shading_support.principled(roughness=1.0, specular=0.01, normal=bent),
        shading_support.layers(roughness=0.3, clearing=clearing),
        shading_support.layers(roughness=0.4, clearing=clearing, normal=lying),
        metal,
    ]
    ball = scene.add_surface("small ball", [path_scenes.sphere_spline(core)])
    for i, each in enumerate(materials):
        if isinstance(each, list):
            of_ball = path_scenes.material(
                core, scene, *each, name=f"ball {i}", bump_shadow=bump_shadow, clearing=clearing
            )
        else:
            of_ball = scene.add_material_list([scene.add_material(f"ball {i}", each)])
        place = (0.6 * (i % 4) - 0.9, 0.6 * (i // 4) - 0.6, 0.9)
        scene.add_instance(f"ball {i}", ball, path_scenes.matrix(place, 0.28), of_ball)
    return scene


@pytest.mark.parametrize("bump_shadow, clearing", [("CUBIC", "ALL"), ("FACETS", "MIRRORS")])
def test_lobes_seen_in_lanes_give_the_bits_of_single_paths(core, any_target, bump_shadow, clearing):
    scene = scene_of_lobes(core, bump_shadow, clearing)
    settings = {"size": 32, "samples": 4, "passes": path_scenes.ALL_PASSES, "filter_glossy": 0.5}
    alone = path_scenes.render(core, scene, stream_paths=0, **settings)
    assert np.ptp(alone.pass_pixels("glossy_indirect")) > 0
    for target in core.trace.simd_targets():
        assert core.trace.use_simd_target(target)
        together = path_scenes.render(core, scene, stream_paths=1024, **settings)
        for name in path_scenes.ALL_PASSES:
            found, expected = together.pass_pixels(name), alone.pass_pixels(name)
            np.testing.assert_array_equal(found, expected, err_msg=f"{name} by {target}")


def scene_under_noise(core, table):
    """A plane in a world of noise that writes to a slot; `table`: cells around by which it is sampled."""
    scene = core.SceneDescription()
    grey = path_scenes.material(core, scene, ("diffuse", 1.0, 0.6), ("glossy", 1.0, 0.3, 0.2, "GGX"))
    scene.add_instance("plane", scenes.quad(scene, "plane", 1.0), path_scenes.matrix((0, 0, 0.5)), grey)
    scenes.look_down(scene, half=0.4)
    program = core.Program("noise")
    one, zero = program.constant(1, 1, 1, 1), program.constant(0, 0, 0, 0)
    three = program.constant(3, 3, 3, 3)
    noise = program.operation("noise", [program.operation("generated"), zero, three, one, zero, zero], ints=[3])
    program.operation("background", [one, noise, one])
    program.operation("aov", [noise], [0])
    scene.set_world(program, table)
    return scene


@pytest.mark.parametrize("film_transparent", [False, True])
@pytest.mark.parametrize("table", [0, 32])
def test_streams_see_a_world_that_varies_as_single_paths_see_it(core, table, film_transparent):
    scene = scene_under_noise(core, table)
    passes = [*path_scenes.ALL_PASSES, "slot0", "denoising_albedo"]
    pictures = []
    for paths in (0, 1, 100, 4096):
        settings = {"film_transparent": film_transparent, "stream_paths": paths}
        session = path_scenes.render(core, scene, size=12, samples=7, passes=passes, **settings)
        pictures.append({name: session.pass_pixels(name) for name in passes})
    assert np.ptp(pictures[0]["slot0"][..., 0]) > 0 and np.ptp(pictures[0]["environment"]) > 0
    for other in pictures[1:]:
        for name in passes:
            np.testing.assert_array_equal(other[name], pictures[0][name], err_msg=name)
