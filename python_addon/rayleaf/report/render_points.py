"""Renders one file with many settings; started inside a background Blender by `measure`.

    blender -b FILE --addons rayleaf --python render_points.py -- JOB.json RESULT.json

The job: what `measure.Conditions` holds, and {"folder": path, "addon": its module, "points": [{"name", "engine",
"assign": {path: value}, "told": {name: path}, "needs": a kind of shape, or ""}]}. The
result, a list in the same order: {"name", "seconds": [each repeat], "processor_seconds": of all threads, "memory_mb":
peak above what was there before, "picture": NPY file of (height, width, 4), scene-linear, rows bottom to top, "told":
{name: value}, "statistics": the add-on's, or {}, "layers": with all passes, a multilayer EXR}.
A point whose property this version does not have is left out of the pictures and says so: {"name", "problem"}. One that
needs shapes that the scene does not hold is {"name"} alone.
"""

import gc
import importlib
import json
import math
import sys
import time
from pathlib import Path
from types import ModuleType
from typing import Any

import bpy
import numpy as np


# A point that took so long is not repeated: slow frames vary little, in shares of their time.
_ENOUGH_SECONDS = 8.0


def assign(scene: Any, path: str, value: Any) -> None:
    """Set the property that a dotted path names. Raises AttributeError where there is none."""
    owner = scene
    *owners, name = path.split(".")
    for each in owners:
        owner = getattr(owner, each)
    if not hasattr(owner, name):
        raise AttributeError(f"{path} is no setting of this version")
    setattr(owner, name, value)


def value_of(scene: Any, path: str) -> Any:
    """The property that a dotted path names. Raises AttributeError where there is none."""
    owner = scene
    for each in path.split("."):
        owner = getattr(owner, each)
    return owner


def remembered(scene: Any, paths: list[str]) -> dict[str, Any]:
    """The values of properties that exist, to be put back."""
    found: dict[str, Any] = {}
    for path in paths:
        owner = scene
        for each in path.split("."):
            owner = getattr(owner, each, None)
        if owner is not None:
            found[path] = owner
    return found


def forget_peak() -> None:
    """Make the peak of the process start again from what is used now (Linux)."""
    gc.collect()
    Path("/proc/self/clear_refs").write_text("5", encoding="utf-8")


def versions(addon: str) -> ModuleType:
    """What the add-on knows of Blender's versions."""
    return importlib.import_module(f"{addon}.versions")


def rendered_pixels(folder: Path, scene: Any, addon: str) -> Any:
    """Combined of the Render Result, by way of a 32-bit EXR: the one way that works without a window."""
    path = folder / "pixels.exr"
    settings = scene.render.image_settings
    versions(addon).choose_file_format(settings, "OPEN_EXR")
    settings.color_mode, settings.color_depth = "RGBA", "32"
    bpy.data.images["Render Result"].save_render(str(path), scene=scene)
    image = bpy.data.images.load(str(path))
    try:
        image.colorspace_settings.is_data = True
        image.alpha_mode = "CHANNEL_PACKED"
        pixels = np.empty(image.size[0] * image.size[1] * 4, dtype=np.float32)
        image.pixels.foreach_get(pixels)
        return pixels.reshape(image.size[1], image.size[0], 4)
    finally:
        bpy.data.images.remove(image)


def switch_on_all_passes(addon: str) -> None:
    """Every pass that the add-on has, in the view layer that is rendered."""
    passes = importlib.import_module(f"{addon}.passes")
    layer = bpy.context.view_layer
    for entry in passes.table():
        if entry.switch:
            owner, name = entry.place(layer)
            if hasattr(owner, name):
                setattr(owner, name, True)


def saved_layers(path: Path, scene: Any, addon: str) -> str:
    """The Render Result as a multilayer EXR."""
    versions(addon).choose_file_format(scene.render.image_settings, "OPEN_EXR_MULTILAYER")
    bpy.data.images["Render Result"].save_render(str(path), scene=scene)
    return str(path)


class Clock:
    """Seconds of renders: those that passed, and the processor time of all threads."""

    def __init__(self) -> None:
        self.passed: list[float] = []
        self.processor: list[float] = []
        self._began = (0.0, 0.0)

    def start(self, *_: Any) -> None:
        self._began = time.perf_counter(), time.process_time()

    def stop(self, *_: Any) -> None:
        self.passed.append(time.perf_counter() - self._began[0])
        self.processor.append(time.process_time() - self._began[1])


def turn_camera(frames: int, addon: str) -> None:
    """Make an animation of so many frames in which the camera turns about the world's z axis, a degree a frame."""
    scene = bpy.context.scene
    axis, top = bpy.data.objects.new("axis", None), scene.camera
    scene.collection.objects.link(axis)
    while top.parent is not None:
        top = top.parent
    top.parent = axis
    first, last = scene.frame_current, scene.frame_current + frames - 1
    scene.frame_start, scene.frame_end, scene.frame_step = first, last, 1
    for frame, angle in ((first, 0.0), (last, math.radians(frames - 1))):
        axis.rotation_euler.z = angle
        axis.keyframe_insert("rotation_euler", index=2, frame=frame)
    for key in versions(addon).animation_curves(axis)[0].keyframe_points:
        key.interpolation = "LINEAR"


