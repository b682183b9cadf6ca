"""Every method on one scene: first, repeated and orbit frames, errors, operations, and the table that shows them."""

import statistics
from dataclasses import dataclass, field
from typing import Any

import rayleaf_rivals
from ray_flops import Account, Counters, sample_flops
from ray_frames import Camera, Frame, ImagePlane, Method, Picture, Rival, Trees, error, render
from ray_scenes import Scene
from rayleaf import _core

TREES = {"reference": rayleaf_rivals.ReferenceTree, "fast": _core.ri_tree.FastTree}
# The paper's lengths are in units of its scenes; these are shares of half the object's size: its sheet's is 5 units.
PAPER_UNIT = 1 / 5
RIVALS = ("tracing", "triangles", "packets", "Newton")


@dataclass
class Effort:
    """How much is measured."""

    repeats: int = 2
    kept_frames: int = 12  # of the same rays, the first included: the last one is the repeated frame
    orbit_frames: int = 10
    rival_orbit_frames: int = 3  # rivals keep nothing from frame to frame


def paper_settings(
    distance: float = 0.05, degrees: float = 30.0, depth: int = 28, megabytes: float = 100
) -> dict[str, Any]:
    """The paper's parameters as settings of a tree."""
    return {
        "distance_threshold": distance * PAPER_UNIT,
        "angle_threshold": degrees * 0.017453292519943295,
        "depth_limit": depth,
        "cache_bytes": int(megabytes * 1e6),
    }


@dataclass
class Figures:
    """Of one method on one scene; times in seconds, every single measurement."""

    first: list[float] = field(default_factory=list)
    second: list[float] = field(default_factory=list)
    kept: list[float] = field(default_factory=list)  # mean of all frames of the same rays
    repeated: list[float] = field(default_factory=list)
    orbit: float = 0.0
    error: float = 0.0  # the larger one of the first and the repeated frame's
    frame: Frame = field(default_factory=Frame)
    samples: int = 0
    orbit_samples: float = 0.0
    megabytes: float = 0.0
    prunes: int = 0
    flops: dict[str, tuple[float, float]] = field(default_factory=dict)  # speed-up: first, repeated; by tracer

    @property
    def times(self) -> tuple[float, float, float]:
        """Medians: first, repeated, orbit."""
        return statistics.median(self.first), statistics.median(self.repeated), self.orbit

    def faster_than(self, other: "Figures") -> list[float]:
        """Speed-ups: first, repeated, orbit."""
        return [theirs / ours for ours, theirs in zip(self.times, other.times)]

    def share(self, *kinds: str) -> float:
        """Per cent of the first frame's rays whose answer's name begins so."""
        count = sum(n for name, n in self.frame.answers.items() if name.startswith(kinds))
        return 100 * count / max(self.frame.rays, 1)


