"""Coarse meshes that are shaded smooth under light that grazes them, in both engines. Inside Blender."""

import sys
from pathlib import Path

import both_engines
import bpy
import scenes

SIZE, SAMPLES = 64, 16
# What is lit, its scale, its offset, the lamp.
CASES = {
    "ball": ("ICO", (1, 1, 1), 0.1, "SUN"),
    "sphere": ("UV", (1, 1, 1), 0.1, "SUN"),
    "near lamp": ("UV", (1, 1, 1), 0.1, "POINT"),
    "flat": ("UV", (1.2, 1, 0.4), 0.1, "SUN"),
    "wide": ("ICO", (1, 1, 1), 0.5, "SUN"),
    "none": ("ICO", (1, 1, 1), 0.0, "SUN"),
    "cylinder": ("TUBE", (1, 1, 1), 0.1, "SUN"),
    "torus": ("TORUS", (1, 1, 1), 0.1, "SUN"),
    "head": ("MONKEY", (1, 1, 1), 0.1, "SUN"),
    "bowl": ("BOWL", (1, 1, 1), 0.1, "POINT"),
}


def add_body(kind):
    """A mesh of few faces."""
    mesh = bpy.ops.mesh
    if kind in ("UV", "BOWL"):
        mesh.primitive_uv_sphere_add(segments=12, ring_count=8)
    elif kind == "ICO":
        mesh.primitive_ico_sphere_add(subdivisions=2)
    elif kind == "TUBE":
        mesh.primitive_cylinder_add(vertices=9, end_fill_type="NOTHING")
    elif kind == "TORUS":
        mesh.primitive_torus_add(major_segments=14, minor_segments=8, minor_radius=0.4)
    else:
        mesh.primitive_monkey_add()
    bpy.ops.object.shade_smooth()
    body = bpy.context.object
    if kind == "BOWL":
        body.data.flip_normals()
    return body


def build(kind, scale, offset, lamp_kind):
    """The body from the side of the terminator."""
    scenes.empty_file()
    scenes.plain_world((0, 0, 0))
    scene = bpy.context.scene
    body = add_body(kind)
    body.scale = scale
    scenes.set_shadow_terminator(body, "GEOMETRY", offset)
    material, tree, _ = scenes.material("white")
    scenes.diffuse_alone(tree).inputs[0].default_value = (0.8, 0.8, 0.8, 1)
    body.data.materials.append(material)
    lamp = bpy.data.lights.new("lamp", lamp_kind)
    lamp.energy = 3.0 if lamp_kind == "SUN" else 400.0
    if lamp_kind == "POINT":
        lamp.shadow_soft_size = 0.0
    place = scenes.add(lamp)
    place.location = (-1.9, 0.6, 0.5) if lamp_kind == "POINT" else (0, 0, 0)
    place.rotation_euler = (0.2, -1.35, 0.1)
    if kind == "BOWL":
        place.location, lamp.energy = (0.75, 0.1, 0.2), 20.0
        body.visible_camera = True
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", 2.6
    scene.camera = scenes.add(camera)
    scene.camera.location, scene.camera.rotation_euler = (0, -9, 0), (1.5707963, 0, 0)
    if kind == "BOWL":
        camera.clip_start = 9.1
    both_engines.show_direct_light(scene, SIZE, SAMPLES)
    return scene


if __name__ == "__main__":
    folder, found = Path(sys.argv[1]), {}
    for case, described in CASES.items():
        shown = build(*described)
        found[case] = {}
        for engine in ("CYCLES", "RAYLEAF"):
            path = folder / f"{engine} {case}.exr"
            found[case][engine] = both_engines.means(both_engines.picture(shown, engine, path)[..., :1], 4)
    report(found=found)
