"""The table by which the world is sampled is as fine as the world may be, and what it samples adds up."""

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


AS_FINE_AS_THE_PICTURE = {
    "the picture": lambda w: w.seen(),
    "turned": lambda w: w.seen(w.mapped()),
    "turned back, all lengths the same": lambda w: w.seen(w.mapped(scale=(2, 2, 2, 1), text="TEXTURE")),
    "of other colours": lambda w: w.program.operation("gamma", [w.seen(), w.numbers(2.0)]),
    "twice": lambda w: w.mixed(w.seen(), w.seen(w.mapped())),
    "for the camera alone": lambda w: w.program.operation(
        "mix", [w.path(), w.seen(), w.numbers(0.1)], ints=[0, 0], text="MIX"
    ),
}
ANY = {
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


@pytest.mark.parametrize("color", AS_FINE_AS_THE_PICTURE.values(), ids=AS_FINE_AS_THE_PICTURE.keys())
def test_a_world_of_pictures_has_a_table_twice_as_fine(core, color):
    cells = 2 * PICTURE.shape[1] * PICTURE.shape[0] * 2
    assert 4 * cells <= table_bytes(core, color) < 1.3 * 4 * cells


@pytest.mark.parametrize("color", ANY.values(), ids=ANY.keys())
def test_any_other_world_has_the_table_that_was_asked_for(core, color):
    assert table_bytes(core, color) >= 4 * WIDTH * WIDTH // 2


@pytest.mark.parametrize("color", [AS_FINE_AS_THE_PICTURE["turned"], ANY["beside noise"]], ids=["picture", "noise"])
def test_what_is_sampled_has_the_density_that_is_told_and_follows_the_light(core, color):
    world = World(core)
    probe = core.LightProbe(world.scene_of(color(world)))
    random = np.random.default_rng(3).random((20_000, 2)).astype(np.float32).clip(0, np.float32(1 - 2**-24))
    samples = probe.sample(np.zeros(3), random)
    radiance, density = probe.look(np.zeros(3), samples["direction"].astype(float))
    np.testing.assert_allclose(samples["density"], density, rtol=1e-3)
    brightness = radiance[:, :3].max(1)
    # Equal where the density follows the light; over cells at the box's border the light falls by a factor of 200.
    shares = brightness / density
    assert shares.std() < 0.35 * shares.mean()
    even = np.random.default_rng(4).normal(size=(100_000, 3))
    even /= np.linalg.norm(even, axis=1, keepdims=True)
    all_around = probe.look(np.zeros(3), even)[0][:, :3].max(1).mean() * 4 * np.pi
    assert shares.mean() == pytest.approx(all_around, rel=0.03)
