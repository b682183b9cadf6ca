"""What the scripts that make the scenes share. Each is run as:

blender -b --factory-startup --addons rayleaf --python blend_scenes/make_NAME.py [-- FOLDER]

and writes NAME.blend to FOLDER, by default to the folder of the script. Scenes made by chance take a seed after FOLDER.
"""

import shutil
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import addon_utils
import bpy
import numpy as np
from mathutils import Vector
from numpy.typing import NDArray

HERE = Path(__file__).resolve().parent
sys.path.append(str(HERE))
from scene_shapes import Part, bezier_from_cubic_b_spline  # noqa: E402, F401

Triple = Sequence[float]
# Blender's name of scene-linear colours.
LINEAR = "Linear" if bpy.app.version < (4, 0, 0) else "Linear Rec.709"
# The Principled shader's inputs that Blender 4 names otherwise.
_LATER_NAMES = {
    "Clearcoat": "Coat Weight",
    "Clearcoat Roughness": "Coat Roughness",
    "Specular": "Specular IOR Level",
    "Transmission": "Transmission Weight",
}


def start_empty(width: int, height: int, samples: int) -> None:
    """Leave nothing of the startup file, and set what every scene sets."""
    bpy.data.batch_remove(
        [*bpy.data.objects, *bpy.data.meshes, *bpy.data.materials, *bpy.data.lights, *bpy.data.cameras]
    )
    bpy.data.batch_remove(list(bpy.data.collections))
    scene = bpy.context.scene
    scene.render.engine = "RAYLEAF"
    scene.rayleaf.samples = samples
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.filepath = "//"
    scene.view_settings.view_transform = "Standard"
    layer = bpy.context.view_layer
    layer.use_pass_z = layer.use_pass_normal = True


def arguments() -> list[str]:
    """What follows `--`: FOLDER SEED."""
    return sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else []


def seed_argument(default: int) -> int:
    """The seed of a scene made by chance."""
    return int(arguments()[1]) if len(arguments()) > 1 else default


def save(name: str) -> None:
    """Write NAME.blend, compressed. By way of a temporary folder: a .blend remembers the path it was saved to."""
    folder = Path(arguments()[0]) if arguments() else HERE
    with tempfile.TemporaryDirectory() as temporary:
        path = Path(temporary) / f"{name}.blend"
        bpy.ops.wm.save_as_mainfile(filepath=str(path), compress=True, relative_remap=False)
        shutil.copyfile(path, folder / path.name)


def link(name: str, data: Any, location: Triple = (0, 0, 0)) -> Any:
    """A new object in the scene."""
    thing = bpy.data.objects.new(name, data)
    thing.location = location
    bpy.context.scene.collection.objects.link(thing)
    return thing


def look_at(thing: Any, target: Triple) -> None:
    """Turn a camera or lamp towards a point of the world."""
    direction = Vector(target) - thing.location
    thing.rotation_euler = direction.to_track_quat("-Z", "Y").to_euler()


def add_camera(location: Triple, target: Triple, lens: float) -> Any:
    """The scene's camera; `lens` in millimetres on Blender's 36 mm sensor."""
    data = bpy.data.cameras.new("Camera")
    data.lens = lens
    camera = link("Camera", data, location)
    look_at(camera, target)
    bpy.context.scene.camera = camera
    return camera


def add_lamp(name: str, kind: str, location: Triple, target: Triple, power: float, color: Triple = (1, 1, 1)) -> Any:
    """kind: POINT, SPOT, AREA (power in watts) or SUN (W/m²)."""
    data = bpy.data.lights.new(name, kind)
    data.energy = power
    data.color = color
    lamp = link(name, data, location)
    look_at(lamp, target)
    return lamp


def add_floor(name: str, low: tuple[float, float], high: tuple[float, float], look: Any) -> Any:
    """A rectangle at z = 0."""
    mesh = bpy.data.meshes.new(name)
    corners = [(low[0], low[1], 0), (high[0], low[1], 0), (high[0], high[1], 0), (low[0], high[1], 0)]
    mesh.from_pydata(corners, [], [(0, 1, 2, 3)])
    mesh.materials.append(look)
    return link(name, mesh)


