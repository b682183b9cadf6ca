"""Makes garden.blend: a hundred thousand plants of splines, each kind modelled once and instanced by faces of a mesh.

Tufts of grass and stems are bevelled curves, petals and leaves bicubic patches. After the folder may follow the number
of plants.
"""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

sys.path.append(str(Path(__file__).resolve().parents[2] / "blend_scenes"))
from scene_curves import add_bezier, add_curve  # noqa: E402
from scene_shapes import BEZIER, Part, with_weights  # noqa: E402
from scene_tools import (  # noqa: E402
    add_camera,
    add_grid,
    add_lamp,
    add_parts,
    add_surface,
    arguments,
    graded_world,
    link,
    material,
    save,
    start_empty,
)

Doubles = NDArray[np.float64]
PLANTS = 100_000
SIDE = 30.0  # of the garden, metres


@dataclass(frozen=True)
class Kind:
    """How many of all plants, and how large; heights vary by a third."""

    share: float
    size: float  # of what is modelled about one unit high
    patches: float  # how much plants of a kind stand together, 0 to 1


KINDS = {
    "grass": Kind(0.72, 0.2, 0.2),
    "daisy": Kind(0.19, 0.3, 0.8),
    "fern": Kind(0.085, 0.5, 0.6),
    "sapling": Kind(0.005, 2.2, 0.3),
}


def ground_height(x: Doubles, y: Doubles) -> Doubles:
    """Gentle hills."""
    return 0.7 * np.sin(0.23 * x + 0.6) * np.cos(0.19 * y) + 0.25 * np.sin(0.7 * x - 0.5 * y) + 0.02 * y


def add_ground() -> None:
    """One smooth surface under all."""
    x, y = np.meshgrid(*[np.linspace(-SIDE, SIDE, 60)] * 2)
    surface = add_surface("ground")
    spline = add_grid(surface, with_weights(np.stack([x, y, ground_height(x, y)], axis=-1)), resolution=2)
    spline.order_u = spline.order_v = 4
    surface.data.materials.append(material("soil", (0.16, 0.1, 0.05), 0.9, Specular=0.1))


# --- plants, about one unit high -----------------------------------------------------------------------------------


def stalk(name: str, color: tuple[float, float, float], depth: float) -> Any:
    """A bevelled curve without splines."""
    curve = add_curve(name, bevel_depth=depth, bevel_resolution=1, resolution_u=4, use_fill_caps=True)
    curve.data.materials.append(material(name, color, 0.6, Specular=0.3))
    return curve


def leaf(root: Doubles, along: Doubles, across: Doubles, sag: float) -> Part:
    """A bicubic patch that narrows at both ends, and hangs."""
    t = np.linspace(0, 1, 4)
    width = np.array([0.15, 1.1, 1.0, 0.0])
    points = root + t[:, None, None] * along + (width[:, None] * np.linspace(-1, 1, 4))[..., None] * across
    fold = 0.25 * np.linalg.norm(across) * np.abs(np.linspace(-1, 1, 4))
    points[..., 2] += fold * width[:, None] - sag * (t**2)[:, None]
    return Part(with_weights(points), BEZIER, BEZIER)


def turned_about_z(angle: float) -> tuple[Doubles, Doubles]:
    """Outwards and sideways."""
    return np.array([np.cos(angle), np.sin(angle), 0]), np.array([-np.sin(angle), np.cos(angle), 0])


def grass(random: np.random.Generator) -> list[Any]:
    """Blades that bend outwards and end in a point."""
    tuft = stalk("grass", (0.1, 0.3, 0.04), 0.02)
    for angle in random.uniform(0, 2 * np.pi, 16):
        out, _ = turned_about_z(angle)
        bend, tall = random.uniform(0.15, 0.6), random.uniform(0.6, 1.2)
        root = out * random.uniform(0, 0.12)
        points = [root, root + out * bend * 0.3 + (0, 0, 0.6 * tall), root + out * bend + (0, 0, tall)]
        add_bezier(tuft, np.array(points), radii=(1.0, 0.7, 0.05))
    return [tuft]


def daisy(random: np.random.Generator) -> list[Any]:
    """A stem, and a bloom on it."""
    stem = stalk("daisy stem", (0.12, 0.32, 0.06), 0.018)
    add_bezier(stem, np.array([(0, 0, 0), (0.06, 0.02, 0.5), (0.0, 0.0, 1.0)]), radii=(1.2, 1.0, 0.8))
    petals = []
    for index in range(14):
        out, side = turned_about_z(index / 14 * 2 * np.pi + random.normal(0, 0.04))
        petals.append(leaf(np.array([0, 0, 1.0]) + 0.03 * out, 0.26 * out + (0, 0, 0.03), 0.045 * side, -0.02))
    bloom = add_parts("daisy bloom", petals, resolution=3)
    bloom.data.materials.append(material("petal", (0.85, 0.83, 0.88), 0.7))
    return [stem, bloom]


