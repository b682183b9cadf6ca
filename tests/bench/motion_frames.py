"""Runs inside Blender, in the file that is open: something moves in it, and it is rendered sharp and blurred in turn.

Arguments: what moves ("cars", "hair" or "sheet"), engines with commas, samples, percentage of the size, rounds, and the
file for the seconds of all threads: {engine: {"sharp": [...], "blurred": [...]}}.
"""

import json
import sys
import time
from pathlib import Path
from typing import Any

import bpy
from rayleaf import versions

FRAME = 10
DRIVING = (14, 17, 20)  # cars near the camera
METRES = 0.8  # of a car while the shutter is open


def keyed(owner: Any, path: str, first: Any, last: Any, frames: int = 1) -> None:
    """From one value to the other, evenly, `frames` before and after the frame."""
    for value, frame in ((first, FRAME - frames), (last, FRAME + frames)):
        setattr(owner, path, value)
        owner.keyframe_insert(path, frame=frame)
    for curve in versions.animation_curves(owner.id_data):
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


def drive_cars() -> None:
    """Three of them, ahead."""
    for number in DRIVING:
        for part in [thing for thing in bpy.data.objects if thing.name.endswith(f" {number}")]:
            ahead = part.matrix_world.to_3x3().col[0].normalized() * METRES
            middle = part.location.copy()
            keyed(part, "location", middle - ahead, middle + ahead)


def bend(thing: Any, moved: Any) -> None:
    """By a second form of its points."""
    thing.shape_key_add(name="Basis")
    key = thing.shape_key_add(name="bent")
    for point in key.data:
        point.co = moved(point.co)
    keyed(key, "value", 0.0, 1.0)


def comb_hair() -> None:
    """The wind takes the ball's upper half along, and its hair."""
    bend(bpy.data.objects["ball"], lambda place: (place.x + 0.15 * (place.z + 1.0), place.y, place.z))


def wave_sheet() -> None:
    """A NURBS surface in place of the file's sheet, whose control points swing."""
    bpy.ops.surface.primitive_nurbs_surface_surface_add(radius=2.2, location=(0, 0, 0.9))
    sheet = bpy.context.object
    hidden = [thing for thing in bpy.data.objects if thing.type == "SURFACE" and thing != sheet]
    sheet.data.materials.append(hidden[0].data.materials[0] if hidden else None)
    for thing in hidden:
        thing.hide_render = True
    bend(sheet, lambda place: (place.x, place.y, place.z + 0.3 * (1 if place.x > 0 else -1)))


MOVES = {"cars": drive_cars, "hair": comb_hair, "sheet": wave_sheet}


def seconds(scene: Any, engine: str, is_blurred: bool) -> float:
    """Of all threads."""
    scene.render.engine, scene.render.use_motion_blur = engine, is_blurred
    began = time.process_time()
    bpy.ops.render.render()
    return time.process_time() - began


def main() -> None:
    what, engines, samples, percentage, rounds, out = sys.argv[sys.argv.index("--") + 1 :]
    scene = bpy.context.scene
    MOVES[what]()
    scene.frame_set(FRAME)
    scene.render.resolution_percentage, scene.render.motion_blur_shutter = int(percentage), 0.5
    scene.rayleaf.samples = scene.cycles.samples = int(samples)
    scene.rayleaf.ray_interpolation.mode, scene.rayleaf.integrator = "OFF", "PATH"
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    measured: dict[str, Any] = {engine: {"sharp": [], "blurred": []} for engine in engines.split(",")}
    for number in range(int(rounds) + 1):  # the first warms up
        for engine, found in measured.items():
            for name, times in found.items():
                spent = seconds(scene, engine, name == "blurred")
                if number > 0:
                    times.append(spent)
    Path(out).write_text(json.dumps(measured), encoding="utf-8")


main()
