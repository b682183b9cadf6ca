"""Makes studio.blend: meshes under every kind of lamp, a sky and a floor from packed images, instances, depth of field."""

import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np

sys.path.append(str(Path(__file__).resolve().parent))
from scene_tools import (
    LINEAR,
    NodeTree,
    add_camera,
    add_lamp,
    link,
    material,
    pack_image,
    save,
    start_empty,
)  # noqa: E402


def sky_pixels() -> np.ndarray:
    """A studio in equirectangular form: dim room, brighter above, two soft boxes and a thin strip light."""
    height, width = 64, 128
    azimuth = (np.arange(width) + 0.5) / width * 360
    elevation = (np.arange(height) + 0.5) / height * 180 - 90
    around, up = np.meshgrid(azimuth, elevation)
    room = np.interp(elevation, (-90, -5, 5, 90), (0.05, 0.09, 0.16, 0.34))[:, None, None] * np.array(
        [0.82, 0.92, 1.08]
    )
    pixels = np.broadcast_to(room, (height, width, 3)).copy()
    pixels[(abs(around - 60) < 22) & (abs(up - 40) < 16)] = (9.0, 8.2, 7.2)
    pixels[(abs(around - 215) < 14) & (abs(up - 28) < 22)] = (3.2, 4.2, 6.0)
    pixels[(abs(around - 310) < 3) & (abs(up - 20) < 26)] = (14.0, 9.0, 6.0)
    return pixels


def floor_pixels() -> np.ndarray:
    """Tiles with a leaf on every other one, in sRGB."""
    size = 256
    y, x = np.meshgrid(*[(np.arange(size) + 0.5) / size] * 2, indexing="ij")
    column, row = np.floor(x * 2), np.floor(y * 2)
    u, v = (x * 2 - column - 0.5) * 2, (y * 2 - row - 0.5) * 2
    pixels = np.where(((column + row) % 2 == 0)[..., None], (0.74, 0.72, 0.68), (0.6, 0.6, 0.6))
    along, across = (u + v) / np.sqrt(2), (u - v) / np.sqrt(2)
    leaf = (abs(across) < 0.34 * np.cos(np.clip(along / 0.8, -1, 1) * np.pi / 2)) & (abs(along) < 0.8)
    vein = leaf & ((abs(across) < 0.02) | (abs((along - abs(across)) % 0.2 - 0.1) < 0.012))
    green = (column + row) % 2 == 0
    pixels[leaf & green] = (0.42, 0.55, 0.4)
    pixels[vein & green] = (0.56, 0.66, 0.5)
    pixels[(abs(u) > 0.975) | (abs(v) > 0.975)] = (0.42, 0.41, 0.4)
    return pixels


def studio_world() -> None:
    """Light from the packed sky, turned a little."""
    world = bpy.data.worlds.new("studio")
    bpy.context.scene.world = world
    tree = NodeTree(world)
    direction = tree.add("ShaderNodeTexCoord").outputs["Generated"]
    turned = tree.add("ShaderNodeMapping", {"Vector": direction, "Rotation": (0, 0, 0.35)}).outputs[0]
    image = pack_image("sky", sky_pixels(), LINEAR)
    sky = tree.add("ShaderNodeTexEnvironment", {"Vector": turned}, image=image).outputs["Color"]
    background = tree.add("ShaderNodeBackground", {"Color": sky, "Strength": 0.42})
    tree.add("ShaderNodeOutputWorld", {"Surface": background.outputs[0]})


def tiled_floor() -> bpy.types.Material:
    """The packed image on the floor's UV map, rougher on its bright parts."""
    made = bpy.data.materials.new("tiles")
    tree = NodeTree(made)
    place = tree.add("ShaderNodeUVMap", uv_map="tiles").outputs["UV"]
    image = tree.add("ShaderNodeTexImage", {"Vector": place}, image=pack_image("tiles", floor_pixels(), "sRGB"))
    rough = tree.add("ShaderNodeMath", {0: image.outputs["Color"], 1: 0.35, 2: 0.12}, operation="MULTIPLY_ADD")
    inputs = {"Base Color": image.outputs["Color"], "Roughness": rough.outputs[0]}
    shader = tree.add("ShaderNodeBsdfPrincipled", inputs)
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    return made


