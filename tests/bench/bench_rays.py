"""Ray caches against tracing: speed-up of first, repeated and orbit frames, error, share interpolated, memory.

One thread, its processor time, answering rays alone (ray_frames.py). The scenes are in ray_scenes.py. First frame: an
empty cache. Repeated: the same rays again. Orbit: the mean of ten frames while the camera moves by one degree each.
Errors are against the tracer that filled the cache: the mean distance of RGB values in [0, 1] that rays see in the end.

What is compared: `tracing`, Rayleaf's own, the one that fills the caches; `triangles`, the same surfaces as Embree's
triangles, 16 x 16 a patch, with exact normals, one ray at a time; `packets`, the same in packets of 16; `Newton` on exact
patches; `image plane`, camera rays interpolated in the picture, rebuilt each frame; and the caches.
"""

import statistics
from dataclasses import dataclass, field
from typing import Any

from ray_frames import Frame, ImagePlane, Method, Picture, Rival, Trees, error, render
from ray_scenes import Scene, chaotic_glass, gentle_glass, mirror_sheet, random_volumes, tomatoes
from rayleaf import _core

PRINTS_ITSELF = True
ORBIT_FRAMES = 10
REPEATS = 3
TREES = {"reference": _core.ri_tree.ReferenceTree, "fast": _core.ri_tree.FastTree}
# The paper's 0.05 on a sheet of 10 units, as a share of half its side; its angle and depth.
PAPER = {"distance_threshold": 0.01, "angle_threshold": 0.5235987755982988, "depth_limit": 28}


@dataclass
class Figures:
    """Of one method on one scene; times in seconds, every single measurement."""

    first: list[float] = field(default_factory=list)
    repeated: list[float] = field(default_factory=list)
    orbit: float = 0.0
    error: float = 0.0
    frame: Frame = field(default_factory=Frame)
    samples: int = 0
    orbit_samples: float = 0.0
    megabytes: float = 0.0

    @property
    def times(self) -> tuple[float, float, float]:
        """Medians: first, repeated, orbit."""
        return statistics.median(self.first), statistics.median(self.repeated), self.orbit

    def share(self, *kinds: str) -> float:
        """Per cent of the first frame's rays whose answer's name begins so."""
        count = sum(n for name, n in self.frame.answers.items() if name.startswith(kinds))
        return 100 * count / max(self.frame.rays, 1)


def rivals(scene: Scene) -> dict[str, Method]:
    """What holds nothing from frame to frame."""
    own = Trees(scene, _core.ri_tree.ReferenceTree, {}, traced=True)
    return {
        "tracing": own,
        "triangles": Rival(scene, "TRIANGLES"),
        "packets": Rival(scene, "TRIANGLES", packets=True),
        "Newton": Rival(scene, "NEWTON"),
        "image plane": ImagePlane(scene, own),
    }


def measure(
    scene: Scene, picture: Picture, settings: dict[str, dict[str, Any]], repeats: int, orbit_frames: int
) -> dict[str, Figures]:
    """Every method on a scene; `settings` of the trees by name. Interleaved, so that a busy machine slows all."""
    others = rivals(scene)
    figures = {name: Figures() for name in (*others, *settings)}
    render(scene, others["image plane"], picture)  # makes the facets that its rays meet
    truth = render(scene, others["tracing"], picture, wants_image=True)
    trees: dict[str, Trees] = {}
    for repeat in range(repeats):
        for name, method in others.items():
            frame = render(scene, method, picture, wants_image=repeat == 0)
            figures[name].first.append(frame.seconds)
            figures[name].repeated.append(frame.seconds)
            if repeat == 0:
                figures[name].frame, figures[name].error = frame, error(frame.image, truth.image)
        for name in settings:
            trees[name] = Trees(scene, TREES[name.split(":")[0]], settings[name])
            note_first_frames(scene, picture, trees[name], figures[name], truth if repeat == 0 else None)
    for name, tracer in {**others, **trees}.items():
        before = tracer.total("samples_taken") if isinstance(tracer, Trees) else 0
        frames = [render(scene, tracer, picture, degrees) for degrees in range(1, orbit_frames + 1)]
        figures[name].orbit = sum(frame.seconds for frame in frames) / orbit_frames
        if isinstance(tracer, Trees) and name in trees:
            figures[name].orbit_samples = (tracer.total("samples_taken") - before) / orbit_frames
    return figures


