"""From Blender's data to the core's plain scene description."""

import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor, wait
from typing import TypeVar

Result = TypeVar("Result")

_LOOK_SECONDS = 0.02  # between two looks at the Esc key


class ExportCancelled(Exception):
    """The user asked to stop while the scene was being exported."""


class ExportError(ValueError):
    """Nothing can be rendered; the message names what is in the way."""


class CancelCheck:
    """Called as often as one likes, it asks now and then whether the user wishes to stop."""

    def __init__(self, should_stop: Callable[[], bool]) -> None:
        self._should_stop, self._next_look = should_stop, 0.0

    def __call__(self) -> None:
        """Raises ExportCancelled after Esc."""
        now = time.perf_counter()
        if now < self._next_look:
            return
        self._next_look = now + _LOOK_SECONDS
        if self._should_stop():
            raise ExportCancelled

    def while_waiting_for(self, work: Callable[[], Result]) -> Result:
        """The result of work that takes long and gives up Python's lock meanwhile. After Esc it is left to end by itself."""
        pool = ThreadPoolExecutor(1, "rayleaf export")
        try:
            future = pool.submit(work)
            while not wait([future], _LOOK_SECONDS).done:
                self()
            return future.result()
        finally:
            pool.shutdown(wait=False)
