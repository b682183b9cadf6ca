"""Small pictures of the scenes, kept as references, and the page that shows them beside new ones."""

import html
from dataclasses import dataclass
from pathlib import Path

import matplotlib.image
import numpy as np
from numpy.typing import NDArray
from rayleaf.report.errors import to_srgb

SIZE = 160  # pixels along the longer side
SAMPLES = 16

# The same build on the same processor repeats every bit. Another instruction set or compiler rounds a few sums
# differently, and where a path then takes another turn, one of a pixel's samples is another one: a pixel may change by
# much, but few pixels do, and the picture as a whole does not.
PIXEL_TOLERANCE = 0.02  # absolute, of linear light, plus the same share of the reference
PIXELS_OUTSIDE = 0.01  # share of pixels that may lie outside of it
MEAN_TOLERANCE = 0.002  # of the picture's mean, relative
# The references are Blender 3.4's. What the Principled node of Blender 4 makes otherwise, as it does in Cycles, has a second
# reference, from Blender 5.0, in references_since_4; what 5 makes otherwise again, one in references_since_5.
# Opening the scenes, Blender 4 turns a specular of 0.5 (4 % reflectance) into an index of refraction of 1.45 (3.4 %), and its
# spots do not darken from their axis: measured 1.8 % of pixels, 1.3 % of the mean.
LATER_PIXELS_OUTSIDE = 0.03
# Since 3.5 a closed curve's minimum twist is spread, so facets lie otherwise under the knot's glass, and more of its paths
# take other turns: 4.7 % of pixels by that alone, 6.3 % together.
LATER_PIXELS_OUTSIDE_OF = {"knot": 0.08}
LATER_MEAN_TOLERANCE = 0.02

RENDER = """
import sys
from pathlib import Path
import bpy
import numpy as np

scene_file, reference, folder, size, samples = sys.argv[1:]
bpy.ops.wm.open_mainfile(filepath=scene_file)
later = bpy.app.version >= (4, 0, 0)
first = Path(reference)
for since in range(4, bpy.app.version[0] + 1):
    newer = first.parent.with_name(f"{first.parent.name}_since_{since}") / first.name
    reference = str(newer) if newer.exists() else reference
report(later=later, reference=reference)
scene, render = bpy.context.scene, bpy.context.scene.render
longest = max(render.resolution_x, render.resolution_y)
render.resolution_x = render.resolution_x * int(size) // longest
render.resolution_y = render.resolution_y * int(size) // longest
render.resolution_percentage = 100
scene.rayleaf.samples, scene.rayleaf.seed = int(samples), 1
bpy.ops.render.render()
settings = render.image_settings
settings.file_format, settings.color_mode, settings.color_depth, settings.exr_codec = "OPEN_EXR", "RGB", "16", "ZIP"
new = str(Path(folder, "new.exr"))
bpy.data.images["Render Result"].save_render(new, scene=scene)

def keep_pixels(path, name):
    image = bpy.data.images.load(path)
    pixels = np.empty(len(image.pixels), dtype=np.float32)
    image.pixels.foreach_get(pixels)
    np.save(str(Path(folder, name)), pixels.reshape(image.size[1], image.size[0], image.channels)[::-1, :, :3])

keep_pixels(new, "new.npy")
if Path(reference).exists():
    keep_pixels(reference, "reference.npy")
"""


@dataclass
class Comparison:
    """How a new picture differs from its reference; linear light, rows top to bottom."""

    name: str
    new: NDArray[np.float32]
    reference: NDArray[np.float32]
    later: bool = False  # rendered by Blender 4

    @property
    def outside(self) -> float:
        """The share of pixels that differ by more than the tolerance."""
        allowed = PIXEL_TOLERANCE * (1 + np.abs(self.reference))
        return float(np.mean(np.any(np.abs(self.new - self.reference) > allowed, axis=-1)))

    @property
    def mean_change(self) -> float:
        """The change of the picture's mean, relative."""
        return float(abs(self.new.mean() - self.reference.mean()) / max(self.reference.mean(), 1e-6))

    @property
    def verdict(self) -> str:
        """Empty if the picture is as it was."""
        if self.new.shape != self.reference.shape:
            return f"the size was {self.reference.shape[:2]} and is {self.new.shape[:2]}"
        if not np.isfinite(self.new).all():
            return "there are pixels that are no numbers"
        later = LATER_PIXELS_OUTSIDE_OF.get(self.name, LATER_PIXELS_OUTSIDE)
        pixels = later if self.later else PIXELS_OUTSIDE
        mean = LATER_MEAN_TOLERANCE if self.later else MEAN_TOLERANCE
        if self.outside > pixels:
            return f"{self.outside:.2%} of the pixels differ by more than {PIXEL_TOLERANCE}; {pixels:.0%} may"
        if self.mean_change > mean:
            return f"the mean changed by {self.mean_change:.2%}; {mean:.1%} is allowed"
        return ""


def write_png(path: Path, linear: NDArray[np.float32]) -> None:
    """Linear light as an sRGB picture."""
    encoded = to_srgb(np.clip(np.nan_to_num(linear), 0, 1))
    matplotlib.image.imsave(path, np.ascontiguousarray(encoded.astype(np.float64)))


def write_pictures(comparison: Comparison, folder: Path) -> None:
    """The pictures that the page shows; the difference is enlarged eightfold around middle grey."""
    write_png(folder / "new.png", comparison.new)
    write_png(folder / "reference.png", comparison.reference)
    if comparison.new.shape == comparison.reference.shape:
        difference = np.clip(0.5 + 4 * (comparison.new - comparison.reference), 0, 1)
        matplotlib.image.imsave(folder / "difference.png", np.ascontiguousarray(difference.astype(np.float64)))


def write_page(comparisons: list[Comparison], folder: Path) -> None:
    """index.html: a row for each scene."""
    rows = []
    for each in comparisons:
        cells = "".join(
            f'<td><img src="{each.name}/{kind}.png" alt="{kind}"></td>' for kind in ("new", "reference", "difference")
        )
        verdict = html.escape(each.verdict or f"as it was ({each.outside:.2%} of the pixels outside)")
        rows.append(f"<tr><th>{each.name}<p>{verdict}</p></th>{cells}</tr>")
    folder.joinpath("index.html").write_text(
        '<!doctype html><meta charset="utf-8"><title>Rayleaf: golden images</title>'
        "<style>body{font:14px sans-serif;background:#333;color:#eee}img{width:320px;image-rendering:pixelated}"
        "th{text-align:left;vertical-align:top;padding-right:1em}p{font-weight:normal;max-width:16em}</style>"
        "<table><tr><th></th><th>new</th><th>reference</th><th>difference, eightfold</th></tr>"
        + "".join(rows)
        + "</table>"
    )
