"""What a view's thread renders first, and what then."""

import threading
import time
from types import SimpleNamespace

import pytest
from path_scenes import lit_plane
from scenes import background, matrix


class WatchedCore:
    """The core, and what its sessions are asked for."""

    def __init__(self, core):
        self._core, self.asked = core, []
        self.builds = threading.Event()  # of what is no draft, may begin
        self.builds.set()

    def __getattr__(self, name):
        return getattr(self._core, name)

    def Settings(self, **settings):  # noqa: N802: as the core's
        return SimpleNamespace(plain=self._core.Settings(**settings), draft=settings.get("draft", False))

    def Session(self, scene, settings, caches):  # noqa: N802: as the core's
        return WatchedSession(self, self._core.Session(scene, settings.plain, caches), settings.draft)


class WatchedSession:
    """A session of it."""

    def __init__(self, core, plain, draft):
        self._core, self._plain, self._draft = core, plain, "draft" if draft else "picture"

    def __getattr__(self, name):
        return getattr(self._plain, name)

    def build(self):
        self._core.asked.append(f"build {self._draft}")
        if self._draft == "picture":
            self._core.builds.wait(20)
        return self._plain.build()

    def render_blocks(self, size):
        self._core.asked.append(f"blocks of {self._draft}")
        return self._plain.render_blocks(size)


def request_of(core, distance=5.0, scene=None):
    from rayleaf.viewport.worker import Request

    if scene is None:
        scene = lit_plane(core)
        scene.set_world(background(core), 0)
    settings = dict(width=16, height=12, samples=1, passes=["combined"])
    settings |= dict(crop_x=0, crop_y=0, crop_width=16, crop_height=12)
    camera = dict(kind="PERSPECTIVE", matrix=matrix((0, 0, distance)), window_min=(-0.1, -0.1), window_max=(0.1, 0.1))
    return Request(scene, settings, camera | dict(clip_start=0.1, clip_end=100.0), 2)


@pytest.fixture
def view(core):
    """A worker, and the core that it asks."""
    from rayleaf.viewport.worker import Worker

    watched = WatchedCore(core)
    worker = Worker(watched, lambda: None)
    yield worker, watched
    watched.builds.set()
    worker.close()


def wait_for(condition):
    end = time.monotonic() + 20
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.005)


def test_a_draft_is_shown_before_the_first_scene_is_built_and_no_more_after_that(core, view):
    worker, watched = view
    watched.builds.clear()
    worker.show(request_of(core), False)
    wait_for(lambda: "build picture" in watched.asked)
    assert worker.picture() is not None and worker.picture().samples == 0
    watched.builds.set()
    wait_for(worker.is_idle)
    assert worker.picture().samples == 2
    assert watched.asked[0] == "build draft" and watched.asked.count("build draft") == 1
    worker.show(request_of(core), True)
    wait_for(worker.is_idle)
    assert watched.asked.count("build draft") == 1 and watched.asked.count("build picture") == 2


def test_while_the_first_scene_is_built_a_view_that_moves_shows_drafts(core, view):
    worker, watched = view
    watched.builds.clear()
    first = request_of(core)
    worker.show(first, False)
    wait_for(lambda: "build picture" in watched.asked)
    before = worker.picture()
    worker.show(request_of(core, 4.0, first.scene), False)  # gives the build up
    watched.builds.set()
    wait_for(worker.is_idle)
    assert watched.asked.count("build draft") == 2
    assert worker.picture() is not before and worker.picture().samples == 2


def test_blocks_that_take_too_long_are_coarser_from_then_on():
    from rayleaf.viewport.worker import blocks_after

    slow = 0.11
    assert blocks_after(8, slow) == 16
    assert blocks_after(16, slow / 4) == 16  # else every other view would be slow
    assert blocks_after(32, slow) == 32 and blocks_after(16, 0.01) == 8 and blocks_after(8, 0.01) == 8