def render_animation(folder: Path, clock: Clock, addon: str) -> None:
    """All frames; what is timed is neither the change of frames nor the writing of files."""
    scene, handlers = bpy.context.scene, bpy.app.handlers
    versions(addon).choose_file_format(scene.render.image_settings, "OPEN_EXR")
    scene.render.filepath = str(folder / "frame_")
    handlers.render_pre.append(clock.start)
    handlers.render_post.append(clock.stop)
    try:
        bpy.ops.render.render(animation=True)
    finally:
        handlers.render_pre.remove(clock.start)
        handlers.render_post.remove(clock.stop)


def render_still(job: dict[str, Any], clock: Clock) -> None:
    """The same picture, so often as the job says."""
    if job.get("orbit"):
        bpy.context.scene.frame_set(bpy.context.scene.frame_end)
    for _ in range(job["repeats"]):
        if sum(clock.passed) > _ENOUGH_SECONDS and not job.get("cold"):
            break
        clock.start()
        bpy.ops.render.render()
        clock.stop()


def render_point(point: dict[str, Any], job: dict[str, Any], number: int) -> dict[str, Any]:
    """One point, rendered as often as the job says."""
    scene, folder = bpy.context.scene, Path(job["folder"])
    before = remembered(scene, list(point["assign"]))
    try:
        scene.render.engine = point["engine"]
        for path, value in point["assign"].items():
            assign(scene, path, value)
        forget_peak()
        process_memory = importlib.import_module(f"{job['addon']}.statistics").process_memory
        at_start = process_memory()[0]
        clock = Clock()
        if job.get("orbit") and job["repeats"] > 1:
            render_animation(folder, clock, job["addon"])
        else:
            render_still(job, clock)
        memory = process_memory()[1] - at_start
        picture = folder / f"{number:03d}.npy"
        np.save(picture, rendered_pixels(folder, scene, job["addon"]))
        layers = saved_layers(folder / f"{number:03d}.exr", scene, job["addon"]) if job.get("all_passes") else ""
        addon = sys.modules.get(job["addon"])
        statistics = dict(getattr(addon, "last_statistics", {})) if point["engine"] == "RAYLEAF" else {}
        return {
            "name": point["name"],
            "seconds": clock.passed,
            "processor_seconds": clock.processor,
            "memory_mb": memory,
            "picture": str(picture),
            "layers": layers,
            "told": {name: value_of(scene, path) for name, path in point.get("told", {}).items()},
            "statistics": json.loads(json.dumps(statistics, default=str)),
        }
    except (AttributeError, TypeError) as error:  # a setting that this version lacks, or a value that it does not take
        return {"name": point["name"], "problem": str(error)}
    finally:
        for path, value in before.items():
            assign(scene, path, value)


def warm_up(point: dict[str, Any], job: dict[str, Any]) -> None:
    """Load what an engine loads once, with one tiny picture, so that no point pays for it."""
    render = bpy.context.scene.render
    size = render.resolution_x, render.resolution_y, render.resolution_percentage
    render.resolution_x, render.resolution_y, render.resolution_percentage = 8, 8, 100
    render_point(point, {**job, "repeats": 1, "all_passes": False}, 0)
    render.resolution_x, render.resolution_y, render.resolution_percentage = size


def shapes_of_scene(job: dict[str, Any]) -> set[str]:
    """The kinds of shapes in the last picture of the add-on."""
    statistics = getattr(sys.modules.get(job["addon"]), "last_statistics", {})
    return set(statistics.get("core", {}).get("shape_bytes", {}))


def set_up(job: dict[str, Any]) -> None:
    """What all points have in common."""
    render = bpy.context.scene.render
    render.resolution_percentage = 100 if job["width"] else job["percentage"]
    if job["width"]:
        height = max(1, round(job["width"] * render.resolution_y / render.resolution_x))
        render.resolution_x, render.resolution_y = job["width"], height
    render.use_file_extension, render.use_compositing, render.use_sequencer = True, False, False
    if job["threads"]:
        render.threads_mode, render.threads = "FIXED", job["threads"]
    if job["orbit"]:
        turn_camera(job["orbit"], job["addon"])
    if job["all_passes"]:
        switch_on_all_passes(job["addon"])


def main() -> None:
    job_path, result_path = (Path(argument) for argument in sys.argv[sys.argv.index("--") + 1 :][:2])
    job = json.loads(job_path.read_text(encoding="utf-8"))
    set_up(job)
    for engine in sorted({point["engine"] for point in job["points"]} if not job["cold"] else ()):
        warm_up(next(point for point in job["points"] if point["engine"] == engine), job)
    results: list[dict[str, Any]] = []
    held = shapes_of_scene(job)
    for number, point in enumerate(job["points"]):
        needed = not point["needs"] or point["needs"] in held
        results.append(render_point(point, job, number) if needed else {"name": point["name"]})
        result_path.write_text(json.dumps(results), encoding="utf-8")


if __name__ == "__main__":
    main()
