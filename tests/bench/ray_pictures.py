"""Whole pictures with ray interpolation off, by probe, and on: what is left of the gain when everything is counted.

Path tracing in a smooth world, one thread, its processor time for everything from committing the scene to the last pixel.
`first`: nothing is held. `again`: the caches of the first picture are kept. `later`: those of nine pictures, of one seed.
"""

import time
from typing import Any

import numpy as np
from ray_frames import Camera, Picture
from ray_scenes import Object, Scene, chaotic_glass, gentle_glass, mirror_sheet, random_volumes, tomatoes
from rayleaf import _core

MODES = ("OFF", "AUTO", "ON")
SAMPLES = 4
SEEDS = 3
KEPT_FRAMES = 10


def world() -> Any:
    """Brighter towards one side, without any edge."""
    program = _core.Program("world")
    direction = program.operation("generated")
    scaled = program.operation("vector_math", [direction, program.constant(0.4, 0.2, 0.1, 0)], text="MULTIPLY")
    color = program.operation("vector_math", [scaled, program.constant(0.5, 0.5, 0.5, 0)], text="ADD")
    program.operation("background", [program.constant(1, 1, 1, 1), color, program.constant(1, 1, 1, 1)])
    return program


def material(scene: Any, each: Object) -> int:
    """What an object is made of."""
    program = _core.Program(each.kind)

    def number(value: float) -> Any:
        return program.constant(value, value, value, 1)

    color = program.constant(*each.color, 1)
    if each.kind == "SIMPLE":
        program.operation("diffuse", [number(1), color])
    elif each.kind == "GLASS":
        program.operation("glass", [number(1), color, number(0), number(each.ior)], text="SHARP")
    elif each.kind == "MIRROR":
        program.operation("glossy", [number(1 - each.transparency), color, number(0)], text="SHARP")
        if each.transparency:
            program.operation("transparent", [number(each.transparency), number(1)])
    volume = _core.VolumeVisualisation(density=0.2) if each.kind == "VOLUME" else None
    made: int = scene.add_material_list([scene.add_material(each.kind, program, volume=volume)])
    return made


def description(scene: Scene, picture: Picture) -> Any:
    """The scene as the renderer takes it, seen as in the frames of the benchmark."""
    made = _core.SceneDescription()
    for index, each in enumerate(scene.objects):
        made.add_instance(f"object {index}", made.add_shape(each.surface), np.eye(4), material(made, each))
    made.set_world(world(), 32)
    camera = Camera(scene, picture, 0.0)
    right, up = (axis / np.linalg.norm(axis) for axis in (camera.right, camera.up))
    matrix = np.eye(4)
    matrix[:3] = np.stack([right, up, np.cross(right, up), camera.eye], axis=1)
    half = scene.width / 2
    window = (half, half * picture.height / picture.width)
    made.set_camera("PERSPECTIVE", matrix, (-window[0], -window[1]), window, 0.01, 1000.0)
    return made


def seconds(scene: Scene, picture: Picture, mode: str, store: Any, seed: int = 0) -> tuple[float, dict[str, Any], Any]:
    """A picture's processor time, statistics and pixels."""
    settings = _core.Settings(
        width=picture.width,
        height=picture.height,
        samples=SAMPLES,
        threads=1,
        seed=seed,
        passes=["combined"],
        ray_interpolation=_core.RayInterpolation(mode=mode),
    )
    session = _core.Session(description(scene, picture), settings, store)
    begin = time.process_time()
    assert session.render()
    return time.process_time() - begin, session.statistics(), session.pass_pixels("combined")[..., :3]


def print_pictures(side: int) -> None:
    """A line a scene and mode."""
    print(
        f"\nWhole pictures, {side} x {side}, {SAMPLES} samples: seconds and speed-up over off; used: objects with a cache"
    )
    print(
        f"  {'':<30}{'mode':<6}{'first':>8}{'again':>8}{'x first':>9}{'x again':>9}{'x later':>9}{'used':>6}{'mean change':>13}"
    )
    for scene in (
        mirror_sheet(),
        random_volumes(),
        gentle_glass(),
        chaotic_glass(),
        random_volumes("VOLUME"),
        tomatoes(),
    ):
        times: dict[str, list[list[float]]] = {mode: [] for mode in MODES}
        truth: Any = None
        shown: dict[str, tuple[int, float]] = {}
        later: dict[str, float] = {}
        for seed in range(SEEDS):
            for mode in MODES:  # by turns, so that a busy machine slows all
                store, spent = _core.RayCacheStore(), []
                # Without caches one picture costs what the other does.
                for _ in range(KEPT_FRAMES if seed == 0 and mode != "OFF" else 2):
                    taken, statistics, pixels = seconds(scene, Picture(side, side), mode, store, seed)
                    spent.append(taken)
                    store.next_frame()
                times[mode].append(spent[:2])
                later.setdefault(mode, spent[-1])
                if seed > 0:
                    continue
                truth = pixels if mode == "OFF" else truth
                used = sum(bool(each["used"]) for each in statistics.get("ray_caches", []))
                shown[mode] = used, float(np.abs(pixels - truth).mean() / truth.mean())
        off = float(np.median(times["OFF"]))
        for mode in MODES:
            first, again = (float(np.median(column)) for column in zip(*times[mode]))
            print(
                f"  {scene.name:<30}{mode:<6}{first:>8.2f}{again:>8.2f}{off / first:>9.2f}{off / again:>9.2f}"
                f"{off / later[mode]:>9.2f}{shown[mode][0]:>6}{shown[mode][1]:>12.2%}",
                flush=True,
            )
