"""Converged pictures, kept on disk: each is made once for a file, an engine, a size and a number of samples."""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from . import points
from .machine import blender_version
from .measure import Conditions, render
from .parts import mark


class ConvergedPictures:
    """The pictures in a folder. They outlive changes of Rayleaf that should not show; `again` makes them anew."""

    def __init__(self, blender: str, folder: Path, conditions: Conditions, again: bool = False) -> None:
        self._blender, self._folder, self._conditions, self._again = blender, folder, conditions, again
        self._made: set[Path] = set()
        self._version = blender_version(blender)
        folder.mkdir(parents=True, exist_ok=True)

    def picture(self, file: Path, engine: str, count: int) -> Any:
        """(height, width, 4), scene-linear, rows bottom to top. Raises RuntimeError if it cannot be rendered."""
        path = self._path(file, engine, count)
        if not path.exists() or (self._again and path not in self._made):
            self._keep(path, self._rendered(file, engine, count))
            self._made.add(path)
        return np.load(path)

    def _path(self, file: Path, engine: str, count: int) -> Path:
        asked = self._conditions
        name = mark(file, engine, self._version, (asked.width, asked.percentage), asked.orbit, count)[:16]
        return self._folder / f"{file.stem}_{engine.lower()}_{count}_{name}.npy"

    def _rendered(self, file: Path, engine: str, count: int) -> Any:
        with tempfile.TemporaryDirectory(prefix="rayleaf_report_") as name:
            reference = points.reference(engine, count)
            raw = render(self._blender, file, [reference], self._conditions, Path(name))[0]
            if "problem" in raw:
                raise RuntimeError(f"{file.name}: {engine.title()}: {raw['problem']}")
            return np.load(raw["picture"])

    def _keep(self, path: Path, picture: Any) -> None:
        """Whole or not at all: a run may be stopped at any time."""
        unfinished = path.with_suffix(".new")
        with unfinished.open("wb") as file:
            np.save(file, picture)
        unfinished.replace(path)