def light_gallery(eye: Triple, target: Triple, width: float) -> None:
    """Floor, light and camera of a gallery of small labelled things; `width` of the picture, in the scene's units."""
    add_floor("floor", (-40, -40), (40, 60), material("floor", (0.62, 0.62, 0.64), 0.5))
    plain_world((0.75, 0.85, 1.0), 0.5)
    key = add_lamp("key", "AREA", (-11, -3, 15), (0, 0, 0), 2800, (1.0, 0.95, 0.88))
    key.data.shape, key.data.size = "DISK", 5
    camera = add_camera(eye, target, 50)
    camera.data.type, camera.data.ortho_scale = "ORTHO", width


# --- surfaces ------------------------------------------------------------------------------------------------------


def add_surface(name: str, location: Triple = (0, 0, 0)) -> Any:
    """An empty SURFACE object, for `add_grid`."""
    data = bpy.data.curves.new(name, "SURFACE")
    data.dimensions = "3D"
    return link(name, data, location)


def add_grid(surface: Any, points: NDArray[np.float64], resolution: int = 4) -> Any:
    """Append a NURBS grid; points (count_v, count_u, 4): x, y, z, weight, at least three each way.

    Set flags and orders on the spline returned.
    """
    with _edit(surface):
        _join_rows(surface, points)
    spline = surface.data.splines[-1]
    spline.resolution_u = spline.resolution_v = resolution
    return spline


@contextmanager
def _edit(surface: Any) -> Iterator[None]:
    """In Edit Mode of an object; its splines are others before, within and after."""
    bpy.context.view_layer.objects.active = surface
    bpy.ops.object.mode_set(mode="EDIT")
    try:
        yield
    finally:
        bpy.ops.object.mode_set(mode="OBJECT")


def _join_rows(surface: Any, points: NDArray[np.float64]) -> Any:
    """A new grid of a surface in Edit Mode.

    Blender's data interface makes only rows of points; the operator that joins selected rows makes the grid, and shuffles
    the points, so their coordinates come last. It also evaluates all of the object, so the resolution is low until the end.
    """
    count_v, count_u = points.shape[:2]
    for row in range(count_u):
        spline = surface.data.splines.new("NURBS")
        spline.points.add(count_v - 1)
        apart = np.array([[row, 0.01 * i, 0, 1] for i in range(count_v)], dtype=np.float64)
        spline.points.foreach_set("co", apart.ravel())
        spline.points.foreach_set("select", [True] * count_v)
        spline.resolution_u = spline.resolution_v = 1
    bpy.ops.curve.make_segment()
    spline = surface.data.splines[-1]
    if (spline.point_count_u, spline.point_count_v) != (count_u, count_v):
        raise RuntimeError(f"{surface.name}: Blender made a grid of {spline.point_count_u} x {spline.point_count_v}")
    spline.points.foreach_set("co", points.astype(np.float64).ravel())
    spline.points.foreach_set("select", [False] * len(spline.points))
    spline.resolution_u = spline.resolution_v = 1
    spline.use_smooth = True
    return spline


def add_parts(name: str, parts: Sequence[Part], location: Triple = (0, 0, 0), resolution: int = 4) -> Any:
    """A SURFACE object of parts (scene_shapes.py)."""
    surface = add_surface(name, location)
    with _edit(surface):
        for part in parts:
            spline = _join_rows(surface, part.points)
            spline.order_u, spline.use_cyclic_u, spline.use_endpoint_u, spline.use_bezier_u = part.u
            spline.order_v, spline.use_cyclic_v, spline.use_endpoint_v, spline.use_bezier_v = part.v
    for spline in surface.data.splines:
        spline.resolution_u = spline.resolution_v = resolution
    return surface


# Clockwise seen from above: with v upwards, Blender's outside is then away from the axis.
CIRCLE = ((1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1), (0, 1), (1, 1))


