"""Runs inside Blender: Cycles renders nodes, the core computes them at the very points Cycles hit.

Each case is a node whose result shines from a square of its own; one picture holds them all. A second picture, with a
material that shines by position, tells where each sample hit: at equal seeds Cycles hits the same points.

An input named "x", "y", "z" or "p" is linked to the square's coordinate: x, y in [-2, 2], z a constant; "kelvins" and
"nanometres" to temperatures and wavelengths beyond both ends of what is defined; "direction" to unit vectors around x.
"""

import math
import sys
from typing import Any

import bpy
import numpy as np
from oracle_case import Case, described
from rayleaf import _core
from rayleaf.export.images import ImageLibrary
from rayleaf.export.nodes.compiler import Compiler
from rayleaf.export.nodes.resources import Resources
from rayleaf.export.nodes.emitter import Emitter
from rayleaf.export.nodes.trees import shader_tree
from rayleaf.messages import Messages, Subject

PIXELS = 24  # a square's side on the picture
OFFSET = 4.0  # added to results, for the picture to hold negative ones


def build_material(case: Any, center: tuple[float, float]) -> tuple[Any, Any]:
    """A material that shines by the case's output, plus the offset; and that output."""
    material = bpy.data.materials.new(case.name[:60])
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    position = tree.nodes.new("ShaderNodeNewGeometry").outputs["Position"]
    local = tree.nodes.new("ShaderNodeVectorMath")
    local.operation = "MULTIPLY_ADD"  # the squares are 1 wide: p = 4 (position - center), z = 0.37
    tree.links.new(position, local.inputs[0])
    local.inputs[1].default_value = (4.0, 4.0, 4.0)
    local.inputs[2].default_value = (-4.0 * center[0], -4.0 * center[1], 0.37)
    separate = tree.nodes.new("ShaderNodeSeparateXYZ")
    tree.links.new(local.outputs[0], separate.inputs[0])
    scaled = {}
    for name, factor, middle in (("kelvins", 3300.0, 6500.0), ("nanometres", 110.0, 580.0)):
        scaled[name] = tree.nodes.new("ShaderNodeMath")
        scaled[name].operation = "MULTIPLY_ADD"
        tree.links.new(separate.outputs[0], scaled[name].inputs[0])
        scaled[name].inputs[1].default_value, scaled[name].inputs[2].default_value = factor, middle
    sources = {name: node.outputs[0] for name, node in scaled.items()}
    sources |= {"p": local.outputs[0], **{name: separate.outputs[i] for i, name in enumerate("xyz")}}

    turned, unit = tree.nodes.new("ShaderNodeCombineXYZ"), tree.nodes.new("ShaderNodeVectorMath")
    unit.operation = "NORMALIZE"
    for target, axis in enumerate((1, 2, 0)):
        tree.links.new(separate.outputs[axis], turned.inputs[target])
    tree.links.new(turned.outputs[0], unit.inputs[0])
    sources["direction"] = unit.outputs[0]

    result = case.add(tree, sources)
    shifted = tree.nodes.new("ShaderNodeVectorMath")
    tree.links.new(result, shifted.inputs[0])
    shifted.inputs[1].default_value = (OFFSET, OFFSET, OFFSET)
    emission, output = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(shifted.outputs[0], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    return material, result


def render(path: str, override: Any) -> Any:
    """The picture as an array, rows bottom to top."""
    scene = bpy.context.scene
    bpy.context.view_layer.material_override = override
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
    image = bpy.data.images.load(path)
    image.colorspace_settings.name = "Non-Color"
    pixels = np.empty(image.size[0] * image.size[1] * 4, np.float32)
    image.pixels.foreach_get(pixels)
    return pixels.reshape(image.size[1], image.size[0], 4)[..., :3].astype(np.float64)


def set_up(columns: int, rows: int) -> None:
    """An orthographic camera over columns x rows unit squares, one sample a pixel."""
    scene = bpy.context.scene
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    camera.data.type = "ORTHO"
    camera.data.ortho_scale = max(columns, rows)
    camera.location = (columns / 2, rows / 2, 5)
    scene.collection.objects.link(camera)
    scene.camera = camera
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 1
    scene.cycles.use_adaptive_sampling = False
    scene.cycles.use_denoising = False
    scene.cycles.pixel_filter_type = "BOX"
    scene.cycles.filter_width = 0.01
    scene.render.resolution_x, scene.render.resolution_y = columns * PIXELS, rows * PIXELS
    scene.render.resolution_percentage = 100
    settings = scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth = "OPEN_EXR", "RGB", "32"
    settings.exr_codec = "ZIP"
    if hasattr(scene.cycles, "use_light_tree"):
        scene.cycles.use_light_tree = False


def add_square(x: float, y: float, material: Any) -> None:
    """A unit square with its corner at (x, y)."""
    mesh = bpy.data.meshes.new("Square")
    mesh.from_pydata([(x, y, 0), (x + 1, y, 0), (x + 1, y + 1, 0), (x, y + 1, 0)], [], [(0, 1, 2, 3)])
    mesh.materials.append(material)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("Square", mesh))


