"""A place that is lit, a scene that lights it, and numbers and directions to sample light with."""

import numpy as np
from scenes import emission, look_down, matrix

POSITION = np.array([0.3, 0.2, -0.4])
NORMAL = np.array([0.1, 0.2, 1.0]) / np.linalg.norm([0.1, 0.2, 1.0])


def random_numbers(count, seed=1):
    return np.random.default_rng(seed).random((count, 2)).astype(np.float32).clip(0, np.float32(1 - 2**-24))


def sphere_directions(count, seed=2):
    r = np.random.default_rng(seed).random((count, 2))
    z, phi = 1 - 2 * r[:, 0], 2 * np.pi * r[:, 1]
    s = np.sqrt(1 - z * z)
    return np.stack([s * np.cos(phi), s * np.sin(phi), z], 1)


def emitter_scene(core, add_shape, strength=5.0):
    scene = core.SceneDescription()
    look_down(scene, height=50)
    material = scene.add_material("glow", emission(core, strength=strength))
    scene.add_instance("emitter", add_shape(scene), matrix((0, 0, 1.5)), scene.add_material_list([material]))
    return scene
