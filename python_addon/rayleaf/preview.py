"""Previews of materials, worlds and lamps, and their icons: Blender's own small scenes, of which all but what is previewed stays
as it was made."""

from types import ModuleType
from typing import Any

from . import passes, versions
from .export import ExportCancelled
from .export.camera import CropRectangle, frame_of
from .export.scene import SceneExporter
from .messages import Messages
from .session import RenderThread
from .settings import core_settings

# Paths of a preview: what two cores follow in a quarter of a second. So many a pixel at least and at most.
_PATHS = 200_000
_LEAST_SAMPLES, _MOST_SAMPLES = 4, 16
_POLL_SECONDS = 0.01

_parts: dict[str, Any] = {}  # by Blender's preview scene, the core's SceneParts


def forget() -> None:
    """Keep nothing for further previews."""
    _parts.clear()


def render(engine: Any, depsgraph: Any, core: ModuleType) -> None:
    """Render a preview; nothing is told of it, and what is wrong in the scene shows in it."""
    scene = depsgraph.scene_eval
    frame = frame_of(scene)
    crop = CropRectangle(0, 0, frame.width, frame.height)
    combined = next(entry for entry in passes.table() if entry.identifier == "combined")
    parts = _parts.setdefault(scene.name, core.SceneParts())
    exporter = SceneExporter(core, depsgraph, Messages(), engine.test_break, parts)
    try:
        description = exporter.export(frame, needs_uv=False)
    except ExportCancelled:
        return
    settings = core_settings(core, scene, depsgraph.view_layer, frame, crop, [combined])
    samples = min(max(_PATHS // (frame.width * frame.height), _LEAST_SAMPLES), _MOST_SAMPLES)
    settings.update(samples=samples, time_limit=0.0, target_error=0.0, ray_interpolation=core.RayInterpolation())
    session = RenderThread(core, description, core.Settings(**settings))
    try:
        session.start()
        while not session.wait(_POLL_SECONDS):
            if engine.test_break():
                return
        session.raise_error()
        pixels = {versions.pass_name(combined.name): session.pixels(combined.identifier)}
    finally:
        session.close()
    result = engine.begin_result(0, 0, frame.width, frame.height)
    try:
        versions.write_passes(result.layers[0], pixels)
    finally:
        engine.end_result(result)
