"""Parts of a frame that are rendered apart, some of its rows or some of its samples: cuts, files, and their sum.

A file holds exact sums, so that the frame made of the parts has the bits of one rendered at once. It is NumPy's .npz: the
array `header`, JSON in UTF-8, and for each view layer n an array `n.PASS` (row, column, channel, term).
"""

import hashlib
import json
import os
from collections import defaultdict
from dataclasses import asdict, dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import __version__


class PartError(Exception):
    """Parts cannot be written or put together; the text is meant for people who render."""


@dataclass(frozen=True)
class Share:
    """One of several shares of something that is cut evenly."""

    number: int  # from 1
    count: int

    @classmethod
    def parsed(cls, text: str) -> "Share":
        """Of "2/4". Raises ValueError."""
        number, count = map(int, text.split("/"))
        if not 1 <= number <= count:
            raise ValueError
        return cls(number, count)

    def of(self, total: int) -> tuple[int, int]:
        """First, and how many, of so many things."""
        first, end = ((self.number - 1 + step) * total // self.count for step in (0, 1))
        return first, end - first


@dataclass(frozen=True)
class Cut:
    """Which part of a frame: some of its rows, some of its samples."""

    tile: Share = Share(1, 1)
    samples: Share = Share(1, 1)

    @property
    def name(self) -> str:
        """Of the part's file, without ending."""
        tile, samples = self.tile, self.samples
        return f"tile-{tile.number}-of-{tile.count}_samples-{samples.number}-of-{samples.count}"


@dataclass(frozen=True)
class Source:
    """What a part is rendered of. Only parts of the same go together."""

    blend: str  # a hash of the file
    frame: int
    version: str = __version__


@dataclass(frozen=True)
class LayerShape:
    """What all parts of a view layer agree in."""

    scene: str
    view_layer: str
    picture: tuple[int, int]  # pixels
    crop: tuple[int, int, int, int]  # x, y, width, height in the picture
    samples: int
    passes: tuple[str, ...]  # identifiers of those that were asked for
    view: str = ""  # of a stereoscopic picture; empty: it is none


@dataclass
class LayerPart:
    """A part of a view layer."""

    shape: LayerShape
    place: tuple[int, int]  # in the crop, pixels from the lower left corner
    samples: int
    sums: dict[str, NDArray[np.float64]]
    fields: dict[str, str]  # of files' headers: what mattes need beside their pixels


def source_of(blend: Path, frame: int) -> Source:
    """Of a saved file."""
    digest = hashlib.sha256()
    with blend.open("rb") as file:
        while block := file.read(1 << 20):
            digest.update(block)
    return Source(digest.hexdigest(), frame)


def path_in(folder: Path, cut: Cut) -> Path:
    """Where a part lies among those of its frame."""
    return folder / f"{cut.name}.npz"


def write(path: Path, source: Source, cut: Cut, layers: list[LayerPart]) -> None:
    """Beside first, then renamed: what has the name is whole."""
    header = {
        "source": asdict(source),
        "cut": asdict(cut),
        "layers": [
            {"shape": asdict(each.shape), "place": each.place, "samples": each.samples, "fields": each.fields}
            for each in layers
        ],
    }
    arrays = {f"{i}.{name}": sums for i, each in enumerate(layers) for name, sums in each.sums.items()}
    text = np.frombuffer(json.dumps(header).encode(), np.uint8)
    path.parent.mkdir(parents=True, exist_ok=True)
    beside = path.with_name(f".{path.stem}.{os.uname().nodename}.{os.getpid()}.npz")
    try:
        np.savez_compressed(beside, header=text, **arrays)
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)


def header_of(path: Path) -> dict[str, Any]:
    """What a part's file says of itself; empty if it is none."""
    try:
        with np.load(path) as file:
            return dict(json.loads(bytes(file["header"])))
    except Exception:  # whatever a foreign file makes NumPy, zip and JSON raise
        return {}


def is_finished(path: Path, source: Source) -> bool:
    """True if this part has been rendered of this file."""
    return bool(header_of(path).get("source") == asdict(source))


class Parts:
    """All parts of one frame."""

    def __init__(self, folder: Path, source: Source) -> None:
        """Those in a folder that are of this source and make up a frame. Raises PartError."""
        by_cut: dict[tuple[int, int], set[str]] = defaultdict(set)
        foreign: dict[str, str] = {}  # of other versions, by name
        for path in sorted(folder.glob("*.npz")):
            header = header_of(path)
            of = header.get("source")
            if of == asdict(source):
                by_cut[header["cut"]["tile"]["count"], header["cut"]["samples"]["count"]].add(path.name)
            elif isinstance(of, dict) and of | {"version": source.version} == asdict(source):
                foreign[path.name] = str(of.get("version"))
        told = f"; this is Rayleaf {source.version}, others rendered " if foreign else ""
        told += ", ".join(f"{name} ({version})" for name, version in foreign.items())
        if not by_cut:
            raise PartError(f"there is no part of frame {source.frame} of this file in {folder}{told}")
        missing = {count: self._names(*count) - found for count, found in by_cut.items()}
        best = min(missing, key=lambda count: len(missing[count]))
        if missing[best]:
            raise PartError(f"frame {source.frame}: missing in {folder}: {', '.join(sorted(missing[best]))}{told}")
        self.paths = [folder / name for name in sorted(self._names(*best))]

    @staticmethod
    def _names(tiles: int, ranges: int) -> set[str]:
        cuts = (Cut(Share(i, tiles), Share(j, ranges)) for i in range(1, tiles + 1) for j in range(1, ranges + 1))
        return {path_in(Path(), cut).name for cut in cuts}

    def fields(self, shape: LayerShape) -> dict[str, str]:
        """Fields of files' headers that a view layer's picture needs."""
        wanted = json.loads(json.dumps(asdict(shape)))
        layers = header_of(self.paths[0]).get("layers", [])
        return next((dict(each.get("fields", {})) for each in layers if each["shape"] == wanted), {})

    def film(self, core: ModuleType, shape: LayerShape) -> Any:
        """The sum of all parts of a view layer, as the core's FilmSums. Raises PartError."""
        film = core.FilmSums(shape.crop[2], shape.crop[3], list(shape.passes))
        for path in self.paths:
            layers = header_of(path).get("layers", [])
            wanted = json.loads(json.dumps(asdict(shape)))
            number = next((i for i, each in enumerate(layers) if each["shape"] == wanted), None)
            if number is None:
                raise PartError(f"{path} holds no view layer '{shape.view_layer}' of this size, samples and passes")
            prefix = f"{number}."
            with np.load(path) as file:
                sums = {name.removeprefix(prefix): file[name] for name in file.files if name.startswith(prefix)}
            film.add(*layers[number]["place"], layers[number]["samples"], sums)
        if film.samples() != (shape.samples, shape.samples):
            raise PartError(f"view layer '{shape.view_layer}': pixels have {film.samples()} of {shape.samples} samples")
        return film
