"""The scenes in blend_scenes/ are what their scripts make, small, and saved by the oldest Blender that must open them."""

from collections.abc import Iterator
from math import isclose
from typing import Any

import pytest

SCENES = (
    *("bezier_sheet", "spline_gallery", "glass_vase", "studio", "random_volumes", "random_volumes_xray", "tomatoes"),
    *("curves_gallery", "knot", "paper_fish", "spiral", "hair_ball", "parking_lot", "city_street"),
    *("psychedelic_dragons", "still_life", "foggy_lamp", "portrait_hair"),
)
LARGEST = 1_000_000  # bytes of a scene file

DESCRIBE = """
import os, runpy, sys
import bpy

def numbers(values):
    return [float(value) for value in values]

def spline(each):
    flags = [each.use_cyclic_u, each.use_cyclic_v, each.use_endpoint_u, each.use_endpoint_v, each.use_bezier_u, each.use_bezier_v]
    size = [each.point_count_u, each.point_count_v, each.order_u, each.order_v]
    return [size, flags, [numbers(point.co) for point in each.points]]

def curve(data):
    settings = [data.dimensions, data.fill_mode, data.twist_mode, data.bevel_mode, data.taper_radius_mode, data.use_fill_caps]
    helpers = [item and item.name for item in (data.bevel_object, data.taper_object)]
    sizes = numbers([data.bevel_depth, data.extrude, data.offset, data.bevel_factor_start, data.bevel_factor_end])
    return [settings, helpers, sizes, [spline_of_curve(each) for each in data.splines]]

def spline_of_curve(each):
    points = each.bezier_points if each.type == "BEZIER" else each.points
    places = [numbers([*point.co, point.radius, point.tilt]) for point in points]
    handles = [numbers([*point.handle_left, *point.handle_right]) for point in each.bezier_points]
    return [each.type, each.use_cyclic_u, each.order_u, each.radius_interpolation, each.tilt_interpolation, places, handles]

def hair(settings):
    sizes = [settings.count, settings.rendered_child_count, settings.hair_length, settings.radius_scale, settings.tip_radius]
    return [settings.type, settings.child_type, settings.kink, numbers(sizes)]

def data(thing):
    if thing.type == "CURVE":
        return curve(thing.data)
    if thing.type == "SURFACE":
        return [spline(each) for each in thing.data.splines]
    if thing.type == "MESH":
        modifiers = [m.type for m in thing.modifiers]
        return [numbers(vertex.co) for vertex in thing.data.vertices] + [modifiers, [hair(s.settings) for s in thing.particle_systems]]
    if thing.type == "LIGHT":
        return [thing.data.type, numbers([thing.data.energy, *thing.data.color])]
    if thing.type == "CAMERA":
        return [thing.data.type, numbers([thing.data.lens, thing.data.ortho_scale, thing.data.dof.aperture_fstop])]
    return getattr(thing.data, "body", None)

def socket(each):
    value = getattr(each, "default_value", None)
    if value is None or isinstance(value, (str, bool)):
        return value
    return numbers(value if hasattr(value, "__len__") else [value])

def nodes(tree):
    described = [[node.bl_idname, [socket(each) for each in node.inputs]] for node in tree.nodes]
    links = [[link.from_node.name, link.from_socket.name, link.to_node.name, link.to_socket.name] for link in tree.links]
    return [described, sorted(links)]

def picture(image):
    return [list(image.size), numbers(image.pixels[:][:: max(1, len(image.pixels) // 997)])]

def describe(path):
    bpy.ops.wm.open_mainfile(filepath=path)
    scene = bpy.context.scene
    render = scene.render
    return {
        "version": list(bpy.data.version),
        "render": [render.engine, render.resolution_x, render.resolution_y, scene.rayleaf.samples, scene.world is not None],
        "objects": {o.name: [o.type, [numbers(row) for row in o.matrix_world], data(o)] for o in bpy.data.objects},
        "materials": {m.name: nodes(m.node_tree) for m in bpy.data.materials if m.node_tree},
        "worlds": {w.name: nodes(w.node_tree) for w in bpy.data.worlds if w.users and w.node_tree},
        "images": {image.name: picture(image) for image in bpy.data.images if image.packed_file},
    }

script, kept, folder = sys.argv[1:]
sys.argv = [script, "--", folder]
runpy.run_path(script, run_name="__main__")
report(kept=describe(kept), made=describe(os.path.join(folder, os.path.basename(kept))))
"""


def differences(kept: Any, made: Any, where: str = "") -> Iterator[str]:
    """Where two descriptions differ. Numbers may by what single precision and another machine's sine leave."""
    if isinstance(kept, dict) and isinstance(made, dict) and kept.keys() == made.keys():
        for key in kept:
            yield from differences(kept[key], made[key], f"{where}/{key}")
    elif isinstance(kept, list) and isinstance(made, list) and len(kept) == len(made):
        for index, pair in enumerate(zip(kept, made)):
            yield from differences(*pair, f"{where}/{index}")
    elif not (isinstance(kept, float) and isinstance(made, float) and isclose(kept, made, rel_tol=1e-5, abs_tol=1e-5)):
        if kept != made:
            yield f"{where}: kept {str(kept)[:60]}, made {str(made)[:60]}"


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_is_what_its_script_makes(run_blender, root, tmp_path, name):
    """The script runs in every Blender; later ones turn what they read into their own terms (socket and node names, lamps'
    powers, new inputs), so that they cannot compare."""
    folder = root / "blend_scenes"
    run = run_blender(DESCRIBE, folder / f"make_{name}.py", folder / f"{name}.blend", tmp_path)
    kept, made = run.report["kept"], run.report["made"]
    assert kept.pop("version")[:2] == [3, 4]
    if made.pop("version")[:2] == [3, 4]:
        assert list(differences(kept, made)) == []
    else:
        assert kept["objects"].keys() == made["objects"].keys() and kept["materials"].keys() == made["materials"].keys()


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_file_is_small(root, name):
    assert (root / "blend_scenes" / f"{name}.blend").stat().st_size < LARGEST


def test_every_scene_file_is_listed_here(root):
    assert {path.stem for path in (root / "blend_scenes").glob("*.blend")} == set(SCENES)
