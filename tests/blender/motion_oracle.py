"""Runs inside Blender: objects and cameras that move while the shutter is open; Cycles and Rayleaf."""

import math
import sys
from pathlib import Path

import both_engines
import bpy
import numpy as np
import scenes
from rayleaf import versions

report = globals()["report"]  # given by the test
FRAME = 10


def paint(name, place_by="Generated"):
    """A material that glows in colours of the object's own space: what moves shows it, and lamps make no noise."""
    material, tree, _ = scenes.material(name)
    place, glow = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeEmission")
    if place_by is not None:
        tree.links.new(place.outputs[place_by], glow.inputs["Color"])
    tree.links.new(glow.outputs[0], tree.nodes["Material Output"].inputs["Surface"])
    return material


def keyed(owner, path, *values):
    """Values at even steps from the frame before to the frame after, joined by lines."""
    for number, value in enumerate(values):
        setattr(owner, path, value)
        owner.keyframe_insert(path, frame=FRAME - 1 + 2 * number / (len(values) - 1))
    for curve in versions.animation_curves(owner.id_data):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


def build():
    """A still cube beside what moves, before a dim sky."""
    scenes.empty_file()
    scene = bpy.context.scene
    scenes.plain_world((0.1, 0.1, 0.2))
    bpy.ops.mesh.primitive_cube_add(size=1.0, location=(-1.5, -1.2, 0))
    bpy.context.object.data.materials.append(paint("still"))
    camera = bpy.data.cameras.new("camera")
    scene.camera = scenes.add(camera)
    scene.camera.location, scene.camera.rotation_euler = (0, -1.5, 7), (0.2, 0, 0)
    camera.lens = 40
    scene.render.use_motion_blur, scene.render.motion_blur_shutter = True, 1.0
    scene.render.resolution_x = scene.render.resolution_y = 24
    both_engines.sample_plainly(scene, 1024)
    both_engines.set_alike(scene, max_bounces=0)
    both_engines.filter_by_box(scene)
    scenes.write_layers()
    return scene


def cube():
    bpy.ops.mesh.primitive_cube_add(size=1.4, location=(0.6, 0.3, 0))
    bpy.context.object.data.materials.append(paint("cube"))
    return bpy.context.object


def driven_cube(scene):
    """Along a curve, turning: its middle is off the line between its ends."""
    body = cube()
    keyed(body, "location", (-0.6, 0.3, 0), (0.6, 1.0, 0), (1.2, -0.4, 0.5))
    keyed(body, "rotation_euler", (0, 0, 0), (0.5, 0.3, 1.0), (0.8, 1.2, 1.9))
    return body


def scaled_cube(scene):
    keyed(cube(), "scale", (0.4, 1, 1), (1.6, 0.7, 1))


def still_cube(scene):
    driven_cube(scene).cycles.use_motion_blur = False


def many_steps(scene):
    """A whole turn, which three steps cannot show."""
    body = cube()
    body.cycles.motion_steps = 4
    keyed(body, "rotation_euler", (0, 0, -2 * math.pi), (0, 0, 0), (0, 0, 2 * math.pi))


def sheet(scene):
    bpy.ops.surface.primitive_nurbs_surface_surface_add(radius=1.2, location=(0.4, 0.3, 0))
    body = bpy.context.object
    body.data.materials.append(paint("sheet"))
    body.data.splines[0].points[5].co.z += 0.8
    keyed(body, "location", (-0.2, 0.6, 0), (1.2, 0, 0.3))
    keyed(body, "rotation_euler", (0.2, 0, 0), (0.5, 0.2, 0.9))


def parented(scene):
    """Instances of a collection, by an empty that a driver moves: drivers run Python while the engine sets the frame."""
    bpy.context.preferences.filepaths.use_scripts_auto_execute = True
    body = cube()
    collection = bpy.data.collections.new("many")
    collection.objects.link(body)
    scene.collection.objects.unlink(body)
    maker = bpy.data.objects.new("maker", None)
    maker.instance_type, maker.instance_collection = "COLLECTION", collection
    scene.collection.objects.link(maker)
    curve = maker.driver_add("location", 0).driver
    curve.type, curve.expression = "SCRIPTED", "(frame - 10) * max(1.6, sum(0 for i in range(10)))"


def appearing(scene):
    """Not there before the frame."""
    body = driven_cube(scene)
    body.hide_render = True
    body.keyframe_insert("hide_render", frame=FRAME - 1)
    body.hide_render = False
    body.keyframe_insert("hide_render", frame=FRAME)