def lathe(profile: NDArray[np.float64]) -> NDArray[np.float64]:
    """Control points of a profile (n, 2: radius, height) turned about z; v runs along the profile, u around.

    Around, it is Blender's exact circle: eight points, order 3, cyclic, with the bezier and endpoint flags (without the
    latter the arcs would begin at the corners, and the circle be a rounded square); corners weigh 1/√2.
    """
    grid = np.empty((len(profile), 8, 4))
    for index, (x, y) in enumerate(CIRCLE):
        grid[:, index, 0] = profile[:, 0] * x
        grid[:, index, 1] = profile[:, 0] * y
        grid[:, index, 2] = profile[:, 1]
        grid[:, index, 3] = np.sqrt(0.5) if index % 2 else 1.0
    return grid


def make_circle_of_u(spline: Any) -> None:
    """The flags that `lathe` counts on."""
    spline.use_cyclic_u = spline.use_bezier_u = spline.use_endpoint_u = True
    spline.order_u = 3


# --- materials -----------------------------------------------------------------------------------------------------


class NodeTree:
    """Builds a node tree: `tree.add("ShaderNodeMix", input=value or a socket)`."""

    def __init__(self, owner: Any) -> None:
        owner.use_nodes = True
        self.tree = owner.node_tree
        self.tree.nodes.clear()

    def add(self, kind: str, inputs: dict[str | int, Any] | None = None, **properties: Any) -> Any:
        """A node; an input given as a socket is linked, another value is its default. Names are those of Blender 3."""
        node = self.tree.nodes.new(kind)
        node.location = (220 * len(self.tree.nodes), 0)
        for name, value in properties.items():
            setattr(node, name, value)
        renamed = _LATER_NAMES if kind == "ShaderNodeBsdfPrincipled" and bpy.app.version >= (4, 0, 0) else {}
        for key, value in (inputs or {}).items():
            socket = node.inputs[renamed.get(key, key) if isinstance(key, str) else key]
            if isinstance(value, bpy.types.NodeSocket):
                self.tree.links.new(value, socket)
            else:
                socket.default_value = value
        return node


def material(name: str, color: Triple = (0.8, 0.8, 0.8), roughness: float = 0.5, **inputs: Any) -> Any:
    """A material with the Principled shader; further inputs by their names in Blender 3, `_` for a space."""
    made = bpy.data.materials.new(name)
    tree = NodeTree(made)
    values: dict[str | int, Any] = {"Base Color": (*color, 1), "Roughness": roughness}
    values |= {key.replace("_", " "): value for key, value in inputs.items()}
    shader = tree.add("ShaderNodeBsdfPrincipled", values)
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    made.diffuse_color = (*color, 1)
    return made


def displace(made: Any) -> None:
    """Have a material's displacement move points; as Blender makes it, it bends normals alone."""
    if hasattr(made, "displacement_method"):  # 4.1
        made.displacement_method = "DISPLACEMENT"
    else:
        addon_utils.enable("cycles")
        made.cycles.displacement_method = "DISPLACEMENT"


def matte(name: str, color: Triple) -> Any:
    """A material that scatters light evenly, and nothing else."""
    made = bpy.data.materials.new(name)
    tree = NodeTree(made)
    shader = tree.add("ShaderNodeBsdfDiffuse", {"Color": (*color, 1)})
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    made.diffuse_color = (*color, 1)
    return made


def glass(name: str, color: Triple, ior: float) -> Any:
    """Clear glass with a tint."""
    made = bpy.data.materials.new(name)
    tree = NodeTree(made)
    shader = tree.add("ShaderNodeBsdfGlass", {"Color": (*color, 1), "Roughness": 0.0, "IOR": ior})
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    return made


def checkered(name: str, light: Triple, dark: Triple, scale: float, roughness: float) -> Any:
    """A floor whose checks show what glass before it does to them; it must lie at z = 0."""
    made = bpy.data.materials.new(name)
    tree = NodeTree(made)
    position = tree.add("ShaderNodeTexCoord").outputs["Object"]
    # From z = 0 half a check up: rounding must not choose between two layers of checks.
    above = tree.add("ShaderNodeMapping", {"Vector": position, "Location": (0, 0, 0.5)}).outputs[0]
    colors = {"Vector": above, "Color1": (*light, 1), "Color2": (*dark, 1), "Scale": scale}
    checker = tree.add("ShaderNodeTexChecker", colors)
    inputs = {"Base Color": checker.outputs["Color"], "Roughness": roughness}
    shader = tree.add("ShaderNodeBsdfPrincipled", inputs)
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    return made


