"""The scenes of whole frames beside Cycles: those of blend_scenes, and larger ones that scripts make on demand."""

import subprocess
from collections.abc import Sequence
from pathlib import Path

from .machine import blender_version
from .parts import mark


def built(blender: str, script: Path, folder: Path, words: Sequence[str] = ()) -> Path:
    """The scene that make_NAME.py writes. Raises RuntimeError with Blender's last lines if there is none."""
    command = [blender, "--background", "--factory-startup", "--python-exit-code", "1", "--addons", "rayleaf"]
    command += ["--python", str(script), "--", str(folder), *words]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    file = folder / f"{script.stem.removeprefix('make_')}.blend"
    if done.returncode != 0 or not file.exists():
        last = "\n".join((done.stdout + done.stderr).splitlines()[-15:])
        raise RuntimeError(f"{script.name}: Blender ended with {done.returncode}:\n{last}")
    return file


def kept(blender: str, script: Path, helpers: Path, folder: Path) -> Path:
    """The same, made once for what the script and its helpers (scene_*.py in `helpers`) say."""
    sources = [script, *sorted(helpers.glob("scene_*.py"))]
    place = folder / mark(blender_version(blender), *sources)[:16]
    file = place / f"{script.stem.removeprefix('make_')}.blend"
    if not file.exists():
        place.mkdir(parents=True, exist_ok=True)
        built(blender, script, place)
    return file


class FrameScenes:
    """All scenes of a project by name. tests/bench/make_NAME.py make those that are too large to be kept as files."""

    def __init__(self, root: Path, blender: str, folder: Path) -> None:
        self._blender, self._folder, self._helpers = blender, folder, root / "blend_scenes"
        self._files = {path.stem: path for path in sorted(self._helpers.glob("*.blend"))}
        scripts = sorted((root / "tests" / "bench").glob("make_*.py"))
        self._scripts = {path.stem.removeprefix("make_"): path for path in scripts}

    def names(self, with_large: bool = True) -> list[str]:
        return [*self._files, *(self._scripts if with_large else ())]

    def source(self, name: str) -> Path:
        """What a scene depends on: its file, or the script that makes it. A name that is none of these is a file's."""
        return self._files.get(name) or self._scripts.get(name) or Path(name).resolve()

    def file(self, name: str) -> Path:
        """A scene's file, made if need be. Raises RuntimeError if that fails."""
        if name in self._scripts:
            return kept(self._blender, self._scripts[name], self._helpers, self._folder)
        return self.source(name)