def note_first_frames(scene: Scene, picture: Picture, tree: Trees, figures: Figures, truth: Frame | None) -> None:
    """An empty tree's first frame and the same again."""
    frame = render(scene, tree, picture, wants_image=truth is not None)
    figures.first.append(frame.seconds)
    if truth is not None:
        figures.frame, figures.error = frame, error(frame.image, truth.image)
        figures.samples, figures.megabytes = tree.total("samples_taken"), tree.total("bytes") / 1e6
    figures.repeated.append(render(scene, tree, picture).seconds)


def print_scene(scene: Scene, picture: Picture, figures: dict[str, Figures]) -> None:
    """A table of all methods on one scene."""
    print(f"\n  {scene.name}, {picture.text}")
    print(
        f"  {'':<12}{'ms: first':>10}{'again':>8}{'orbit':>8}   {'faster than triangles':<23}{'than tracing':<21}"
        f"{'error':>8}{'interp.':>8}{'traced':>8}{'samples':>9}{'orbit':>8}{'MB':>7}"
    )
    for name, own in figures.items():
        times = "".join(f"{1e3 * seconds:>{width}.1f}" for seconds, width in zip(own.times, (10, 8, 8)))
        ratios = [
            " ".join(f"{base / seconds:>6.2f}" for base, seconds in zip(figures[other].times, own.times))
            for other in ("triangles", "tracing")
        ]
        line = f"  {name:<12}{times}   {ratios[0]}   {ratios[1]}{own.error:>10.5f}"
        if own.frame.answers and name not in ("tracing", "triangles", "packets", "Newton"):
            line += f"{own.share('interp', 'two classes, interp'):>7.1f}%{own.share('traced'):>7.1f}%"
        if own.samples:
            line += f"{own.samples:>9}{own.orbit_samples:>8.0f}{own.megabytes:>7.1f}"
        print(line, flush=True)


def rows_of(scene: Scene, picture: Picture, figures: dict[str, Figures]) -> list[dict[str, Any]]:
    """Every measurement, for --json."""
    rows = []
    for name, own in figures.items():
        start = f"{scene.name}, {picture.text}: {name}"
        rows.append({"name": f"{start}, first frame", "unit": "s", "values": own.first})
        rows.append({"name": f"{start}, repeated frame", "unit": "s", "values": own.repeated})
        rows.append({"name": f"{start}, orbit frame", "unit": "s", "values": [own.orbit]})
        rows.append({"name": f"{start}, error", "unit": "mean RGB distance", "values": [own.error]})
    return rows


def run(quick: bool = False) -> list[dict[str, Any]]:
    """Prints the tables; returns every measurement."""
    side, repeats, orbit_frames = (48, 1, 1) if quick else (600, REPEATS, ORBIT_FRAMES)
    rows = []
    cases = [
        (mirror_sheet(), Picture(side, side)),
        (mirror_sheet(), Picture(side // 2, side // 2, 3)),
        (random_volumes(), Picture(side, side)),
        (gentle_glass(), Picture(side // 2, side // 2, 3)),
        (chaotic_glass(), Picture(side, side)),
        (random_volumes("VOLUME"), Picture(side, side)),
        (tomatoes(), Picture(2 * side, 3 * side // 2)),
    ]
    for scene, picture in cases:
        figures = measure(scene, picture, {name: PAPER for name in TREES}, repeats, orbit_frames)
        print_scene(scene, picture, figures)
        rows += rows_of(scene, picture, figures)
    return rows