def bent(body, moved):
    """A shape key that takes the points of a body elsewhere, slowly at first."""
    body.shape_key_add(name="rest")
    key = body.shape_key_add(name="bent")
    for point in key.data:
        point.co = moved(point.co.copy())
    keyed(key, "value", 0.0, 0.3, 1.0)
    return body


def grid(subdivisions=8, size=2.4):
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=subdivisions, y_subdivisions=subdivisions, size=size)
    bpy.context.object.data.materials.append(paint("grid", "UV"))
    return bpy.context.object


def waved(point):
    point.z += 0.6 * math.sin(2 * point.x)
    point.x += 0.9 * point.y
    return point


def waving_mesh(scene):
    bent(grid(), waved)


def twisting_mesh(scene):
    """Turned by a modifier, while the object moves."""
    body = cube()
    body.data.materials[0] = paint("twisted", "UV")  # Generated coordinates are those of the form that is rendered
    modifier = body.modifiers.new("twist", "SIMPLE_DEFORM")
    modifier.deform_method, modifier.deform_axis = "TWIST", "Z"
    for number, angle in enumerate((0.0, 1.5, 3.0)):
        modifier.angle = angle
        modifier.keyframe_insert("angle", frame=FRAME - 1 + number)
    for curve in versions.animation_curves(body):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"
    keyed(body, "location", (-0.6, 0.3, 0), (0.6, 0.6, 0.3))


def still_mesh(scene):
    bent(grid(), waved).cycles.use_deform_motion = False


def subdivided_mesh(scene):
    body = bent(grid(3), waved)
    modifier = body.modifiers.new("smooth", "SUBSURF")
    modifier.levels = modifier.render_levels = 5
    modifier.subdivision_type, body.cycles.motion_steps = "CATMULL_CLARK", 2
    for polygon in body.data.polygons:
        polygon.use_smooth = True


def waving_sheet(scene):
    """A NURBS surface by its shape keys."""
    bpy.ops.surface.primitive_nurbs_surface_surface_add(radius=1.2, location=(0.4, 0.3, 0))
    body = bpy.context.object
    body.data.materials.append(paint("sheet", "UV"))
    body.data.resolution_u = body.data.resolution_v = 24
    bent(body, lambda point: tipped(waved(point)))


def bending_curve(scene):
    """A bevelled Bezier curve by its shape keys."""
    bpy.ops.curve.primitive_bezier_curve_add(radius=1.2, location=(0.4, 0.3, 0))
    body = bpy.context.object
    body.data.materials.append(paint("curve", "UV"))
    body.data.bevel_depth, body.data.bevel_resolution, body.data.resolution_u = 0.25, 8, 32
    body.shape_key_add(name="rest")
    key = body.shape_key_add(name="bent")
    for point, up in zip(key.data, (0.8, -0.6), strict=True):
        for place in (point.co, point.handle_left, point.handle_right):
            place.y, place.z = place.y + up, place.z + 0.5
    keyed(key, "value", 0.0, 0.3, 1.0)


def tipped(point):
    point.z += 0.4 * point.x
    point.x += 1.6
    return point


def combed_hair(scene):
    """Thick strands on a ground that moves and tips by its points."""
    scene.cycles_curves.shape, scene.rayleaf.strand_shape = "THICK", "ROUND"
    ground = bent(grid(2, 1.2), tipped)
    ground.data.materials[0] = paint("hair", None)
    ground.show_instancer_for_render = False
    ground.rotation_euler = (1.6, 0, 0)  # strands are seen from the side: their ends differ in Cycles
    scenes.grow_strands(ground, 2.0, 0.06)


def moving_points(scene):
    """Balls where the points of a mesh are that deforms."""
    body = bent(grid(3, 2.0), waved)
    modifier = body.modifiers.new("points", "NODES")
    modifier.node_group = scenes.group("points", "NodeSocketGeometry", "NodeSocketGeometry", "GeometryNodeTree")
    nodes, links = modifier.node_group.nodes, modifier.node_group.links
    start, end = nodes.new("NodeGroupInput"), nodes.new("NodeGroupOutput")
    points, painted = nodes.new("GeometryNodeMeshToPoints"), nodes.new("GeometryNodeSetMaterial")
    points.inputs["Radius"].default_value = 0.2
    painted.inputs["Material"].default_value = paint("balls", None)
    links.new(start.outputs[0], points.inputs[0])
    links.new(points.outputs[0], painted.inputs[0])
    links.new(painted.outputs[0], end.inputs[0])


