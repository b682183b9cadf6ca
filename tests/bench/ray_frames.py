"""Frames of the ray cache's benchmark: camera rays, what answers them, and what is seen in the end.

Only answering rays is timed, on one thread, by its processor time. Rays are made, and pictures put together, in between.
Rays run in tiles of 16 x 16, within them in blocks of 4 x 4.
"""

import time
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np
import rayleaf_rivals
from numpy.typing import NDArray
from ray_scenes import Doubles, Object, Scene
from rayleaf import _core

BLOCK, TILE = 4, 16
BAND_RAYS = 400_000  # asked at once, so that large pictures do not fill the memory
WARMING_PIXELS = 48  # of views from eight sides, for which facets are made before anything is timed
START_OFFSET = 1e-4  # of the scene's size: how far from a surface the next ray starts
LIGHT = np.array([0.4, -0.5, 0.77])
AMBIENT = 0.25
Answers = dict[str, Any]


def unit(vectors: Doubles) -> Doubles:
    """Vectors of length 1."""
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


@dataclass
class Picture:
    """Pixels, and samples along either side of one."""

    width: int
    height: int
    side: int = 1

    @property
    def columns(self) -> int:
        """Samples in a row."""
        return self.width * self.side

    @property
    def rows(self) -> int:
        """Rows of samples."""
        return self.height * self.side

    @property
    def text(self) -> str:
        """How it is called."""
        return f"{self.width} x {self.height}" + (f", {self.side**2} samples" if self.side > 1 else "")


@dataclass
class Rays:
    """A batch: rays, their spacing to the neighbours, their points in the picture (sample units), the object left."""

    origins: Doubles
    directions: Doubles
    distances: NDArray[np.float32]
    angles: NDArray[np.float32]
    points: Doubles | None = None
    left: NDArray[np.int32] | None = None


