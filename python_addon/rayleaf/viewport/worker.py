"""The thread that renders what a view shows, better and better, until it shows something else. Knows nothing of Blender."""

import threading
import time
from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

# Textures hold half floats.
_LARGEST_HALF = 65504.0
# Pixels along a side of the blocks that are shown first; blocks of half the size follow. Where they take longer than
# the first, or less than the second of these seconds, the next view begins with coarser ones, or finer.
_BLOCKS, _COARSEST_BLOCKS = 8, 32
_SLOW_BLOCKS, _FAST_BLOCKS = 0.07, 0.015
# Of a draft, which is shown until a view's first scene is built.
_DRAFT_BLOCKS = (16, 8)
# Samples are taken in rounds of at most about so many seconds, so that the picture is seen to get better.
_ROUND_SECONDS = 0.25
# After so long without another camera, facets are made for the camera that there is.
_REST_SECONDS = 0.4
# A picture that takes longer to appear than this is given up for a newer view.
_FIRST_SECONDS = 0.5


@dataclass(frozen=True)
class Request:
    """What a view shows."""

    scene: Any  # a core SceneDescription
    settings: dict[str, Any]  # of core.Settings
    camera: dict[str, Any]  # of SceneDescription.set_camera
    samples: int
    denoising: Any = None  # a Denoising, or None

    def is_same_scene(self, other: "Request | None") -> bool:
        """Whether only the view differs."""
        return other is not None and self.scene is other.scene


def same_camera(one: dict[str, Any], other: dict[str, Any]) -> bool:
    """Whether two cameras see the same."""
    return one.keys() == other.keys() and all(np.array_equal(one[name], other[name]) for name in other)


@dataclass(frozen=True)
class Picture:
    """What has been rendered so far."""

    pixels: Any  # (height, width, channels), linear light, rows bottom to top
    samples: int  # 0: blocks
    settings: dict[str, Any]  # with which it was rendered
    texels: Any  # as a texture takes them, made here: Blender does not wait for that
    interpolated: float | None = None  # share of the rays that asked a ray cache; None: none did
    problem: str = ""  # what is wrong with it

    def place_in(self, width: int, height: int) -> tuple[tuple[float, float], float, float]:
        """Lower left corner, width and height in a region of that size."""
        across, up = width / self.settings["width"], height / self.settings["height"]
        x, y, wide, high = (self.settings[f"crop_{name}"] for name in ("x", "y", "width", "height"))
        return (x * across, y * up), wide * across, high * up


def texels(pixels: Any) -> Any:
    """What a texture is made of: red, green, blue and alpha in a row, within the range of half floats. Of (height, width,
    channels): one channel as grey, three without transparency."""
    channels = pixels.shape[2]
    if channels != 4:
        colors = np.repeat(pixels, 3, axis=2) if channels == 1 else pixels
        pixels = np.concatenate([colors, np.ones_like(colors[..., :1])], axis=2)
    found = np.array(pixels, np.float32).ravel()
    np.minimum(found, np.float32(_LARGEST_HALF), out=found)
    np.maximum(found, np.float32(-_LARGEST_HALF), out=found)
    return found


def interpolated_share(statistics: dict[str, Any]) -> float | None:
    """Of the rays that asked a cache, those that it answered without tracing."""
    used = [cache for cache in statistics["ray_caches"] if cache["used"]]
    queries = sum(cache["queries"] for cache in used)
    return sum(cache["interpolated"] for cache in used) / queries if queries else None


