"""What is to be rendered, cut into tasks; kept as a file that submitter and nodes share. Runs in Debian's Python, without Blender."""

import glob
import hashlib
import json
import re
import zipfile
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

MARKERS = "done"
_ADDON = Path(__file__).resolve().parents[1] / "rayleaf"


@dataclass(frozen=True)
class Task:
    """A frame, a part of one, or the merging of a frame's parts."""

    frame: int
    tile: str = ""  # as `rayleaf render` takes it, like 2/4
    samples: str = ""
    merges: bool = False

    @property
    def name(self) -> str:
        """Unique among a file's tasks, whatever else it is cut into."""
        words = [f"{self.frame:04d}", *([f"tile-{self.tile}"] if self.tile else [])]
        words += [f"samples-{self.samples}"] if self.samples else []
        return "_".join([*words, *(["merged"] if self.merges else [])]).replace("/", "-of-")

    @property
    def part(self) -> str:
        """What `rayleaf render` calls the file of a part (rayleaf/parts.py)."""
        return f"tile-{self.tile or '1/1'}_samples-{self.samples or '1/1'}.npz".replace("/", "-of-")

    def options(self) -> list[str]:
        """Of `rayleaf render`."""
        cut = (["--tile", self.tile] if self.tile else []) + (["--sample-range", self.samples] if self.samples else [])
        return ["-f", str(self.frame), *cut, *(["--merge"] if self.merges else [])]


@dataclass(frozen=True)
class Plan:
    """All frames of one submission."""

    file: str  # the .blend
    content: str  # a hash of it
    version: str  # of Rayleaf
    output: str  # path of the pictures, without frame number and ending
    frames: list[int]
    tiles: int
    sample_ranges: int

    def parts(self) -> list[Task]:
        """What can be rendered at once, in order of frames."""
        return [Task(frame, *cut) for frame in self.frames for cut in self._cuts()]

    def _cuts(self) -> Iterator[tuple[str, str]]:
        for tile in range(1, self.tiles + 1):
            for samples in range(1, self.sample_ranges + 1):
                yield (
                    f"{tile}/{self.tiles}" if self.tiles > 1 else "",
                    f"{samples}/{self.sample_ranges}" if self.sample_ranges > 1 else "",
                )

    def merges(self) -> list[Task]:
        """What follows when all parts are there."""
        return [Task(frame, merges=True) for frame in self.frames] if self.is_cut else []

    @property
    def is_cut(self) -> bool:
        """True if frames are rendered in parts."""
        return self.tiles * self.sample_ranges > 1

    def picture(self, frame: int) -> Path:
        """A frame's pictures, without ending."""
        return Path(f"{self.output}_{frame:04d}")

    @property
    def folder(self) -> Path:
        """Where plans, markers and logs of this output lie."""
        return Path(f"{self.output}.farm")

    def marker(self, task: Task) -> Path:
        """A file that is there once pictures have been finished, for this content of the file."""
        return self.folder / MARKERS / self.content[:16] / task.name

    def makes_pictures(self, task: Task) -> bool:
        """True if a task renders a frame whole, or merges it."""
        return task.merges or not self.is_cut

    def is_finished(self, task: Task) -> bool:
        """Parts are not needed any more once their frame is merged."""
        last = task if self.makes_pictures(task) else Task(task.frame, merges=True)
        if self.marker(last).exists() and self._has_pictures(task.frame):
            return True
        return not self.makes_pictures(task) and self.rendered_by(task) == self.version

    def rendered_by(self, part: Task) -> str:
        """The version of Rayleaf that rendered a part that is there, of this content of the file; empty: none is."""
        source = header_of(Path(f"{self.picture(part.frame)}.parts") / part.part).get("source")
        if not isinstance(source, dict) or source.get("blend") != self.content or source.get("frame") != part.frame:
            return ""
        return str(source.get("version", ""))

    def _has_pictures(self, frame: int) -> bool:
        """The PNG, of stereoscopic frames one a view, and the EXR."""
        picture = Path(self.picture(frame))
        pngs = [picture.with_name(f"{picture.name}.png"), *picture.parent.glob(f"{glob.escape(picture.name)}_*.png")]
        return pngs[-1].is_file() and picture.with_name(f"{picture.name}.exr").is_file()

    def write(self, path: Path) -> None:
        """For `read`."""
        path.write_text(json.dumps(asdict(self), indent=2) + "\n")


def read(path: Path) -> Plan:
    """What was submitted."""
    return Plan(**json.loads(path.read_text()))


def header_of(path: Path) -> dict[str, Any]:
    """What a part's file says of itself, as rayleaf/parts.py reads it, without NumPy; empty if it is none."""
    try:
        with zipfile.ZipFile(path) as file:
            array = file.read("header.npy")  # ten bytes, the last two the length of a text; that text; the values
        return dict(json.loads(array[10 + int.from_bytes(array[8:10], "little") :]))
    except Exception:  # whatever a foreign file makes zip and JSON raise
        return {}


def version_of_checkout() -> str:
    """Of the Rayleaf that renders here."""
    found = re.search(r'^__version__ = "(.+)"$', (_ADDON / "__init__.py").read_text(), re.MULTILINE)
    assert found
    return found[1]


def content_of(file: Path) -> str:
    """A hash that tells whether the .blend has changed."""
    return hashlib.sha256(file.read_bytes()).hexdigest()
