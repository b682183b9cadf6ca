"""Renders a bevelled ring's coverage in both engines; started inside a background Blender by `silhouettes`."""

import json
import sys
from pathlib import Path
from typing import Any

import bpy
import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
import render_points  # noqa: E402  (beside this script)

SAMPLES, EXACT_SAMPLES = 64, 1024


def ring() -> Any:
    """A circle of four Bezier points with a round bevel, tilted, in front of nothing; the camera above."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="rayleaf")
    bpy.ops.curve.primitive_bezier_circle_add(radius=1.0, rotation=(0.5, 0.3, 0.0))
    curve = bpy.context.object.data
    curve.bevel_depth, curve.bevel_resolution = 0.25, 32
    bpy.ops.object.camera_add(location=(0.0, 0.0, 4.0))
    scene = bpy.context.scene
    scene.camera = bpy.context.object
    scene.render.film_transparent = True
    return curve


def render_mask(engine: str, samples: int, job: dict[str, Any], number: int, resolution: int) -> dict[str, Any]:
    """Coverage, time and memory."""
    point = {
        "name": str(number),
        "engine": engine,
        "assign": {f"{'rayleaf' if engine == 'RAYLEAF' else 'cycles'}.samples": samples},
    }
    raw = render_points.render_point(point, {"folder": job["folder"], "repeats": 1, "addon": "rayleaf"}, number)
    if "problem" in raw:
        raise RuntimeError(raw["problem"])
    mask = Path(job["folder"]) / f"mask_{number:03d}.npy"
    np.save(mask, np.load(raw["picture"])[..., 3])
    return {"engine": engine, "resolution": resolution, "seconds": raw["seconds"][0], "memory_mb": raw["memory_mb"],
            "mask": str(mask)}  # fmt: skip


def main() -> None:
    job = json.loads(Path(sys.argv[-1]).read_text(encoding="utf-8"))
    curve = ring()
    scene = bpy.context.scene
    scene.render.resolution_x = scene.render.resolution_y = job["width"]
    scene.render.resolution_percentage = 100
    results = [render_mask("RAYLEAF", EXACT_SAMPLES, job, 0, 0), render_mask("RAYLEAF", SAMPLES, job, 1, 0)]
    scene.render.engine = "CYCLES"
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    for number, resolution in enumerate(job["resolutions"], start=2):
        curve.resolution_u = resolution
        curve.bevel_resolution = max(0, resolution // 2)
        results.append(render_mask("CYCLES", SAMPLES, job, number, resolution))
    (Path(job["folder"]) / "result.json").write_text(json.dumps(results), encoding="utf-8")


if __name__ == "__main__":
    main()
