"""Scenes with a setting or a link that few have, in both engines. Inside Blender."""

import sys
from pathlib import Path

import both_engines
import bpy
import oddity_nodes  # adds its cases
import scenes
from oddity_scenes import CASES, SIZE, build, case, lay_floor, link_image, save_picture, shine, square

FOLDER = Path(sys.argv[1])


def put_into(scene, item):
    """What makes an instance of an object's collection."""
    held = bpy.data.collections.new("Held")
    held.objects.link(item)
    scene.collection.objects.unlink(item)
    maker = scenes.add(None, "Maker")
    maker.instance_type, maker.instance_collection = "COLLECTION", held
    return maker


def closed_off(scene, item):
    """The collection of the view layer in which an object then is alone."""
    own = bpy.data.collections.new("Own")
    scene.collection.children.link(own)
    scene.collection.objects.unlink(item)
    own.objects.link(item)
    return bpy.context.view_layer.layer_collection.children["Own"]


# --- objects ----------------------------------------------------------------------------------------------------------


@case
def curves_of_geometry_nodes(scene, item, tree, shader):
    item.location.x = -1.5
    made = bpy.data.node_groups.new("Made", "GeometryNodeTree")
    if bpy.app.version < (4, 0, 0):
        made.outputs.new("NodeSocketGeometry", "Geometry")
    else:
        made.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    line, output = made.nodes.new("GeometryNodeCurvePrimitiveLine"), made.nodes.new("NodeGroupOutput")
    made.links.new(line.outputs[0], output.inputs[0])
    item.modifiers.new("Made", "NODES").node_group = made


def _show_generated(tree, shader):
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["Generated"], shader.inputs["Color"])


@case
def generated_coordinates_of_a_mirrored_mesh(scene, item, tree, shader):
    _show_generated(tree, shader)
    item.scale, item.location.x = (0.4, 0.8, 1), -0.5
    item.modifiers.new("Mirror", "MIRROR").mirror_object = scenes.add(None, "Middle")


@case
def texture_coordinates_where_a_mirrored_mesh_is_joined_and_subdivided(scene, item, tree, shader):
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    tree.links.new(coordinates.outputs["UV"], shader.inputs["Color"])
    item.scale, item.location.x = (0.4, 0.8, 1), -0.4  # up to the middle
    item.modifiers.new("Mirror", "MIRROR").mirror_object = scenes.add(None, "Middle")
    levels = item.modifiers.new("Subdivision", "SUBSURF")
    levels.levels = levels.render_levels = 5


@case
def normal_map_on_faces_of_seven_corners(scene, item, tree, shader):
    nodes = tree.nodes
    bent, shifted = nodes.new("ShaderNodeNormalMap"), nodes.new("ShaderNodeVectorMath")
    bent.inputs["Color"].default_value = (0.8, 0.65, 0.9, 1)
    shifted.operation = "ADD"
    shifted.inputs[1].default_value = (1, 1, 1)
    tree.links.new(bent.outputs[0], shifted.inputs[0])
    tree.links.new(shifted.outputs[0], shader.inputs["Color"])
    item.hide_render = True
    bpy.ops.mesh.primitive_cylinder_add(vertices=7, radius=0.8, depth=0.6, rotation=(0.5, 0.3, 0))
    bpy.ops.object.shade_smooth()
    bpy.context.object.data.materials.append(item.data.materials[0])


@case
def generated_coordinates_of_a_subdivided_mesh_with_its_own_space(scene, item, tree, shader):
    _show_generated(tree, shader)
    levels = item.modifiers.new("Subdivision", "SUBSURF")
    levels.levels = levels.render_levels = 5
    item.data.use_auto_texspace = False
    item.data.texspace_location, item.data.texspace_size = (0.3, 0.1, 0), (2, 1, 1)


