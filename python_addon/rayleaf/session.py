"""One core render in a thread of its own. Knows nothing of Blender."""

import threading
from types import ModuleType
from typing import Any


class RenderThread:
    """Runs a core Session to its end, and answers questions about it meanwhile.

    The core gives up Python's lock while it renders, so the thread that polls is never held up.
    """

    def __init__(self, core: ModuleType, scene: Any, settings: Any, ray_caches: Any = None) -> None:
        """`ray_caches`: a RayCacheStore that outlives the render, or None."""
        self._session = core.Session(scene, settings, ray_caches)
        self._error: BaseException | None = None
        self._completed = False
        self._thread = threading.Thread(target=self._run, name="rayleaf", daemon=True)

    def _run(self) -> None:
        try:
            self._completed = bool(self._session.render())
        except BaseException as error:  # handed to the thread that asks for the result
            self._error = error

    def start(self) -> None:
        """Begin. Once only."""
        self._thread.start()

    def wait(self, seconds: float) -> bool:
        """Wait for the end, at most so long; True when the render has ended."""
        self._thread.join(seconds)
        return not self._thread.is_alive()

    def cancel(self) -> None:
        """Ask the core to stop; `wait` tells when it has."""
        self._session.cancel()

    def close(self) -> None:
        """Stop the core and wait until it has stopped. Safe at any time, and more than once."""
        if self._thread.is_alive():
            self._session.cancel()
            self._thread.join()

    def raise_error(self) -> None:
        """Raise here what the render raised, if it did."""
        if self._error is not None:
            raise self._error

    @property
    def completed(self) -> bool:
        """True after a render that was neither cancelled nor failed."""
        return self._completed

    def progress(self) -> tuple[str, float]:
        """What is being done, and the share that is done."""
        stage, share = self._session.progress()
        return str(stage), float(share)

    def pixels(self, name: str) -> Any:
        """(height, width, channels) of a pass as far as it is rendered, rows bottom to top."""
        return self._session.pass_pixels(name)

    def sums(self) -> dict[str, Any]:
        """The exact sums of all passes, where the settings keep them."""
        return dict(self._session.sums())

    def statistics(self) -> dict[str, Any]:
        """The core's counters."""
        return dict(self._session.statistics())
