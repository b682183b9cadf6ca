"""Every pass of a scene as a picture. The render is one of `render_points` with a multilayer EXR beside the pixels."""

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from . import page
from .measure import Conditions, render
from .points import Point


_CHANNELS = "RXUGYVBZA"  # as they are to stand
# Passes of colours, by their names before 5.0 and since; light passes end in "Dir" and so on.
_COLORS = ("Combined", "Rayleaf Mask Colors", "AO", "Env", "Emit", "Ambient Occlusion", "Environment", "Emission")
_COLOR_ENDINGS = ("Dir", "Ind", "Col", " Direct", " Indirect", " Color")


def read_layers(path: Path) -> dict[str, Any]:
    """Pass name -> (height, width, channels), rows bottom to top, channels as R, G, B, A or X, Y, Z or U, V, A; of the
    first view layer of Blender's file. Since 5.0 each pass is a part of its own."""
    import OpenImageIO as oiio

    source = oiio.ImageInput.open(str(path))
    if source is None:
        raise RuntimeError(f"{path}: {oiio.geterror()}")
    found: dict[str, Any] = {}
    try:
        number = 0
        while source.seek_subimage(number, 0):
            pixels = source.read_image(number, 0, 0, source.spec().nchannels, oiio.FLOAT)[::-1]
            found |= _passes(list(source.spec().channelnames), pixels)
            number += 1
    finally:
        source.close()
    return found


def _passes(names: list[str], pixels: Any) -> dict[str, Any]:
    """Of one part, whose channels have these names: "View Layer.Pass.Channel"."""
    found: dict[str, list[int]] = {}
    for index, name in enumerate(names):
        parts = name.split(".")
        if len(parts) >= 3:
            found.setdefault(".".join(parts[1:-1]), []).append(index)
    # A file holds channels in the order of their names, a reader may sort them.
    order = {index: _CHANNELS.find(names[index].split(".")[-1]) for each in found.values() for index in each}
    return {name: pixels[..., sorted(indices, key=order.__getitem__)] for name, indices in found.items()}


def visible(name: str, values: Any) -> Any | None:
    """What to show of a pass: colours as they are, numbers stretched over what they hold; None if there is nothing."""
    finite = np.where(np.abs(values) < 1e9, np.nan_to_num(values), 0.0)
    if not np.any(finite[..., :3]):
        return None
    if name in _COLORS or name.endswith(_COLOR_ENDINGS):
        return finite[..., :3]
    if name in ("Normal", "Position", "UV"):
        low, high = finite.min(), finite.max()
        return (finite[..., :3] - low) / (high - low)
    largest = float(np.abs(finite).max())
    return np.abs(finite[..., :1]) / largest


def scene_pictures(blender: str, file: Path, width: int, samples: int) -> str:
    """The figures of one scene, as HTML."""
    everything = Point(
        "Gallery", file.stem, assign={"rayleaf.samples": samples, "rayleaf.ray_interpolation.mode": "AUTO"}
    )
    with tempfile.TemporaryDirectory(prefix="rayleaf_report_") as name:
        folder = Path(name)
        raw = render(blender, file, [everything], Conditions(width, all_passes=True), folder)[0]
        if "problem" in raw:
            return page.paragraph(f"{file.name}: {raw['problem']}", "note")
        layers = read_layers(Path(raw["layers"]))
    shown = {each: visible(each, values) for each, values in layers.items()}
    return page.pictures(*(page.picture(values, each) for each, values in shown.items() if values is not None))
