"""Samples where the noise is, until the picture is calm enough, and a time limit that ends a render."""

import time
from typing import Any

import numpy as np
import pytest
from core import scenes

SIZE = {"width": 64, "height": 48}


def half_lit(core: Any) -> Any:
    """On the left a floor under a large soft light, on the right the even world."""
    scene = core.SceneDescription()
    floor = scenes.quad(scene, "floor")
    materials = scene.add_material_list([scene.add_material("floor", scenes.diffuse(core))])
    scene.add_instance("floor", floor, scenes.matrix((-1, 0, 0)), materials)
    block = scenes.quad(scene, "block", size=0.3, height=0.5)
    scene.add_instance("block", block, scenes.matrix((-0.8, 0, 0)), materials)
    scene.add_lamp("lamp", "RECTANGLE", scenes.matrix((-0.5, 0, 2)), (20, 20, 20), size_x=2.0, size_y=2.0)
    scene.set_world(scenes.background(core, color=(0.2, 0.2, 0.2)))
    scene.set_camera("ORTHOGRAPHIC", scenes.matrix((0, 0, 5)), (-1, -0.75), (1, 0.75), 0.1, 100)
    return scene


def rendered(core: Any, scene: Any = None, **settings: Any) -> Any:
    """A finished session."""
    passes = settings.pop("passes", ["combined", "sample_count"])
    made = core.Session(scene or half_lit(core), core.Settings(**{**SIZE, "passes": passes, **settings}))
    assert made.render()
    return made


def picture(session: Any, name: str = "combined") -> Any:
    """A pass, colours without alpha."""
    return session.pass_pixels(name)[..., :3].astype(np.float64)


def test_calm_blocks_take_fewer_samples_than_noisy_ones(core):
    counts = rendered(core, samples=512, noise_threshold=0.02, least_samples=16).pass_pixels("sample_count")
    assert counts.min() == 16 and counts[:, 40:].max() == 16
    assert counts[:, :24].mean() > 48
    blocks = counts.reshape(24, 2, 32, 2).swapaxes(1, 2).reshape(-1, 4)
    assert (blocks == blocks[:, :1]).all(), "the pixels of a block take as many as each other"


@pytest.mark.slow
def test_the_noise_that_is_asked_for_is_reached(core):
    truth = picture(rendered(core, samples=4096, seed=5))
    errors = []
    for threshold in (0.02, 0.005):
        session = rendered(core, samples=4096, noise_threshold=threshold, least_samples=8)
        difference = np.abs(picture(session) - truth).sum(-1)
        errors.append(np.sqrt(np.mean((difference / np.sqrt(truth.sum(-1))) ** 2)))
        assert session.statistics()["rays"]["paths"] < 0.5 * 64 * 48 * 4096
        # Evenly spread samples are off by less than those that the estimate takes them for.
        assert 0.25 * threshold < errors[-1] < 1.1 * threshold
    assert errors[1] < 0.5 * errors[0]


@pytest.mark.slow
def test_an_empty_background_does_not_count(core):
    whole, part = (
        rendered(core, samples=1024, noise_threshold=0.01, least_samples=8, **crop).pass_pixels("sample_count")
        for crop in ({}, {"crop_width": 32, "crop_height": 48})
    )
    assert whole[:, :32].mean() == pytest.approx(part.mean(), rel=0.2)


@pytest.mark.slow
def test_samples_go_where_they_lower_the_error_most(core):
    truth = picture(rendered(core, samples=1024, seed=5))
    session = rendered(core, samples=1024, noise_threshold=0.02, least_samples=8)
    alike = rendered(core, samples=round(float(session.pass_pixels("sample_count").mean())))
    errors = [np.sqrt(np.mean((picture(each) - truth) ** 2)) for each in (session, alike)]
    assert errors[0] < 0.8 * errors[1]