def add_mesh(name: str, vertices: list[Any], faces: list[Any], look: bpy.types.Material) -> Any:
    """A mesh object."""
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    mesh.materials.append(look)
    return link(name, mesh)


def add_room() -> None:
    """A tiled floor with a UV map of its own name, and behind it a wall that begins with a curve."""
    floor = add_mesh("floor", [(-12, -8, 0), (12, -8, 0), (12, 4.4, 0), (-12, 4.4, 0)], [(0, 1, 2, 3)], tiled_floor())
    layer = floor.data.uv_layers.new(name="tiles")
    for loop in floor.data.loops:
        x, y, _ = floor.data.vertices[loop.vertex_index].co
        layer.data[loop.index].uv = (x / 1.9, y / 1.9)
    profile = [(4.4 + 1.6 * np.sin(a), 1.6 - 1.6 * np.cos(a)) for a in np.linspace(0, np.pi / 2, 13)] + [(6.0, 9.0)]
    vertices = [(x, y, z) for y, z in profile for x in (-12.0, 12.0)]
    faces = [(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2) for i in range(len(profile) - 1)]
    wall = add_mesh("wall", vertices, faces, material("plaster", (0.34, 0.39, 0.42), 0.7))
    wall.data.polygons.foreach_set("use_smooth", [True] * len(wall.data.polygons))


def add_primitive(operator: Any, name: str, look: bpy.types.Material, smooth: bool, **arguments: Any) -> Any:
    """One of Blender's mesh primitives."""
    operator(**arguments)
    thing = bpy.context.object
    thing.name = thing.data.name = name
    thing.data.materials.append(look)
    thing.data.polygons.foreach_set("use_smooth", [smooth] * len(thing.data.polygons))
    return thing


def add_monkey() -> None:
    """The one in focus: subdivided, coated."""
    look = material("lacquer", (0.62, 0.06, 0.03), 0.42, Clearcoat=1.0, Clearcoat_Roughness=0.04)
    add = bpy.ops.mesh.primitive_monkey_add
    monkey = add_primitive(add, "monkey", look, True, size=2.4, location=(0, 0, 0), rotation=(-0.55, 0, 0.42))
    monkey.modifiers.new("smoother", "SUBSURF").render_levels = 2
    monkey.modifiers["smoother"].levels = 2
    evaluated = monkey.evaluated_get(bpy.context.evaluated_depsgraph_get())
    monkey.location.z = -min((monkey.matrix_world @ vertex.co).z for vertex in evaluated.data.vertices)


def add_company() -> None:
    """Other materials at other distances."""
    mesh = bpy.ops.mesh
    metal = material("brushed metal", (0.86, 0.86, 0.88), 0.28, Metallic=1.0)
    ring = add_primitive(
        *(mesh.primitive_torus_add, "ring", metal, True),
        major_radius=0.7,
        minor_radius=0.24,
        location=(-2.5, 0.9, 0.78),
        rotation=(1.35, 0.25, 0.5),
    )
    ring.modifiers.new("smoother", "SUBSURF").render_levels = 1
    clear = material("clear", (0.96, 0.99, 1.0), 0.0, Transmission=1.0, IOR=1.45)
    add_primitive(
        mesh.primitive_uv_sphere_add, "glass ball", clear, True, radius=0.62, location=(2.0, -0.9, 0.62), segments=64
    )
    wax = material("wax", (0.85, 0.62, 0.3), 0.55)
    box = add_primitive(
        mesh.primitive_cube_add, "box", wax, False, size=1.1, location=(2.7, 1.5, 0.56), rotation=(0, 0, 0.5)
    )
    box.modifiers.new("edges", "BEVEL").width = 0.06
    tube = bpy.data.materials.new("tube")
    tree = NodeTree(tube)
    shader = tree.add("ShaderNodeEmission", {"Color": (1.0, 0.5, 0.2, 1), "Strength": 6.0})
    tree.add("ShaderNodeOutputMaterial", {"Surface": shader.outputs[0]})
    add_primitive(
        *(mesh.primitive_cylinder_add, "neon tube", tube, True),
        radius=0.05,
        depth=2.4,
        location=(-3.6, 2.6, 1.3),
    )