def color_ramp(tree: NodeTree, factor: Any, stops: Sequence[tuple[float, Triple]]) -> Any:
    """A colour ramp node with these stops."""
    node = tree.add("ShaderNodeValToRGB", {"Fac": factor})
    elements = node.color_ramp.elements
    while len(elements) < len(stops):
        elements.new(0.5)
    for element, (position, color) in zip(elements, stops):
        element.position = position
        element.color = (*color, 1)
    return node


def pack_image(name: str, pixels: NDArray[np.float64], color_space: str) -> Any:
    """An image data-block with these pixels, rows bottom to top, packed into the file."""
    height, width = pixels.shape[:2]
    image = bpy.data.images.new(name, width, height, alpha=False, float_buffer=color_space == LINEAR)
    image.colorspace_settings.name = color_space
    rgba = np.concatenate([pixels, np.ones((height, width, 1))], axis=2)
    image.pixels.foreach_set(rgba.astype(np.float32).ravel())
    image.pack()
    return image


def plain_world(color: Triple, strength: float = 1.0) -> None:
    """A world of one colour."""
    world = bpy.data.worlds.new("World")
    bpy.context.scene.world = world
    tree = NodeTree(world)
    background = tree.add("ShaderNodeBackground", {"Color": (*color, 1), "Strength": strength})
    tree.add("ShaderNodeOutputWorld", {"Surface": background.outputs[0]})


def graded_world(name: str, stops: Sequence[tuple[float, Triple]], strength: float) -> None:
    """A world whose colour goes with the height above the horizon, from 0 to 1 overhead."""
    world = bpy.data.worlds.new(name)
    bpy.context.scene.world = world
    tree = NodeTree(world)
    direction = tree.add("ShaderNodeTexCoord").outputs["Generated"]
    height = tree.add("ShaderNodeSeparateXYZ", {"Vector": direction}).outputs["Z"]
    colors = color_ramp(tree, height, stops).outputs["Color"]
    background = tree.add("ShaderNodeBackground", {"Color": colors, "Strength": strength})
    tree.add("ShaderNodeOutputWorld", {"Surface": background.outputs[0]})


def painted_sky() -> bpy.types.Material:
    """Light by itself: warped bands of colour from noise, with a checkerboard in them."""
    made = bpy.data.materials.new("painted sky")
    tree = NodeTree(made)
    position = tree.add("ShaderNodeTexCoord").outputs["Object"]
    placed = tree.add("ShaderNodeMapping", {"Vector": position, "Scale": (0.05, 0.05, 0.09)}).outputs[0]
    noise = tree.add("ShaderNodeTexNoise", {"Vector": placed, "Scale": 1.3, "Detail": 3.0, "Distortion": 0.6})
    stops = (
        (0.28, (0.01, 0.03, 0.12)),
        (0.42, (0.02, 0.22, 0.38)),
        (0.5, (0.75, 0.82, 0.7)),
        (0.58, (0.95, 0.42, 0.08)),
        (0.74, (0.3, 0.02, 0.04)),
    )
    bands = color_ramp(tree, noise.outputs["Fac"], stops).outputs["Color"]
    checker_inputs = {"Vector": position, "Color1": (1, 1, 1, 1), "Color2": (0.35, 0.35, 0.35, 1), "Scale": 0.16}
    checker = tree.add("ShaderNodeTexChecker", checker_inputs).outputs["Color"]
    paint = tree.add("ShaderNodeMixRGB", {"Fac": 1.0, "Color1": bands, "Color2": checker}, blend_type="MULTIPLY")
    shader = tree.add("ShaderNodeEmission", {"Color": paint.outputs[0], "Strength": 1.1})
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    return made
