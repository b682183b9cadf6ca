"""Trees of rays traced many at once give the bits of trees traced alone."""

import numpy as np
import path_scenes
import pytest

FEW = dict(integrator="DISTRIBUTION", glossy_rays=2, light_rays=3, hemisphere_rays=5)
MANY = dict(integrator="DISTRIBUTION", glossy_rays=4, light_rays=20, hemisphere_rays=35)


def passes_of(core, scene, **settings):
    passes = [*path_scenes.ALL_PASSES, "ambient_occlusion"]
    session = path_scenes.render(core, scene, size=8, samples=5, passes=passes, **settings)
    return {name: session.pass_pixels(name) for name in passes}


@pytest.mark.parametrize("rays", [FEW, MANY], ids=["few", "many"])
@pytest.mark.parametrize(
    "settings",
    [
        {"indirect": "COLOR_BLEEDING"},
        {"indirect": "AMBIENT_OCCLUSION", "occlusion_distance": 1.5},
        {"indirect": "NONE"},
        {"threads": 3, "tile_size": 5},
        {"resident_megabytes": 0.0},
        {"irradiance_cache": True},
    ],
)
def test_streams_of_any_size_give_the_bits_of_single_trees(core, rays, settings):
    scene = path_scenes.varied_scene(core)
    alone = passes_of(core, scene, stream_paths=0, **rays, **settings)
    assert np.ptp(alone["combined"]) > 0
    for trees in (1, 17, 512):
        together = passes_of(core, scene, stream_paths=trees, **rays, **settings)
        for name, pixels in alone.items():
            np.testing.assert_array_equal(together[name], pixels, err_msg=f"{name}, {trees} trees")


@pytest.mark.parametrize("seed", range(4))
def test_streams_of_nasty_scenes_give_the_bits_of_single_trees(core, seed):
    scene = path_scenes.nasty_scene(core, np.random.default_rng(seed))
    pictures = [path_scenes.picture(core, scene, size=6, samples=4, stream_paths=trees, **FEW) for trees in (0, 64)]
    np.testing.assert_array_equal(pictures[0], pictures[1])
    assert np.isfinite(pictures[0]).all()


def test_streams_count_the_rays_of_single_trees(core):
    scene = path_scenes.varied_scene(core)
    counts = [path_scenes.render(core, scene, stream_paths=trees, **FEW).statistics()["rays"] for trees in (0, 100)]
    assert counts[0] == counts[1]
    assert counts[0]["hemisphere"] > 0 and counts[0]["shadow"] > 0


def test_what_nobody_asks_of_rays_is_left_out_and_leaves_the_tree_alone(core):
    """An image, though nothing shows it, makes rays carry the distance of their neighbours."""
    pictures = []
    for with_image in (False, True):
        scene = path_scenes.varied_scene(core)
        if with_image:
            scene.add_image_pixels("unseen", np.ones((2, 2, 4), np.float32), "LINEAR")
        for trees in (0, 100):
            pictures.append(passes_of(core, scene, stream_paths=trees, **FEW))
    for other in pictures[1:]:
        for name, pixels in pictures[0].items():
            np.testing.assert_array_equal(other[name], pixels, err_msg=name)