def add_instances() -> None:
    """A collection placed five times, and pebbles strewn by a particle system."""
    source = bpy.data.collections.new("cairn")
    stone = material("stone", (0.3, 0.33, 0.36), 0.7)
    for index, (radius, height) in enumerate(((0.34, 0.2), (0.25, 0.52), (0.16, 0.76))):
        add = bpy.ops.mesh.primitive_ico_sphere_add
        ball = add_primitive(
            add, f"cairn stone {index}", stone, True, subdivisions=3, radius=radius, location=(0, 0, height)
        )
        ball.scale = (1, 0.9, 0.62)
        bpy.context.scene.collection.objects.unlink(ball)
        source.objects.link(ball)
    for index in range(5):
        cairn = link(f"cairn {index}", None, (-4.4 + 2.1 * index, 3.3 + 0.35 * (index % 2), 0))
        cairn.instance_type, cairn.instance_collection = "COLLECTION", source
        cairn.rotation_euler = (0, 0, 1.3 * index)
        cairn.scale = [0.8 + 0.18 * (index % 3)] * 3

    hidden = bpy.data.collections.new("not rendered by themselves")
    bpy.context.scene.collection.children.link(hidden)
    look = material("pebble", (0.5, 0.44, 0.36), 0.65)
    pebble = add_primitive(
        bpy.ops.mesh.primitive_ico_sphere_add, "pebble", look, True, subdivisions=2, radius=1, location=(0, 0, -5)
    )
    pebble.scale = (1, 0.85, 0.6)
    bpy.context.scene.collection.objects.unlink(pebble)
    hidden.objects.link(pebble)
    ground = add_mesh("where pebbles lie", [(-5, -2.6, 0), (5, -2.6, 0), (5, 4, 0), (-5, 4, 0)], [(0, 1, 2, 3)], look)
    ground.modifiers.new("pebbles", "PARTICLE_SYSTEM")
    ground.show_instancer_for_render = False
    settings = ground.particle_systems[0].settings
    settings.type, settings.count, settings.hair_length = "HAIR", 220, 1.0
    settings.render_type, settings.instance_object = "OBJECT", pebble
    settings.particle_size, settings.size_random = 0.07, 0.6
    settings.use_advanced_hair, settings.use_rotations = True, True
    settings.rotation_mode, settings.phase_factor_random = "NOR", 2.0


def add_lamps() -> None:
    """One of every kind."""
    sun = add_lamp("sun", "SUN", (4, -6, 8), (0, 0, 0), 0.7, (1.0, 0.92, 0.8))
    sun.data.angle = 0.03
    spot = add_lamp("spot", "SPOT", (-4.2, -3.2, 5.0), (-2.4, 0.8, 0.6), 330, (0.65, 0.8, 1.0))
    spot.data.spot_size, spot.data.spot_blend, spot.data.shadow_soft_size = 0.62, 0.3, 0.12
    point = add_lamp("point", "POINT", (3.4, 2.9, 2.2), (0, 0, 0), 70, (1.0, 0.6, 0.36))
    point.data.shadow_soft_size = 0.2
    box = add_lamp("soft box", "AREA", (3.6, -3.4, 4.4), (0, 0, 0.9), 130)
    box.data.shape, box.data.size, box.data.size_y = "RECTANGLE", 1.4, 2.4
    disk = add_lamp("beauty dish", "AREA", (-1.2, 3.6, 5.2), (0, 0, 1), 95, (1.0, 0.85, 0.9))
    disk.data.shape, disk.data.size = "DISK", 1.6


def main() -> None:
    start_empty(width=800, height=500, samples=32)
    studio_world()
    add_room()
    add_monkey()
    add_company()
    add_instances()
    add_lamps()
    camera = add_camera((0.4, -8.6, 2.7), (0, 0, 0.95), 44)
    camera.data.dof.use_dof = True
    camera.data.dof.focus_distance = 7.95
    camera.data.dof.aperture_fstop = 0.13
    camera.data.dof.aperture_blades = 7
    save("studio")


main()