class TextureOnlyScene:
    """Stands for the scene that images are added to."""

    def __init__(self) -> None:
        self.store = _core.shading.TextureStore(1 << 26)

    def add_image_pixels(self, name: str, pixels: Any, space: str, config: str = "", alpha: str = "OPACITY") -> int:
        """Pass pixels on."""
        return int(self.store.add_pixels(name, pixels, getattr(_core.shading.ColorSpace, space)))


def core_picture(material: Any, positions: Any) -> Any:
    """The core's result at the positions, by the add-on's compiler."""
    scene, messages = TextureOnlyScene(), Messages()
    resources = Resources(lambda name: 0, ImageLibrary(_core, scene, messages), 1)
    emitter = Emitter(_core, material.name)
    with shader_tree(material) as tree:
        Compiler(emitter, Subject("Material", material.name), resources, messages).compile_tree(tree)
    if messages.texts:
        raise SystemExit(f"not compared as it is: {messages.texts}")
    up = np.tile(np.float32((0, 0, 1)), (len(positions), 1))
    points = _core.shading.surface_points(positions.astype(np.float32), up, up, textures=scene.store)
    return points.results(emitter.program)["emission"].astype(np.float64) - OFFSET


def make_image(color_space: str, alpha: bool = False) -> Any:
    """A small picture, of alpha 1 unless it has some of its own."""
    name = f"{color_space}, alpha" if alpha else color_space
    if name in bpy.data.images:
        return bpy.data.images[name]
    image = bpy.data.images.new(name, 8, 4, alpha=alpha)
    image.colorspace_settings.name = color_space
    values = np.random.default_rng(5).random((4, 8, 4)).astype(np.float32)
    if not alpha:
        values[..., 3] = 1
    image.pixels.foreach_set(values.ravel())
    image.update()
    return image


def position_material() -> Any:
    """Shines by the position."""
    material = bpy.data.materials.new("Position")
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()
    geometry, emission = tree.nodes.new("ShaderNodeNewGeometry"), tree.nodes.new("ShaderNodeEmission")
    tree.links.new(geometry.outputs["Position"], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], tree.nodes.new("ShaderNodeOutputMaterial").inputs["Surface"])
    return material


def cases() -> list[Any]:
    """Everything that is compared."""
    from nodes_oracle_cases import all_cases
    from nodes_oracle_zones import zone_cases

    # Old nodes leave Blender: Musgrave in 4.1, HSV in 5.0.
    return [case for case in (*all_cases(Case, make_image), *zone_cases()) if hasattr(bpy.types, case.node)]


def compared_nodes() -> dict[str, list[dict[str, Any]]]:
    """By case: the node as it is compared."""
    return {case.name: [described(build_material(case, (0.0, 0.0))[1])] for case in cases()}


def main(folder: str) -> dict[str, Any]:
    """Render, compute; the differences by case."""
    everything = cases()
    columns = math.ceil(math.sqrt(len(everything)))
    rows = math.ceil(len(everything) / columns)
    set_up(columns, rows)
    materials = []
    for i, case in enumerate(everything):
        x, y = i % columns, i // columns
        materials.append(build_material(case, (x + 0.5, y + 0.5))[0])
        add_square(x, y, materials[-1])
    positions = render(f"{folder}/positions.exr", position_material())
    picture = render(f"{folder}/cases.exr", None) - OFFSET
    differences, ranges = {}, {}
    for i, (case, material) in enumerate(zip(everything, materials)):
        x, y = i % columns, i // columns
        # A pixel at a square's border may show its neighbour.
        part = np.s_[y * PIXELS + 1 : (y + 1) * PIXELS - 1, x * PIXELS + 1 : (x + 1) * PIXELS - 1]
        # Below the offset Cycles shines negatively, which the core does not.
        expected = np.maximum(picture[part].reshape(-1, 3), -OFFSET)
        found = core_picture(material, positions[part].reshape(-1, 3))
        difference = np.abs(found - expected) / np.maximum(1.0, np.abs(expected))
        differences[case.name] = np.sort(difference.max(axis=1)).tolist()
        ranges[case.name] = [float(expected.min()), float(expected.max())]
    return {"differences": differences, "ranges": ranges}


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    report(**main(sys.argv[1]), version=bpy.app.version, nodes=compared_nodes())
