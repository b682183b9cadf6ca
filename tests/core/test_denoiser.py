"""The door to Open Image Denoise: versions 1 and 2 of its interface, what it is given, and libraries that are no good."""

import time

import numpy as np
import pytest
from core.fake_denoiser import library
from path_scenes import lit_plane
from scenes import background, matrix

COLOR = np.arange(24, dtype=np.float32).reshape(2, 4, 3)
GUIDE = np.full((2, 4, 3), 0.25, np.float32)
MEAN, ALBEDO, NORMAL, CLEAN, HDR = 11.5, 1, 2, 4, 8


@pytest.mark.parametrize("version, text", [(1, "1.4.3"), (2, "2.3.3")])
def test_both_versions_are_told_the_picture_and_its_guides(core, version, text):
    denoiser = core.Denoiser([library(version)])
    assert denoiser.version == text
    assert np.all(denoiser.denoised(COLOR) == MEAN + HDR)
    albedo = denoiser.denoised(COLOR, GUIDE, prefilter="NONE")
    assert np.all(albedo == MEAN + HDR + ALBEDO + CLEAN + 25)
    both = denoiser.denoised(COLOR, albedo=GUIDE, normal=GUIDE, prefilter="FAST")
    assert np.all(both == MEAN + HDR + ALBEDO + NORMAL + 25)
    accurate = denoiser.denoised(COLOR, albedo=GUIDE, normal=GUIDE)
    assert np.all(accurate == MEAN + HDR + ALBEDO + NORMAL + CLEAN + 50)  # the guides were denoised first
    assert COLOR[0, 0, 1] == 1 and np.all(GUIDE == 0.25)


def test_a_library_that_is_not_there_is_named_with_what_to_do(core, tmp_path):
    nothing = tmp_path / "libOpenImageDenoise.so.2"
    nothing.write_text("no library")
    try:
        core.Denoiser([str(nothing)])
    except core.InputError as error:
        assert str(nothing) in str(error) and "oidn" in str(error) and "libOpenImageDenoise.so.2" in str(error)
    else:
        pytest.skip("this process or system has Open Image Denoise")


def test_a_library_without_a_device_for_processors_is_named(core):
    with pytest.raises(core.InputError, match="unsupported hardware"):
        core.Denoiser([library(2, no_device=1)])


def test_a_library_of_another_interface_is_named_with_what_it_lacks(core):
    with pytest.raises(core.InputError, match="oidnReleaseFilter"):
        core.Denoiser([library(2, release="oidnReleaseFilter3")])


def test_what_fails_within_the_library_says_why_and_the_next_picture_is_tried_again(core):
    denoiser = core.Denoiser([library(1, fails=1)])
    for _ in range(2):
        with pytest.raises(core.InputError, match="1.4.3: 'out of memory'|1.4.3: out of memory"):
            denoiser.denoised(COLOR)


def test_pictures_that_do_not_fit_together_are_rejected(core):
    denoiser = core.Denoiser([library()])
    for arguments in (dict(color=COLOR[..., :2]), dict(color=COLOR, albedo=GUIDE[:1]), dict(color=COLOR[:0])):
        with pytest.raises(core.InputError, match="denoiser"):
            denoiser.denoised(**arguments)
    with pytest.raises(core.InputError, match="prefilter"):
        denoiser.denoised(COLOR, prefilter="BEST")


class Doubling:
    """Stands for what denoises a view."""

    guides = ("denoising_albedo",)

    def __init__(self, error=None):
        self.error, self.calls = error, 0

    def applied(self, core, pixels):
        self.calls += 1
        if self.error:
            raise self.error
        assert pixels("denoising_albedo").shape[2] == 3
        return pixels("combined") * 2


def view_picture(core, denoising, samples=9):
    """What a view shows in the end."""
    from rayleaf.viewport.worker import Request, Worker

    scene = lit_plane(core)
    scene.set_world(background(core), 0)
    settings = dict(width=16, height=12, samples=1, passes=["combined", "denoising_albedo"])
    settings |= dict(crop_x=0, crop_y=0, crop_width=16, crop_height=12)
    camera = dict(kind="PERSPECTIVE", matrix=matrix((0, 0, 5)), window_min=(-0.1, -0.1), window_max=(0.1, 0.1))
    camera |= dict(clip_start=0.1, clip_end=100.0)
    worker = Worker(core, lambda: None)
    try:
        worker.show(Request(scene, settings, camera, samples, denoising), False)
        while not worker.is_idle():
            time.sleep(0.01)
        return worker.picture()
    finally:
        worker.close()


def test_a_view_shows_denoised_pictures_and_denoises_seldom(core):
    plain, doubling = view_picture(core, None), Doubling()
    picture = view_picture(core, doubling)
    assert picture.samples == 9 and picture.problem == ""
    np.testing.assert_array_equal(picture.pixels, plain.pixels * 2)
    assert 1 <= doubling.calls <= 5


def test_a_view_that_cannot_denoise_shows_its_noise_and_says_why(core):
    plain = view_picture(core, None)
    picture = view_picture(core, Doubling(core.InputError("no library")))
    np.testing.assert_array_equal(picture.pixels, plain.pixels)
    assert "no library" in picture.problem