def fern(random: np.random.Generator) -> list[Any]:
    """Fronds of small leaves."""
    stem, leaves = stalk("fern stem", (0.14, 0.22, 0.05), 0.012), []
    for frond in range(7):
        out, side = turned_about_z(frond / 7 * 2 * np.pi + random.normal(0, 0.2))
        points = np.array([(0, 0, 0), 0.35 * out + (0, 0, 0.55), 1.0 * out + (0, 0, random.uniform(0.4, 0.7))])
        add_bezier(stem, points, radii=(1.0, 0.7, 0.2))
        for t in np.linspace(0.25, 0.95, 8):
            middle = points[1] * 2 * t * (1 - t) + points[2] * t * t
            for hand in (-1, 1):
                along = (side * hand * 0.9 + out * 0.5) * 0.28 * (1.1 - t)
                leaves.append(leaf(middle, along, 0.05 * out, 0.05))
    green = add_parts("fern leaves", leaves, resolution=2)
    green.data.materials.append(material("fern", (0.07, 0.26, 0.05), 0.5))
    return [stem, green]


def sapling(random: np.random.Generator) -> list[Any]:
    """A trunk with branches, and their leaves."""
    trunk, leaves = stalk("bark", (0.2, 0.13, 0.08), 0.03), []
    add_bezier(trunk, np.array([(0, 0, 0), (0.03, 0.02, 0.5), (0, 0, 1.05)]), radii=(1.2, 0.8, 0.2))
    for branch in range(12):
        out, side = turned_about_z(branch * 2.4)
        low = np.array([0, 0, 0.35 + 0.05 * branch])
        reach = 0.5 * (1.25 - low[2])
        points = np.array([low, low + 0.5 * reach * out + (0, 0, 0.1), low + reach * out + (0, 0, 0.16)])
        add_bezier(trunk, points, radii=(0.5, 0.3, 0.1))
        for t in np.linspace(0.3, 1.0, 8):
            place = low + t * reach * out + (0, 0, 0.16 * t)
            along = out * random.normal(0, 0.08) + side * random.choice((-1, 1)) * 0.12 + (0, 0, random.normal(0, 0.03))
            leaves.append(leaf(place, along, 0.035 * out, 0.03))
    green = add_parts("sapling leaves", leaves, resolution=2)
    green.data.materials.append(material("foliage", (0.16, 0.34, 0.06), 0.45))
    return [trunk, green]


MAKERS = {"grass": grass, "daisy": daisy, "fern": fern, "sapling": sapling}


# --- where they stand ----------------------------------------------------------------------------------------------


def places(random: np.random.Generator, count: int, together: float) -> Doubles:
    """Points (count, 2) of the garden, off the path that winds through it."""
    found = np.empty((0, 2))
    while len(found) < count:
        tried = random.uniform(-SIDE / 2, SIDE / 2, (2 * count, 2))
        x, y = tried.T
        crowd = np.sin(1.1 * x + 2 * np.sin(0.5 * y)) * np.sin(0.9 * y + 1.5 * np.sin(0.6 * x) + count)
        wanted = (1 - together) + together * np.clip(2 * crowd, 0, 1)
        off_path = np.abs(x - 1.2 * np.sin(0.4 * y)) > 0.6
        found = np.concatenate([found, tried[off_path & (random.uniform(size=len(x)) < wanted)]])
    return found[:count]


def scatter(random: np.random.Generator, name: str, count: int, kind: Kind, plants: list[Any]) -> None:
    """Instances of `plants`, one for each square of a mesh: its size is the plant's, its first side the plant's x."""
    place = places(random, count, kind.patches)
    size = kind.size * random.uniform(0.7, 1.3, count)
    angle = random.uniform(0, 2 * np.pi, count)
    middle = np.column_stack([place, ground_height(*place.T)])
    out = np.stack([np.cos(angle), np.sin(angle), np.zeros(count)], axis=1) * size[:, None] / 2
    side = np.stack([-out[:, 1], out[:, 0], np.zeros(count)], axis=1)
    corners = np.stack([middle - out - side, middle + out - side, middle + out + side, middle - out + side], axis=1)
    mesh = bpy.data.meshes.new(f"places of {name}")
    mesh.from_pydata(corners.reshape(-1, 3).tolist(), [], np.arange(4 * count).reshape(-1, 4).tolist())
    owner = link(mesh.name, mesh)
    owner.instance_type, owner.use_instance_faces_scale = "FACES", True
    owner.show_instancer_for_render = owner.show_instancer_for_viewport = False
    for plant in plants:
        plant.parent = owner


def main() -> None:
    words = arguments()[1:]
    total = int(words[0]) if words else PLANTS
    random = np.random.default_rng(23)
    start_empty(width=960, height=540, samples=16)
    add_ground()
    for name, kind in KINDS.items():
        scatter(random, name, max(1, round(kind.share * total)), kind, MAKERS[name](random))
    graded_world("sky", ((0.0, (0.8, 0.85, 0.9)), (0.4, (0.35, 0.55, 0.9)), (1.0, (0.12, 0.28, 0.65))), 0.8)
    add_lamp("sun", "SUN", (-6, -3, 8), (0, 0, 0), 3.5, (1.0, 0.93, 0.8)).data.angle = 0.01
    add_camera((0.6, -14.5, 1.7), (0.0, -4.0, 0.3), 28)
    save("garden")


main()
