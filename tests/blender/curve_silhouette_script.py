"""Inside Blender: compares silhouettes of exact curves with those of Blender's meshes at two resolutions.

Arguments: OUT.json ADDONS COARSE FINE FIRST COUNT, the last two the seeds of random curves; without any, the cases of
silhouette_cases.py. Of each case the file holds its name and definition, how many pixels are off, and how many the coarse
mesh is off by; or why the exporter gives the curve as Blender's mesh.
"""

import json
import sys
from pathlib import Path

import bpy

sys.path += [str(Path(__file__).resolve().parent), sys.argv[2]]
import curve_silhouettes  # noqa: E402
from curve_objects import make_curve  # noqa: E402
from random_curves import helper_cases, random_case  # noqa: E402
from rayleaf import _core as core  # noqa: E402
from rayleaf.export import curves  # noqa: E402
from silhouette_cases import silhouette_cases  # noqa: E402


def compared(items, seed):
    """What is found about the same curve at a coarse and a fine resolution."""
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    evaluated = items[1].evaluated_get(depsgraph)
    judged = curves.judge(core, evaluated, evaluated.data)
    judged.settle(core)
    if judged.curve is None:
        return {"reason": judged.reason or judged.problem or "thread"}
    coarse, fine = (curve_silhouettes.mesh_triangles(item, depsgraph) for item in items)
    if len(fine) == 0:
        return {"reason": "Blender draws nothing"}
    shape = core.trace.SweptSurface(judged.curve)
    return curve_silhouettes.off_pixels(core, shape, fine, coarse, seed)


def main(out, resolutions, seeds):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    helpers, cases = [], []
    for resolution in resolutions:
        made = {}
        for case in helper_cases(resolution):
            made[case["name"]] = make_curve(case, made)
        helpers.append(made)
        cases.append([random_case(seed, resolution) for seed in seeds] if seeds else silhouette_cases(resolution))
    results = []
    for number, pair in enumerate(zip(*cases, strict=True)):
        items = [make_curve(case, made) for case, made in zip(pair, helpers, strict=True)]
        results.append({"case": pair[1], **compared(items, number)})
        for item in items:
            bpy.data.objects.remove(item)
    Path(out).write_text(json.dumps(results), encoding="utf-8")


first, count = (int(number) for number in sys.argv[5:7] or (0, 0))
main(sys.argv[1], [int(number) for number in sys.argv[3:5]], range(first, first + count))
