"""Makes psychedelic_dragons.blend: 94 dragons that are limits of subdivision, before displaced NURBS spheres.

Every other dragon is chrome. After the folder may follow how many dragons there are; `matte`: all are, and their colours
bleed into one another; `few_spikes`: 94 dragons then have about as many subpatches as those of the geometry cache's paper.
"""

import colorsys
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np

sys.path.append(str(Path(__file__).resolve().parent))
from scene_creatures import FEW_SPIKED, SPIKED, dragon  # noqa: E402
from scene_shapes import table  # noqa: E402
from scene_tools import (  # noqa: E402
    NodeTree,
    add_camera,
    add_lamp,
    add_parts,
    add_surface,
    add_grid,
    arguments,
    color_ramp,
    displace,
    graded_world,
    lathe,
    link,
    make_circle_of_u,
    material,
    matte,
    save,
    start_empty,
)

DRAGONS = 94
COLUMNS = 11
SPACING = 3.4


def vivid(hue: float) -> tuple[float, float, float]:
    """A strong colour."""
    return colorsys.hsv_to_rgb(hue % 1.0, 0.85, 0.85)


def chrome() -> Any:
    """A perfect mirror."""
    made = bpy.data.materials.new("chrome")
    tree = NodeTree(made)
    shader = tree.add("ShaderNodeBsdfGlossy", {"Color": (0.82, 0.83, 0.86, 1), "Roughness": 0.0})
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    return made


def lumpy_paint(name: str, hue: float, scale: float, height: float) -> Any:
    """Bands of colour over hills: one noise paints and displaces."""
    made = bpy.data.materials.new(name)
    tree = NodeTree(made)
    place = tree.add("ShaderNodeTexCoord").outputs["Object"]
    noise = tree.add("ShaderNodeTexNoise", {"Vector": place, "Scale": scale, "Detail": 2.0, "Distortion": 0.3})
    height_of = noise.outputs["Fac"]
    stops = tuple((0.25 + 0.1 * i, vivid(hue + 0.17 * i)) for i in range(6))
    colors = color_ramp(tree, height_of, stops).outputs["Color"]
    shader = tree.add("ShaderNodeBsdfDiffuse", {"Color": colors})
    moved = tree.add("ShaderNodeDisplacement", {"Height": height_of, "Midlevel": 0.5, "Scale": height})
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0], "Displacement": moved.outputs[0]})
    displace(made)
    return made


def add_sphere(name: str, place: tuple[float, float, float], radius: float, look: Any) -> None:
    """A NURBS sphere."""
    half = np.array([(0, -1), (1, -1), (1, 0), (1, 1), (0, 1)], float) * radius
    points = lathe(half)
    points[..., 3] *= np.array([1, np.sqrt(0.5), 1, np.sqrt(0.5), 1])[:, None]
    sphere = add_surface(name, place)
    spline = add_grid(sphere, points, resolution=1)
    make_circle_of_u(spline)
    spline.order_v, spline.use_endpoint_v, spline.use_bezier_v = 3, True, True
    sphere.data.materials.append(look)


def add_dragons(count: int, looks: list[Any], spiked: tuple[int, ...]) -> None:
    """A crowd in rows, each turned and sized a little differently."""
    random = np.random.default_rng(94)
    bodies = []
    for index, bend in enumerate((-0.3, 0.15, 0.35)):
        vertices, faces = dragon(bend, 0.3 * (index - 1), spiked)
        mesh = bpy.data.meshes.new(f"dragon {index}")
        mesh.from_pydata(vertices.tolist(), [], faces)
        mesh.materials.append(None)
        mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
        bodies.append(mesh)
    for index in range(count):
        row, column = divmod(index, COLUMNS)
        shift = 0.5 * (row % 2)
        x = (column + shift - (COLUMNS - 1) / 2) * SPACING + random.normal(0, 0.25)
        thing = link(
            f"dragon {index}", bodies[index % len(bodies)], (x, row * SPACING * 1.3 + random.normal(0, 0.3), 0)
        )
        thing.rotation_euler = (0, 0, np.pi + random.normal(0, 0.7))
        size = random.uniform(0.85, 1.2)
        thing.scale = (size, size, size)
        modifier = thing.modifiers.new("Subdivision", "SUBSURF")
        modifier.levels, modifier.render_levels = 1, 2
        thing.material_slots[0].link = "OBJECT"
        thing.material_slots[0].material = looks[int(random.integers(len(looks)))] if index % 2 else looks[0]


def main() -> None:
    words = arguments()[1:]
    count = next((int(word) for word in words if word.isdigit()), DRAGONS)
    is_matte = "matte" in words
    start_empty(width=960, height=540, samples=8)
    settings = bpy.context.scene.rayleaf
    settings.integrator = "DISTRIBUTION"
    settings.indirect = "COLOR_BLEEDING" if is_matte else "AMBIENT_OCCLUSION"
    settings.light_rays = 1
    hues = np.arange(9) / 9
    if is_matte:
        looks = [matte(f"matte {index}", vivid(hue)) for index, hue in enumerate(hues)]
    else:
        looks = [chrome(), *(material(f"paint {i}", vivid(hue), 0.5) for i, hue in enumerate(hues))]
    add_dragons(count, looks, FEW_SPIKED if "few_spikes" in words else SPIKED)
    depth = (count // COLUMNS + 1) * SPACING * 1.3
    for index, x in enumerate((-21.0, -7.0, 8.0, 22.0)):
        place = (x, depth + 6.0 + 2.5 * (index % 2), 5.5)
        add_sphere(f"hill {index}", place, 6.5, lumpy_paint(f"hills {index}", 0.23 * index, 0.35, 3.0))
    ground = add_parts("ground", [table(400.0)])
    ground.data.materials.append(matte("ground", (0.45, 0.2, 0.5)))
    graded_world("sky", ((0.0, (1.0, 0.6, 0.25)), (0.25, (0.9, 0.35, 0.6)), (0.7, (0.2, 0.25, 0.8))), 0.6)
    add_lamp("sun", "SUN", (-14, -12, 20), (0, 0, 0), 2.6, (1.0, 0.93, 0.82)).data.angle = 0.02
    add_camera((1.5, -11.5, 6.2), (0.0, 9.0, 2.0), 30)
    save("psychedelic_dragons")


main()
