"""The table by which the world is sampled is as fine as the world needs, and what it samples adds up."""

from typing import Any

import numpy as np
import pytest
from test_integrators_world_image import sky_image

WIDTH = 512
PICTURE = sky_image()


class World:
    """A world's program under construction."""

    def __init__(self, core) -> None:
        self.scene, self.program = core.SceneDescription(), core.Program("world")
        self.core, self.texture = core, self.scene.add_image_pixels("sky", PICTURE, "LINEAR")
        self.direction = self.program.operation("generated")

    def numbers(self, *values: float) -> int:
        return self.program.constant(*(values if len(values) > 1 else values * 4))

    def mapped(self, location=0.0, scale=(1, 1, 1, 1), text="POINT") -> int:
        turn = self.numbers(0.3, -0.2, 0.9, 1)
        return self.program.operation(
            "mapping", [self.direction, self.numbers(location), turn, self.numbers(*scale)], text=text
        )

    def seen(self, direction: int | None = None, projection: int = 0) -> int:
        at = self.direction if direction is None else direction
        return self.program.operation("environment", [at], [self.texture, projection, 0])

    def mixed(self, a: int, b: int) -> int:
        return self.program.operation("mix", [self.numbers(0.5), a, b], ints=[0, 0], text="MIX")

    def path(self) -> int:
        return self.program.operation("light_path", text="is_camera")

    def noise(self, at: int) -> int:
        operands = [at, self.numbers(0.0), self.numbers(5.0), self.numbers(2.0), self.numbers(0.5), self.numbers(0.0)]
        return self.program.operation("noise", operands, ints=[3])

    def scene_of(self, color: int) -> Any:
        one = self.numbers(1.0)
        self.program.operation("background", [one, color, one])
        self.scene.set_world(self.program, WIDTH)
        self.scene.set_camera("PERSPECTIVE", np.eye(4), (-1, -1), (1, 1), 0.1, 10)
        return self.scene


OF_PICTURES = {
    "the picture": lambda w: w.seen(),
    "turned": lambda w: w.seen(w.mapped()),
    "turned back, all lengths the same": lambda w: w.seen(w.mapped(scale=(2, 2, 2, 1), text="TEXTURE")),
    "of other colours": lambda w: w.program.operation("gamma", [w.seen(), w.numbers(2.0)]),
    "twice": lambda w: w.mixed(w.seen(), w.seen(w.mapped())),
    "for the camera alone": lambda w: w.program.operation(
        "mix", [w.path(), w.seen(), w.numbers(0.1)], ints=[0, 0], text="MIX"
    ),
}
OTHERS = {
    "stretched": lambda w: w.seen(w.mapped(scale=(1, 1, 9, 1))),
    "moved": lambda w: w.seen(w.mapped(location=0.5)),
    "in a ball": lambda w: w.seen(projection=1),
    "beside noise": lambda w: w.mixed(w.seen(), w.noise(w.direction)),
    "noise of its colours": lambda w: w.noise(w.seen()),
    "bands of its colours": lambda w: w.program.operation("math", [w.seen(), w.numbers(0.1)], ints=[0], text="MODULO"),
    "beside the direction": lambda w: w.mixed(w.seen(), w.direction),
    "by the window": lambda w: w.mixed(w.seen(), w.program.operation("window")),
    "no picture": lambda w: w.direction,
}


def table_bytes(core, color: Any) -> int:
    """Of lights, which are the table alone."""
    world = World(core)
    session = core.Session(world.scene_of(color(world)), core.Settings(width=1, height=1, samples=1))
    assert session.render()
    return int(session.statistics()["memory"]["lights"])


@pytest.mark.parametrize("color", OF_PICTURES.values(), ids=OF_PICTURES.keys())
def test_a_world_of_pictures_has_a_table_at_most_twice_as_fine(core, color):
    cells = 2 * PICTURE.shape[1] * PICTURE.shape[0] * 2
    assert table_bytes(core, color) < 1.6 * 4 * cells, "sums for each cell, and a guide for every fourth"


def test_a_world_that_changes_slowly_has_a_small_table_and_one_with_a_small_sun_a_fine_one(core):
    def with_a_sun(world):
        towards_sun = world.numbers(0.9999 / np.sqrt(3))  # the mean of a unit vector's components, 0.8 degrees off
        sun = world.program.operation("math", [world.direction, towards_sun], ints=[0], text="GREATER_THAN")
        return world.program.operation("mix", [world.numbers(0.9), world.direction, sun], ints=[0, 0], text="ADD")

    full = 4 * WIDTH * WIDTH // 2
    assert table_bytes(core, lambda world: world.direction) < full / 20
    assert table_bytes(core, with_a_sun) >= full / 5


def probe_world(core, color):
    """What is sampled of a world: its brightness there, the density, and the mean brightness of all directions."""
    world = World(core)
    probe = core.LightProbe(world.scene_of(color(world)))
    random = np.random.default_rng(3).random((20_000, 2)).astype(np.float32).clip(0, np.float32(1 - 2**-24))
    samples = probe.sample(np.zeros(3), random)
    radiance, density = probe.look(np.zeros(3), samples["direction"].astype(float))
    # Directions pass through floats: on a cell's border the neighbour may answer.
    assert np.isclose(samples["density"], density, rtol=1e-3)[samples["density"] > 0].mean() > 0.999
    even = np.random.default_rng(4).normal(size=(100_000, 3))
    even /= np.linalg.norm(even, axis=1, keepdims=True)
    mean = probe.look(np.zeros(3), even)[0][:, :3].max(1).mean()
    return radiance[:, :3].max(1), density, mean


# Not of worlds that show the camera something else than others, whose light is sampled.
SEEN_ALIKE = {
    name: color
    for name, color in (OF_PICTURES | OTHERS).items()
    if name not in ("for the camera alone", "by the window")
}


@pytest.mark.slow
@pytest.mark.parametrize("color", SEEN_ALIKE.values(), ids=SEEN_ALIKE.keys())
def test_what_is_sampled_follows_the_light_above_its_mean(core, color):
    brightness, density, mean = probe_world(core, color)
    wanted = np.maximum(brightness - mean, 0) + 0.02 * mean
    # Equal where the density follows it; over cells at the box's border the light falls by a factor of 200.
    shares = wanted / density
    assert shares.std() < 0.35 * shares.mean()


@pytest.mark.parametrize("color", [OF_PICTURES["turned"], OTHERS["beside noise"]], ids=["picture", "noise"])
def test_what_is_sampled_adds_up_to_all_light(core, color):
    brightness, density, mean = probe_world(core, color)
    shares = brightness / density
    assert shares.mean() == pytest.approx(mean * 4 * np.pi, abs=4 * shares.std() / np.sqrt(len(shares)))