@case
def generated_coordinates_of_a_bevelled_curve(scene, item, tree, shader):
    item.location.z = -2
    curve = bpy.data.curves.new("Curve", "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.4
    spline = curve.splines.new("POLY")
    spline.points.add(1)
    spline.points.foreach_set("co", [-0.8, 0, 0, 1, 0.8, 0, 0, 1])
    _show_generated(*shine(scenes.add(curve)))


@case
def bevel_without_an_object(scene, item, tree, shader):
    item.location.z = -1
    curve = bpy.data.curves.new("Curve", "CURVE")
    curve.dimensions, curve.fill_mode, curve.bevel_mode = "2D", "BOTH", "OBJECT"
    spline = curve.splines.new("POLY")
    spline.points.add(3)
    spline.points.foreach_set("co", [0, 0, 0, 1, 1, 0, 0, 1, 1, 1, 0, 1, 0, 1, 0, 1])
    spline.use_cyclic_u = True
    text = bpy.data.curves.new("Text", "FONT")
    text.body, text.bevel_mode = "I", "OBJECT"
    for data in (curve, text):
        shine(scenes.add(data), (1, 0.5, 0))
    bpy.data.objects["Text"].location = (-0.5, -0.5, 0)


def _instance(scene, item):
    item.location.z = -1
    small = square("Small", 0.5)
    shine(small, (1, 0.5, 0))
    return put_into(scene, small)


@case
def maker_that_the_camera_does_not_see(scene, item, tree, shader):
    _instance(scene, item).visible_camera = False


@case
def maker_without_a_shadow(scene, item, tree, shader):
    lay_floor(item)
    maker = _instance(scene, item)
    maker.visible_shadow = maker.visible_camera = False
    sun = bpy.data.lights.new("Sun", "SUN")
    sun.energy = 3
    scenes.add(sun).location.z = 2


@case
def maker_that_is_held_out(scene, item, tree, shader):
    scene.render.film_transparent = True
    _instance(scene, item).is_holdout = True


@case
def maker_in_a_collection_that_is_held_out(scene, item, tree, shader):
    scene.render.film_transparent = True
    closed_off(scene, _instance(scene, item)).holdout = True


@case
def maker_in_a_collection_of_indirect_light(scene, item, tree, shader):
    closed_off(scene, _instance(scene, item)).indirect_only = True


@case
def vertices_that_the_camera_does_not_see(scene, item, tree, shader):
    item.location.z = -1
    base, small = square("Base", 0.5), square("Small", 0.2)
    shine(base, (0, 1, 0))
    shine(small, (1, 0.5, 0))
    small.parent, base.instance_type = base, "VERTS"
    base.visible_camera = False


@case
def lamp_of_a_maker(scene, item, tree, shader):
    lay_floor(item)
    lamp = bpy.data.lights.new("Point", "POINT")
    lamp.energy, lamp.shadow_soft_size = 30, 0
    held = scenes.add(lamp)
    held.location.z = 1
    maker = put_into(scene, held)
    maker.is_holdout = True
    maker.visible_diffuse = bpy.app.version >= (4, 0, 0)  # in newer ones Cycles leaves lamps out


@case
def simplified_subdivision(scene, item, tree, shader):
    item.modifiers.new("Smooth", "SUBSURF").render_levels = 3
    scene.render.use_simplify, scene.render.simplify_subdivision_render = True, 0


@case
def focus_in_the_lens(scene, item, tree, shader):
    camera = scene.camera.data
    camera.type, camera.dof.use_dof, camera.dof.focus_distance, camera.dof.aperture_fstop = "PERSP", True, 0, 0.1
    item.scale = (50, 50, 1)


# --- lights -----------------------------------------------------------------------------------------------------------


def lamp_without_scale(kind, **settings):
    """A case: a lamp that is scaled to nothing, or whose own size is nothing."""

    def change(scene, item, tree, shader):
        lay_floor(item)
        if hasattr(scene.cycles, "use_light_tree"):
            scene.cycles.use_light_tree = True  # without it, newer ones have a spot without scale shine
        lamp = bpy.data.lights.new("Lamp", kind)
        lamp.energy = 3 if kind == "SUN" else 30
        held = scenes.add(lamp)
        held.location.z, held.scale = 1, (1, 1, 1) if settings else (0, 0, 0)
        for name, value in settings.items():
            setattr(lamp, name, value)

    return change


for lamp_kind in ("POINT", "SPOT", "AREA", "SUN"):
    CASES[f"{lamp_kind.lower()} without scale"] = lamp_without_scale(lamp_kind)
CASES["area without size"] = lamp_without_scale("AREA", size=0.0)
CASES["area without height"] = lamp_without_scale("AREA", shape="ELLIPSE", size=1.0, size_y=0.0)


def _world_node(scene, kind):
    scene.world.use_nodes = True
    tree = scene.world.node_tree
    node = tree.nodes.new(kind)
    background = next(each for each in tree.nodes if each.type == "BACKGROUND")
    tree.links.new(node.outputs[0], background.inputs["Color"])
    return node, background


@case
def sun_without_size(scene, item, tree, shader):
    item.hide_render, scene.camera.rotation_euler.x = True, 2  # up, into the sky
    node, background = _world_node(scene, "ShaderNodeTexSky")
    node.sky_type = "NISHITA" if bpy.app.version < (5, 0, 0) else "SINGLE_SCATTERING"
    node.sun_size, background.inputs["Strength"].default_value = 0.0, 0.05


@case
def environment_without_an_image(scene, item, tree, shader):
    item.location.x = 1
    _world_node(scene, "ShaderNodeTexEnvironment")


@case
def world_of_a_view_layer(scene, item, tree, shader):
    item.location.x = 1
    if hasattr(bpy.context.view_layer, "world_override"):  # 5.0
        usual = scene.world
        bpy.context.view_layer.world_override = scenes.plain_world((0.9, 0.5, 0.1))
        scene.world = usual


# --- files ------------------------------------------------------------------------------------------------------------


def _tiled(pattern, packed):
    for tile, name in enumerate(("u1_v1", "u2_v1", "u1_v2", "u2_v2")):
        number = ("1001", "1002", "1011", "1012")[tile]
        file = pattern.replace("<UDIM>", number).replace("<UVTILE>", name)
        save_picture(FOLDER / file, (0.2 * tile, 0.3, 0.9 - 0.2 * tile))
        first = file if tile == 0 else first
    image = bpy.data.images.load(str(FOLDER / first))
    image.source, image.filepath = "TILED", str(FOLDER / pattern)
    for number in (1002, 1011, 1012):
        image.tiles.new(number)
    if packed:
        image.pack()
        for file in FOLDER.glob(pattern.replace("<UDIM>", "1*")):
            file.unlink()
    return image


@case
def packed_tiles(scene, item, tree, shader):
    link_image(tree, shader, _tiled("packed.<UDIM>.png", packed=True))


@case
def tiles_by_row_and_column(scene, item, tree, shader):
    link_image(tree, shader, _tiled("tile.<UVTILE>.png", packed=False))


@case
def path_of_windows(scene, item, tree, shader):
    (FOLDER / "sub").mkdir(exist_ok=True)
    save_picture(FOLDER / "sub" / "picture.png", (0.2, 0.6, 0.9))
    image = bpy.data.images.load(str(FOLDER / "sub" / "picture.png"))
    bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / "windows.blend"))
    image.filepath = "//sub\\picture.png"
    link_image(tree, shader, image)


if __name__ == "__main__":
    found = {}
    for name, change in CASES.items():
        shown, *parts = build()
        change(shown, *parts)
        found[name] = {}
        for engine in ("CYCLES", "RAYLEAF"):
            picture = both_engines.picture(shown, engine, FOLDER / f"{engine}.exr")
            found[name][engine] = both_engines.means(picture, SIZE // 4)
    report(found=found)
