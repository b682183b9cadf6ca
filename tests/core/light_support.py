"""A place that is lit, and numbers and directions to sample light with."""

import numpy as np

POSITION = np.array([0.3, 0.2, -0.4])
NORMAL = np.array([0.1, 0.2, 1.0]) / np.linalg.norm([0.1, 0.2, 1.0])


def random_numbers(count, seed=1):
    return np.random.default_rng(seed).random((count, 2)).astype(np.float32).clip(0, np.float32(1 - 2**-24))


def sphere_directions(count, seed=2):
    r = np.random.default_rng(seed).random((count, 2))
    z, phi = 1 - 2 * r[:, 0], 2 * np.pi * r[:, 1]
    s = np.sqrt(1 - z * z)
    return np.stack([s * np.cos(phi), s * np.sin(phi), z], 1)