class Bench:
    """A scene, a picture, and what traces it without a cache, measured once for any number of trees."""

    def __init__(self, scene: Scene, picture: Picture, effort: Effort, rivals: tuple[str, ...] = RIVALS) -> None:
        self.scene, self.picture, self.effort = scene, picture, effort
        own = Trees(scene, TREES["reference"], {}, traced=True)
        made: dict[str, Method] = {"tracing": own}
        if "triangles" in rivals:
            made["triangles"] = Rival(scene, "TRIANGLES")
        if "packets" in rivals:
            made["packets"] = Rival(scene, "TRIANGLES", packets=True)
        if "Newton" in rivals:
            made["Newton"] = Rival(scene, "NEWTON")
        if "image plane" in rivals:
            made["image plane"] = ImagePlane(scene, own)
        self.figures: dict[str, Figures] = {}
        self.counters = Counters.of(scene)
        self.truth = render(scene, own, picture, wants_image=True)
        for method in made.values():
            render(scene, method, picture)  # makes the facets that its rays meet
        self.measure_rivals(made)

    def measure_rivals(self, made: dict[str, Method]) -> None:
        """Interleaved, so that a busy machine slows all."""
        for name in made:
            self.figures[name] = Figures()
        for repeat in range(self.effort.repeats):
            for name, method in made.items():
                frame = render(self.scene, method, self.picture, wants_image=repeat == 0)
                self.figures[name].first.append(frame.seconds)
                self.figures[name].repeated.append(frame.seconds)
                if repeat == 0:
                    self.figures[name].frame = frame
                    self.figures[name].error = error(frame.image, self.truth.image)
        for name, method in made.items():
            self.figures[name].orbit = self.orbit(method, self.effort.rival_orbit_frames)

    def orbit(self, method: Method, count: int) -> float:
        """Mean seconds of so many frames while the camera moves by one degree each."""
        frames = [render(self.scene, method, self.picture, 1.0 + i) for i in range(count)]
        return sum(frame.seconds for frame in frames) / len(frames)

    def measure(self, tree: str, settings: dict[str, Any], repeats: int | None = None) -> Figures:
        """A tree of this name, each time from empty."""
        figures = Figures()
        for repeat in range(repeats or self.effort.repeats):
            trees = Trees(self.scene, TREES[tree], settings)
            frame = render(self.scene, trees, self.picture, wants_image=repeat == 0)
            figures.first.append(frame.seconds)
            if repeat == 0:
                figures.frame, figures.error = frame, error(frame.image, self.truth.image)
                figures.samples, figures.megabytes = trees.total("samples_taken"), trees.total("bytes") / 1e6
                figures.prunes = trees.total("prunes")
            wants_image, last = repeat == 0, self.effort.kept_frames - 2
            again = [render(self.scene, trees, self.picture, 0.0, wants_image and i == last) for i in range(last + 1)]
            figures.second.append(again[0].seconds)
            figures.repeated.append(again[-1].seconds)
            figures.kept.append((frame.seconds + sum(each.seconds for each in again)) / self.effort.kept_frames)
            if wants_image:
                figures.error = max(figures.error, error(again[-1].image, self.truth.image))
        self.count_flops(trees, figures, tree == "fast")
        before = trees.total("samples_taken")
        figures.orbit = self.orbit(trees, self.effort.orbit_frames)
        figures.orbit_samples = (trees.total("samples_taken") - before) / self.effort.orbit_frames
        return figures

    def first_error(self, tree: str, settings: dict[str, Any]) -> float:
        """Of a first frame."""
        trees = Trees(self.scene, TREES[tree], settings)
        return error(render(self.scene, trees, self.picture, wants_image=True).image, self.truth.image)

    def count_flops(self, trees: Trees, figures: Figures, fast: bool) -> None:
        """Of a first frame, by the samples it took, and of a repeated one."""
        rays = next(Camera(self.scene, self.picture, 0.0).bands())
        sample, depth = sample_flops(self.scene, trees, self.counters, rays)
        account = Account(self.scene, self.counters, depth=depth, fast=fast)
        before = trees.total("samples_taken")
        render(self.scene, trees, self.picture, account=account)
        again = trees.total("samples_taken") - before
        speed_ups = [account.speed_up(samples, sample) for samples in (figures.samples, again)]
        for i, tracer in enumerate(("triangles", "Newton")):
            figures.flops[tracer] = (float(speed_ups[0][i]), float(speed_ups[1][i]))


def numbers(values: list[float], width: int = 6, digits: int = 2) -> str:
    """Side by side."""
    return " ".join(f"{value:>{width}.{digits}f}" for value in values)


def print_scene(bench: Bench, trees: dict[str, Figures]) -> None:
    """A table of all methods on one scene."""
    print(f"\n  {bench.scene.name}, {bench.picture.text}")
    print(
        f"  {'':<12}{'ms: first':>10}{'again':>8}{'orbit':>8}   {'faster than triangles':<20}   {'than tracing':<20}   "
        f"{'2nd, mean':<14}{'FLOP: triang.':<15}{'Newton':<13}{'error':>8}{'interp.':>9}{'traced':>8}{'samples':>9}"
        f"{'orbit':>8}{'MB':>7}"
    )
    for name, own in {**bench.figures, **trees}.items():
        times = "".join(f"{1e3 * seconds:>{width}.1f}" for seconds, width in zip(own.times, (10, 8, 8)))
        line = f"  {name:<12}{times}   {numbers(own.faster_than(bench.figures['triangles']))}"
        line += f"   {numbers(own.faster_than(bench.figures['tracing']))}   "
        kept = [statistics.median(each) for each in (own.second, own.kept) if each]
        line += f"{numbers([bench.figures['tracing'].times[0] / seconds for seconds in kept]):<14}"
        flops = [numbers(list(own.flops[tracer])) if own.flops else "" for tracer in ("triangles", "Newton")]
        line += f"{flops[0]:<15}{flops[1]:<13}{own.error:>8.5f}"
        if name not in RIVALS:
            line += f"{own.share('interp', 'two classes, interp'):>8.1f}%{own.share('traced'):>7.1f}%"
        if own.samples:
            line += f"{own.samples:>9}{own.orbit_samples:>8.0f}{own.megabytes:>7.1f}"
        print(line, flush=True)


def rows_of(bench: Bench, trees: dict[str, Figures]) -> list[dict[str, Any]]:
    """Every measurement, for --json."""
    rows = []
    for name, own in {**bench.figures, **trees}.items():
        start = f"{bench.scene.name}, {bench.picture.text}: {name}"
        rows.append({"name": f"{start}, first frame", "unit": "s", "values": own.first})
        rows.append({"name": f"{start}, repeated frame", "unit": "s", "values": own.repeated})
        rows.append({"name": f"{start}, orbit frame", "unit": "s", "values": [own.orbit]})
        rows.append({"name": f"{start}, error", "unit": "mean RGB distance", "values": [own.error]})
    return rows