class Camera:
    """A pinhole that looks at the scene's target, turned around the vertical by so many degrees."""

    def __init__(self, scene: Scene, picture: Picture, degrees: float) -> None:
        turn, rise = np.radians(scene.turn + degrees), np.radians(scene.rise)
        back = np.array([np.cos(turn) * np.cos(rise), np.sin(turn) * np.cos(rise), np.sin(rise)])
        self.picture, self.eye = picture, scene.target + scene.distance * back
        right = unit(np.cross(-back, [0, 0, 1]))
        up = np.cross(right, -back)
        self.step = scene.width / picture.columns
        self.right, self.up = right * self.step, up * self.step
        self.corner = -back - self.right * picture.columns / 2 - self.up * picture.rows / 2
        self.distance = scene.distance

    def bands(self) -> Iterator[Rays]:
        """The rays of the picture, tile by tile, in batches."""
        columns, rows = self.picture.columns, self.picture.rows
        band = max(1, BAND_RAYS // (columns * TILE)) * TILE
        for first in range(0, rows, band):
            x, y = (part.ravel() for part in np.meshgrid(np.arange(columns), np.arange(first, min(rows, first + band))))
            keys = (x % BLOCK, y % BLOCK, x % TILE // BLOCK, y % TILE // BLOCK, x // TILE, y // TILE)
            order = np.lexsort(keys)
            points = np.stack([x[order], y[order]], axis=1) + 0.5
            directions = unit(self.corner + points[:, :1] * self.right + points[:, 1:] * self.up)
            origins = np.broadcast_to(self.eye, directions.shape).copy()
            angles = np.full(len(points), self.step, np.float32)
            yield Rays(origins, directions, np.float32(self.distance) * angles, angles, points)


class Method(Protocol):
    """What answers rays."""

    def begin(self, camera: Camera) -> None:
        """A new frame."""

    def ask(self, rays: Rays) -> Answers:
        """Output rays, and the seconds they took."""


class Rival:
    """One of the tracers of core/trace/rival_scene.h over all objects at once."""

    def __init__(self, scene: Scene, method: str, packets: bool = False) -> None:
        objects = [(each.surface, each.kind, each.ior) for each in scene.objects]
        self.tracer = rayleaf_rivals.RivalTracer(objects, method, most_interior_hits=scene.interior_hits)
        self.packets = packets

    def begin(self, camera: Camera) -> None:
        """Nothing to be done."""

    def ask(self, rays: Rays) -> Answers:
        """By tracing."""
        answers: Answers = self.tracer.trace(rays.origins, rays.directions, self.packets)
        return answers


class Trees:
    """A tree an object, or with `traced` only the tracer that would fill it. That tracer's facets are made already."""

    def __init__(self, scene: Scene, tree: Any, settings: dict[str, Any], traced: bool = False) -> None:
        hits, self.between = scene.interior_hits, 0.0  # seconds between frames
        self.trees = [
            tree(each.surface, each.kind, ior=each.ior, most_interior_hits=hits, **settings) for each in scene.objects
        ]
        parts = [(each.surface, made) for each, made in zip(scene.objects, self.trees)]
        self.set = rayleaf_rivals.ObjectSet(parts, traced=traced, sum_of_lengths=scene.lengths)
        tracing = rayleaf_rivals.ObjectSet(parts, traced=True, sum_of_lengths=scene.lengths)
        for degrees in range(0, 360, 45):
            for rays in Camera(scene, Picture(WARMING_PIXELS, WARMING_PIXELS), degrees).bands():
                tracing.ask(rays.origins, rays.directions)

    def begin(self, camera: Camera) -> None:
        """What the trees hold stays; rays that crossed cells in the last frame pay for them now."""
        begin = time.thread_time()
        for tree in self.trees:
            tree.next_frame()
        self.between = time.thread_time() - begin

    def ask(self, rays: Rays) -> Answers:
        """By the trees."""
        answers: Answers = self.set.ask(rays.origins, rays.directions, rays.distances, rays.angles, left=rays.left)
        answers["seconds"] += self.between
        self.between = 0.0
        return answers

    def total(self, name: str) -> int:
        """A number of the statistics, summed over all trees."""
        return int(sum(tree.statistics()[name] for tree in self.trees))


class ImagePlane:
    """Camera rays interpolated in the picture, anew each frame; all others traced as those in between."""

    def __init__(self, scene: Scene, own: Trees) -> None:
        hits = scene.interior_hits
        self.planes = [
            rayleaf_rivals.ImagePlane(each.surface, each.kind, each.ior, most_interior_hits=hits)
            for each in scene.objects
        ]
        parts = [(each.surface, plane) for each, plane in zip(scene.objects, self.planes)]
        self.set = rayleaf_rivals.ObjectSet(parts, sum_of_lengths=scene.lengths)
        self.own = own

    def begin(self, camera: Camera) -> None:
        """Forget the last frame."""
        for plane in self.planes:
            plane.look(camera.eye, camera.corner, camera.right, camera.up)

    def ask(self, rays: Rays) -> Answers:
        """Camera rays have a place in the picture."""
        if rays.points is None:
            return self.own.ask(rays)
        answers: Answers = self.set.ask(rays.origins, rays.directions, points=rays.points, left=rays.left)
        return answers

    def total(self, name: str) -> int:
        """A number of the statistics, summed over all objects."""
        return int(sum(plane.statistics()[name] for plane in self.planes))


def surrounding(directions: Doubles) -> Doubles:
    """RGB in [0, 1] that a smooth, far surrounding of several frequencies shows in a direction."""
    d = directions
    colors = np.empty((len(d), 3))
    for channel, (a, b, c) in enumerate(((7, 3, 2), (2, 9, 4), (5, 2, 8))):
        waves = np.sin(a * d[:, 0] + channel) + np.sin(b * d[:, 1] + c * d[:, 2]) + np.sin(19 * d[:, channel])
        colors[:, channel] = 0.5 + waves / 6
    return colors


@dataclass
class Frame:
    """What a frame took, how its rays were answered, and the picture if it was wanted."""

    seconds: float = 0.0
    rays: int = 0
    answers: Counter[str] = field(default_factory=Counter)
    image: Doubles | None = None


def spacing_of(origins: Doubles, directions: Doubles) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """How far from their nearer neighbour in the batch rays start and turn."""

    def nearer(values: Doubles) -> NDArray[np.float32]:
        if len(values) < 2:
            return np.zeros(len(values), np.float32)
        apart = np.linalg.norm(np.diff(values, axis=0), axis=1)
        return np.minimum(np.append(apart, apart[-1]), np.append(apart[:1], apart)).astype(np.float32)

    return nearer(origins), nearer(directions)


class Follower:
    """Follows the rays of a frame from object to object and adds up what they see."""

    def __init__(
        self, scene: Scene, method: Method, frame: Frame, wants_image: bool, account: Callable[[Rays, Answers], None]
    ) -> None:
        self.scene, self.method, self.frame, self.wants_image = scene, method, frame, wants_image
        self.account = account
        self.offset = START_OFFSET * scene.distance

    def ask(self, rays: Rays) -> Answers:
        """Answers, added to the frame's account."""
        answers = self.method.ask(rays)
        self.frame.seconds += answers["seconds"]
        self.frame.rays += len(rays.origins)
        kinds = np.bincount(answers["answered_by"], minlength=len(_core.ri_tree.ANSWERS))
        self.frame.answers.update(dict(zip(_core.ri_tree.ANSWERS, kinds.tolist())))
        self.account(rays, answers)
        return answers

    def follow(self, rays: Rays) -> Doubles:
        """RGB of camera rays; lengths inside objects as grey."""
        colors = np.zeros((len(rays.origins), 3))
        waiting = [(rays, np.arange(len(colors)), np.ones_like(colors))]
        for _ in range(self.scene.rounds):
            following = []
            for asked, pixels, weights in waiting:
                answers = self.ask(asked)
                if self.scene.lengths:
                    return np.repeat(answers["length"][:, None].astype(float), 3, axis=1)
                if self.wants_image or self.scene.rounds > 1:
                    following += self.see(asked, answers, pixels, weights, colors)
            waiting = [each for each in following if len(each[1])]
        for asked, pixels, weights in waiting:
            np.add.at(colors, pixels, weights * surrounding(asked.directions))
        return colors

    def see(
        self, rays: Rays, answers: Answers, pixels: NDArray[np.int64], weights: Doubles, colors: Doubles
    ) -> list[tuple[Rays, NDArray[np.int64], Doubles]]:
        """Adds what rays see; returns those that go on."""
        missed = answers["object"] < 0
        np.add.at(colors, pixels[missed], weights[missed] * surrounding(rays.directions[missed]))
        following = []
        for index, each in enumerate(self.scene.objects):
            hit = np.flatnonzero(answers["object"] == index)
            if not len(hit):
                continue
            if each.kind == "SIMPLE":
                light = self.light(each, rays, answers, hit)
                np.add.at(colors, pixels[hit], weights[hit] * light)
                continue
            share = 1.0 - each.transparency
            following.append(self.onward(index, each, answers, hit, pixels, weights * share * each.color))
            if each.transparency:
                through = self.through(rays, answers, hit)
                following.append((through, pixels[hit], weights[hit] * each.transparency))
        return following

    def light(self, each: Object, rays: Rays, answers: Answers, hit: NDArray[np.int64]) -> Doubles:
        """Of a matte surface under one far lamp, with its shadow."""
        normal = answers["normal"][hit].astype(float)
        normal *= -np.sign(np.sum(normal * rays.directions[hit], axis=1))[:, None]
        direction = np.broadcast_to(unit(LIGHT), normal.shape).copy()
        origins = answers["position"][hit] + self.offset * normal
        bright = np.maximum(normal @ unit(LIGHT), 0)
        lit = np.flatnonzero(bright > 0)
        if len(lit):
            shadow = self.ask(Rays(origins[lit], direction[lit], *spacing_of(origins[lit], direction[lit])))
            through = np.array([other.transparency for other in self.scene.objects] + [1.0])
            bright[lit] *= through[shadow["object"]]
        return np.asarray(each.color) * (AMBIENT + (1 - AMBIENT) * bright)[:, None]

    def onward(
        self,
        index: int,
        each: Object,
        answers: Answers,
        hit: NDArray[np.int64],
        pixels: NDArray[np.int64],
        weights: Doubles,
    ) -> tuple[Rays, NDArray[np.int64], Doubles]:
        """Reflected or refracted rays; a convex object is not asked again by those that leave it. Paths that were cut off
        inside glass are black."""
        hit = hit[answers["exit_direction"][hit].any(axis=1)]
        directions = unit(answers["exit_direction"][hit].astype(float))
        origins = answers["exit_position"][hit] + self.offset * directions
        left = np.full(len(hit), index if each.convex else -1, np.int32)
        return Rays(origins, directions, *spacing_of(origins, directions), left=left), pixels[hit], weights[hit]

    def through(self, rays: Rays, answers: Answers, hit: NDArray[np.int64]) -> Rays:
        """Rays that go straight on."""
        directions = rays.directions[hit]
        origins = answers["position"][hit] + self.offset * directions
        return Rays(origins, directions, *spacing_of(origins, directions))


def no_account(rays: Rays, answers: Answers) -> None:
    """Nothing is counted."""


def render(
    scene: Scene,
    method: Method,
    picture: Picture,
    degrees: float = 0.0,
    wants_image: bool = False,
    account: Callable[[Rays, Answers], None] = no_account,
) -> Frame:
    """One frame; `account` is told all rays and their answers."""
    camera, frame = Camera(scene, picture, degrees), Frame()
    image = np.zeros((picture.width * picture.height, 3)) if wants_image else None
    method.begin(camera)
    follower = Follower(scene, method, frame, wants_image, account)
    for band in camera.bands():
        colors = follower.follow(band)
        if image is not None and band.points is not None:
            x, y = (band.points / picture.side).astype(np.int64).T
            for channel in range(3):
                image[:, channel] += np.bincount(y * picture.width + x, colors[:, channel], len(image))
    if image is not None:
        frame.image = image.reshape(picture.height, picture.width, 3) / picture.side**2
    return frame


def error(image: Doubles | None, truth: Doubles | None) -> float:
    """Mean distance of the RGB values of two pictures."""
    assert image is not None and truth is not None
    return float(np.linalg.norm(image - truth, axis=2).mean())