def blocks_after(size: int, seconds: float) -> int:
    """With which blocks a view should begin, where the last one began with these."""
    if seconds > _SLOW_BLOCKS:
        return min(2 * size, _COARSEST_BLOCKS)
    return max(size // 2, _BLOCKS) if seconds < _FAST_BLOCKS else size


class Worker:
    """Renders the newest request. All methods are for one thread; the work is done in another."""

    def __init__(self, core: ModuleType, redraw: Callable[[], None]) -> None:
        """`redraw` is called from the worker's thread when there is a new picture, or an error."""
        self._core, self._redraw = core, redraw
        self._ray_caches = core.RayCacheStore()
        self._condition = threading.Condition()
        self._wanted: Request | None = None  # not begun
        self._session: Any | None = None
        self._request_settings: dict[str, Any] = {}
        self._began = 0.0
        self._picture: Picture | None = None
        self._is_new = True  # nothing of the request under way has been shown
        self._gave_up = False  # the request before, of which nothing was shown
        self._error: Exception | None = None
        self._closing = self._paused = self._working = False
        self._first_blocks = _BLOCKS
        self._is_built = False  # a scene as it should be
        self._dicing: tuple[Any, dict[str, Any]] | None = None  # scene and camera that facets are made for
        self._thread = threading.Thread(target=self._serve, name="rayleaf viewport", daemon=True)
        self._thread.start()

    def show(self, request: Request, is_edit: bool) -> None:
        """Render this from now on. `is_edit`: what is being rendered is no longer true, and is given up at once."""
        with self._condition:
            self._wanted = request
            # One picture in a row: the next one would be given up as well.
            late = not self._gave_up and time.monotonic() - self._began > _FIRST_SECONDS
            if self._session is not None and (is_edit or late or not self._is_new):
                self._gave_up = late and self._is_new
                self._session.cancel()
            self._condition.notify()

    def picture(self) -> Picture | None:
        """The newest one. Raises what the render raised."""
        with self._condition:
            if self._error is not None:
                raise self._error
            return self._picture

    def is_idle(self) -> bool:
        """Whether all that was asked for is done."""
        with self._condition:
            return self._wanted is None and not self._working

    def pause(self) -> None:
        """Stop; `resume` goes on. Returns at once."""
        with self._condition:
            self._paused = True
            if self._session is not None:
                self._session.cancel()

    def resume(self, request: Request | None) -> None:
        """Render again, from the start."""
        with self._condition:
            self._paused = False
            self._wanted = self._wanted or request
            self._condition.notify()

    def close(self) -> None:
        """Stop and wait until it has stopped. More than once is fine."""
        with self._condition:
            self._closing = True
            if self._session is not None:
                self._session.cancel()
            self._condition.notify()
        if threading.current_thread() is not self._thread:
            self._thread.join()

    def _serve(self) -> None:
        while True:
            with self._condition:
                while not self._closing and (self._wanted is None or self._paused):
                    self._condition.wait()
                if self._closing:
                    return
                request, self._wanted = self._wanted, None
                self._error, self._working = None, True
            try:
                self._render(request)
            except Exception as error:  # told by whoever asks for the picture
                with self._condition:
                    self._error = error
                self._redraw()
            with self._condition:
                self._working = False

    def _render(self, request: Any) -> None:
        if self._dicing is None or self._dicing[0] is not request.scene or not self._is_built:
            self._dicing = request.scene, request.camera
        moved = not same_camera(self._dicing[1], request.camera)
        if not self._is_built and not self._show_draft(request):
            return
        session = self._begin(request)
        if session is None:
            return
        self._is_built = True
        if not self._show_blocks(session):
            return
        if moved:  # the picture is shown coarsely until the view rests
            with self._condition:
                if self._condition.wait_for(lambda: self._is_over(), _REST_SECONDS):
                    return
            self._dicing = request.scene, request.camera
            del session
            session = self._begin(request)
            if session is None:
                return
        self._refine(session, request)

    def _is_over(self) -> bool:
        return self._closing or self._paused or self._wanted is not None

    def _begin(self, request: Request, **changes: Any) -> Any | None:
        """A session whose scene is built; None if there is something newer to do. `changes`: other settings."""
        assert self._dicing is not None
        with self._condition:
            self._session = None  # what it holds goes to the next
        self._request_settings = request.settings
        request.scene.set_camera(**request.camera)
        request.scene.set_camera(**self._dicing[1], dicing=True)
        self._ray_caches.next_frame()
        settings = self._core.Settings(**(request.settings | changes))
        session = self._core.Session(request.scene, settings, self._ray_caches)
        with self._condition:
            if self._is_over():
                return None
            self._session, self._began = session, time.monotonic()
            self._is_new = self._is_built or "draft" in changes
        return session if session.build() else None

    def _show_draft(self, request: Request) -> bool:
        """Something soon; False if there is something newer to do."""
        no_caches = dict(ray_interpolation=self._core.RayInterpolation(), irradiance_cache=False)
        session = self._begin(request, draft=True, **no_caches)
        if session is None:
            return False
        for size in _DRAFT_BLOCKS:
            if not session.render_blocks(size):
                return False
            self._publish(session, 0)
            with self._condition:
                if self._is_over():
                    return False
        return True

    def _show_blocks(self, session: Any) -> bool:
        size = first = self._first_blocks
        while size > 1:
            began = time.monotonic()
            if not session.render_blocks(size):
                return False
            if size == first:
                self._first_blocks = blocks_after(first, time.monotonic() - began)
            self._publish(session, 0)
            with self._condition:
                if self._is_over():
                    return False
            size //= 2
        return True

    def _refine(self, session: Any, request: Request) -> None:
        taken, count, samples = 0, 1, request.samples
        shown = 0  # samples of the last picture
        while taken < samples:
            began = time.monotonic()
            count = min(count, samples - taken)
            if not session.render_more(count):
                return
            taken += count
            # Denoising takes as long as several samples: not for few more of them.
            if request.denoising is None or taken >= 2 * shown or taken == samples:
                self._publish(session, taken, request.denoising)
                shown = taken
            if time.monotonic() - began < 0.5 * _ROUND_SECONDS:
                count *= 2
            with self._condition:
                if self._is_over():
                    return

    def _publish(self, session: Any, samples: int, denoising: Any = None) -> None:
        settings, problem = self._request_settings, ""
        pixels = session.pass_pixels(settings["passes"][0])
        if denoising is not None:
            try:
                pixels = denoising.applied(self._core, session.pass_pixels)
            except self._core.InputError as error:
                problem = str(error)
        share = interpolated_share(session.statistics()) if samples else None
        picture = Picture(pixels, samples, settings, texels(pixels), share, problem)
        with self._condition:
            self._picture, self._is_new = picture, False
            self._gave_up = False
        self._redraw()