def panning(scene):
    cube()
    keyed(scene.camera, "location", (-0.5, -1.5, 7), (0.4, -1.2, 6.5))
    keyed(scene.camera, "rotation_euler", (0.2, -0.1, 0), (0.25, 0.05, 0.5))


def zooming(scene):
    cube()
    keyed(scene.camera.data, "lens", 30, 60)


def orthographic(scene):
    panning(scene)
    scene.camera.data.type, scene.camera.data.ortho_scale = "ORTHO", 5


def panoramic(scene):
    panning(scene)
    scenes.make_panoramic(scene.camera.data, "FISHEYE_EQUIDISTANT", fisheye_fov=1.0)


def set_position(scene, where):
    """Whether the frame is the shutter's START, CENTER or END; since 4.2 a setting for all engines."""
    of = scene.render if hasattr(scene.render, "motion_blur_position") else scene.cycles
    of.motion_blur_position = where


def at_start(scene):
    """The shutter opens at the frame and slowly closes."""
    driven_cube(scene)
    panning(scene)
    set_position(scene, "START")
    scene.render.motion_blur_shutter = 0.8
    points = scene.render.motion_blur_shutter_curve.curves[0].points
    points[-1].location = (1, 0)


def at_end(scene):
    driven_cube(scene)
    set_position(scene, "END")


def rolling(scene):
    driven_cube(scene)
    scene.cycles.rolling_shutter_type, scene.cycles.rolling_shutter_duration = "TOP", 0.3


CASES = (
    driven_cube,
    scaled_cube,
    still_cube,
    many_steps,
    sheet,
    parented,
    appearing,
    waving_mesh,
    twisting_mesh,
    still_mesh,
    subdivided_mesh,
    waving_sheet,
    bending_curve,
    combed_hair,
    moving_points,
    panning,
    zooming,
    orthographic,
    panoramic,
    at_start,
    at_end,
    rolling,
)


# Not by zooms, which Cycles leaves out of vectors, and not in fisheyes, where it mirrors them; nor by orthographic cameras in
# 4.3 and later, where they are not the way of a point in Blender's own projection any more.
VECTOR_CASES = (driven_cube, sheet, parented, waving_mesh, waving_sheet, panning) + (
    (orthographic,) if bpy.app.version < (4, 3) else ()
)


def compared(case, folder):
    """How far the pictures are apart, as shares of their mean: of the engines, and of Rayleaf's without motion blur."""
    scene = build()
    case(scene)
    scene.frame_set(FRAME)
    theirs, ours = (both_engines.picture(scene, engine, folder / "picture.exr") for engine in ("CYCLES", "RAYLEAF"))
    frame = scene.frame_current + scene.frame_subframe
    scene.render.use_motion_blur = False
    sharp = both_engines.picture(scene, "RAYLEAF", folder / "picture.exr")
    mean = theirs[..., :3].mean()
    return dict(
        apart=float(np.abs(theirs - ours)[..., :3].mean() / mean),
        brighter=float(ours[..., :3].mean() / mean - 1),
        blurred=float(np.abs(theirs - sharp)[..., :3].mean() / mean),
        frame=frame,
    )


def vectors(case, folder):
    """The largest vector, and how far those of the engines are apart where both show the same surface, pixels."""
    scene = build()
    case(scene)
    scene.frame_set(FRAME)
    scene.render.use_motion_blur = False
    both_engines.sample_plainly(scene, 16)
    scene.render.resolution_x = scene.render.resolution_y = 48
    bpy.context.view_layer.use_pass_vector = bpy.context.view_layer.use_pass_z = True
    found = [both_engines.channels(scene, engine, folder / "picture.exr") for engine in ("CYCLES", "RAYLEAF")]
    theirs, ours = (both_engines.color(each, "Vector", "XYZW") for each in found)
    depths = np.stack([each["ViewLayer.Depth.Z"] for each in found])
    # Inside: the pixels around are all of surfaces.
    near = (depths < 100).all(0)
    inside = near.copy()
    for axis in (0, 1):
        for step in (-1, 1):
            inside &= np.roll(near, step, axis)
    apart = np.abs(theirs - ours).max(-1)[inside]
    return dict(
        pixels=int(inside.sum()),
        largest=float(np.abs(theirs).max()),
        apart=float(np.median(apart)),
        frame=scene.frame_current + scene.frame_subframe,
    )


if __name__ == "__main__":
    own_folder = Path(sys.argv[1])
    report(result={case.__name__: compared(case, own_folder) for case in CASES})
    report(vectors={case.__name__: vectors(case, own_folder) for case in VECTOR_CASES})