def test_a_view_goes_on_where_it_is_noisy(core):
    settings = core.Settings(**SIZE, passes=["combined"], samples=1, noise_threshold=0.01, least_samples=8)
    view = core.Session(half_lit(core), settings)
    paths = []
    for _ in range(5):
        assert view.render_more(32)
        paths.append(view.statistics()["rays"]["paths"])
    assert paths[0] == 64 * 48 * 32 > paths[1] > 0
    assert paths[-1] < paths[0] and np.isfinite(view.pass_pixels("combined")).all()


@pytest.mark.parametrize("changed", [{"threads": 3}, {"tile_size": 7}, {"stream_paths": 33}, {"stream_paths": 0}])
def test_neither_threads_nor_tiles_show(core, changed):
    usual = {"samples": 64, "noise_threshold": 0.03, "threads": 1, "passes": ["combined", "diffuse_direct", "depth"]}
    one, other = rendered(core, **usual), rendered(core, **{**usual, **changed})
    for name in usual["passes"]:
        assert (one.pass_pixels(name) == other.pass_pixels(name)).all()


def test_rounds_add_up_to_the_picture_of_all_samples(core):
    passes = ["combined", "diffuse_direct", "diffuse_color", "depth", "sample_count"]
    at_once = rendered(core, samples=60, passes=passes)
    in_rounds = rendered(core, samples=60, passes=passes, noise_threshold=1e-9, keep_sums=True)
    for name in passes:
        assert picture(in_rounds, name) == pytest.approx(picture(at_once, name), rel=1e-5, abs=1e-6)
    assert (in_rounds.pass_pixels("sample_count") == 60).all()
    assert np.isfinite(in_rounds.pass_pixels("combined")).all()
    sums = core.FilmSums(64, 48, passes)
    sums.add(0, 0, 60, in_rounds.sums())
    assert (sums.pass_pixels("combined") == at_once.pass_pixels("combined")).all(), "exact sums have no rounds"


def test_off_it_takes_no_memory(core):
    off = rendered(core, samples=2, passes=["combined"]).statistics()
    on = rendered(core, samples=2, passes=["combined"], noise_threshold=0.5).statistics()
    assert off["memory"]["film"] == 64 * 48 * 4 * 4 < on["memory"]["film"]


def test_a_black_picture_takes_the_least_samples(core):
    scene = core.SceneDescription()
    scene.set_camera("ORTHOGRAPHIC", scenes.matrix((0, 0, 5)), (-1, -0.75), (1, 0.75), 0.1, 100)
    counts = rendered(core, scene, samples=1000, noise_threshold=0.01).pass_pixels("sample_count")
    assert (counts == 64).all()


def test_a_picture_smaller_than_a_block_and_one_sample_are_rendered(core):
    for size, samples in ((1, 1), (3, 5), (9, 1)):
        made = rendered(core, width=size, height=size, samples=samples, noise_threshold=0.01)
        assert (made.pass_pixels("sample_count") == samples).all()


def test_a_time_limit_ends_the_render_and_every_pixel_has_as_many_samples(core):
    began = time.perf_counter()
    session = rendered(core, samples=1 << 20, time_limit=0.5)
    assert time.perf_counter() - began < 5, "far from what all samples would take"
    counts = session.pass_pixels("sample_count")
    assert counts.min() == counts.max() >= 1
    again = rendered(core, samples=int(counts.max()))
    assert picture(session) == pytest.approx(picture(again), rel=1e-4, abs=1e-5)


def test_a_time_limit_shorter_than_one_sample_gives_one(core):
    session = rendered(core, samples=64, time_limit=1e-9)
    assert (session.pass_pixels("sample_count") == 1).all()
    assert (picture(session) == picture(rendered(core, samples=1))).all()


def test_noise_and_time_may_both_end_it(core):
    session = rendered(core, samples=1 << 20, time_limit=60, noise_threshold=0.1)
    counts = session.pass_pixels("sample_count")
    assert 25 < counts.min() and counts.max() < 1 << 20


@pytest.mark.parametrize("setting", ["noise_threshold", "least_samples", "time_limit"])
def test_what_is_out_of_range_is_named(core, setting):
    with pytest.raises(ValueError, match=setting.replace("_", " ")):
        rendered(core, samples=1, **{setting: -1})
