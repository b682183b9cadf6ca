"""Denoising by Open Image Denoise: what guides it, and where its library is looked for."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import bpy
import numpy as np

_GUIDES = {
    "RGB": (),
    "RGB_ALBEDO": ("denoising_albedo",),
    "RGB_ALBEDO_NORMAL": ("denoising_albedo", "denoising_normal"),
}
_LIBRARIES = ("libOpenImageDenoise.so.2", "libOpenImageDenoise.so.1")

_made: dict[Any, Any] = {}  # the core's Denoiser by what it is made of


def _library_paths() -> tuple[str, ...]:
    """Blender's own copies where they are files of their own, and one beside this add-on."""
    blender, module = Path(bpy.app.binary_path or bpy.__file__).parent, Path(bpy.__file__).parent
    folders = (blender / "lib", module / "lib", Path(__file__).parent / "lib")
    return tuple(str(folder / name) for folder in folders for name in _LIBRARIES if (folder / name).is_file())


@dataclass(frozen=True)
class Denoising:
    """How pictures are denoised."""

    guides: tuple[str, ...]  # passes that it needs beside Combined
    prefilter: str
    threads: int  # 0: all of the machine's
    paths: tuple[str, ...]

    @classmethod
    def of(cls, scene: Any) -> "Denoising":
        """As a scene sets it."""
        own, render = scene.rayleaf, scene.render
        threads = render.threads if render.threads_mode == "FIXED" else 0
        return cls(_GUIDES[own.denoising_input_passes], own.denoising_prefilter, threads, _library_paths())

    def applied(self, core: ModuleType, pixels: Callable[[str], Any]) -> Any:
        """Combined without its noise; `pixels` gives passes by the core's names. Raises InputError where there is no
        library, or it fails."""
        combined = np.array(pixels("combined"))
        guides = {name.removeprefix("denoising_"): np.ascontiguousarray(pixels(name)) for name in self.guides}
        color = np.ascontiguousarray(combined[..., :3])
        combined[..., :3] = self._denoiser(core).denoised(color, **guides, prefilter=self.prefilter)
        return combined

    def _denoiser(self, core: ModuleType) -> Any:
        key = (core, self.paths, self.threads)
        if key not in _made:
            _made[key] = core.Denoiser(list(self.paths), self.threads)
        return _made[key]
