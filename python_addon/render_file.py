"""Renders the file that Blender has open; `rayleaf render` starts Blender with this script.

Each frame becomes a PNG and a multilayer EXR, saved by Blender from its Render Result; or a part of it becomes a file in the
folder OUTPUT.parts, or the pictures are made of those files (rayleaf/parts.py). The add-on adds a line of
statistics for each view layer to the file that RAYLEAF_STATS names; they are printed and, on demand, gathered:
{"file": path, "frames": [{"frame": number, "seconds": s, "png": path, "exr": path, "view_layers": [{…}]}]}.
"""

import argparse
import json
import os
import shutil
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import bpy
from rayleaf import part_render, parts, statistics
from rayleaf.names import name_of
from rayleaf.versions import choose_file_format, compositor


def arguments() -> argparse.Namespace:
    """The arguments that `rayleaf render` puts behind `--`."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--output", type=Path, required=True, help="path of the pictures without ending")
    parser.add_argument("--frame", type=int)
    parser.add_argument("--start", type=int)
    parser.add_argument("--end", type=int)
    parser.add_argument("--stats", type=Path)
    parser.add_argument("--tile", type=parts.Share.parsed)
    parser.add_argument("--sample-range", type=parts.Share.parsed)
    parser.add_argument("--merge", action="store_true")
    return parser.parse_args(sys.argv[sys.argv.index("--") + 1 :])


def frames_and_outputs(options: argparse.Namespace) -> list[tuple[int, Path]]:
    """The frames to render and where each goes, without ending."""
    output: Path = options.output
    if output.suffix.lower() in (".png", ".exr"):
        output = output.with_suffix("")
    scene = bpy.context.scene
    if options.start is None:
        return [(scene.frame_current if options.frame is None else options.frame, output)]
    numbers = range(options.start, options.end + 1, scene.frame_step)
    return [(number, output.with_name(f"{output.name}_{number:04d}")) for number in numbers]


def choose_format(file_format: str, color_depth: str, views_format: str = "INDIVIDUAL") -> None:
    """How pictures are written; `views_format`: how stereoscopic ones are."""
    scene = bpy.context.scene
    settings = scene.render.image_settings
    choose_file_format(settings, file_format)
    settings.color_mode = "RGBA" if scene.render.film_transparent or file_format != "PNG" else "RGB"
    settings.color_depth = color_depth
    settings.views_format = views_format  # which goes back as the format changes


def beside(path: Path) -> Path:
    """Where a picture is written before it gets its name, so that no half file has that."""
    return path.with_name(f".{path.stem}.{os.uname().nodename}.{os.getpid()}{path.suffix}")


def save(path: Path, file_format: str, color_depth: str, views_format: str = "INDIVIDUAL") -> None:
    """Save Blender's Render Result."""
    scene, unnamed, shown = bpy.context.scene, beside(path), bpy.data.images["Render Result"]
    choose_format(file_format, color_depth, views_format)
    try:
        if views_format != "INDIVIDUAL":
            shown.views_format = views_format  # which Blender asks here
        shown.save_render(str(unnamed), scene=scene)
        if not unnamed.is_file():
            raise RuntimeError(f"Blender did not write {unnamed}")
        unnamed.replace(path)
    finally:
        unnamed.unlink(missing_ok=True)


def view_suffixes() -> list[str]:
    """Of the files of stereoscopic pictures, a file a view."""
    render = bpy.context.scene.render
    shown = [view for view in render.views if view.use]
    if render.views_format == "STEREO_3D":
        shown = [view for view in shown if name_of(view) in ("left", "right")]
    return [view.file_suffix for view in shown]


def save_views(path: Path, views_format: str) -> list[Path]:
    """Save what each view of the Render Result shows as a PNG; or as one, where the file's settings put both into one."""
    if views_format == "STEREO_3D":
        save(path, "PNG", "8", views_format)
        return [path]
    choose_format("PNG", "8")
    unnamed, saved = beside(path), []
    try:
        bpy.data.images["Render Result"].save_render(str(unnamed), scene=bpy.context.scene)
    except RuntimeError:  # Blender 3.4 writes these files and says that it could not write one without a suffix
        pass
    for suffix in view_suffixes():
        written = unnamed.with_name(f"{unnamed.stem}{suffix}{unnamed.suffix}")
        saved.append(path.with_name(f"{path.stem}{suffix}{path.suffix}"))
        written.replace(saved[-1])
    return saved


def render_views(frame: int, png: Path, exr: Path, statistics_path: Path) -> tuple[list[dict[str, Any]], list[Path]]:
    """Render a stereoscopic frame. Blender puts all views into one EXR only where it writes it as it renders."""
    scene, unnamed = bpy.context.scene, beside(exr)
    of_file = scene.render.image_settings.views_format
    choose_format("OPEN_EXR_MULTILAYER", "32", "MULTIVIEW")
    scene.render.filepath = str(unnamed)
    try:
        layers = rendered_layers(frame, statistics_path, write_still=True)
        saved = save_views(png, of_file)
        unnamed.replace(exr)
    finally:
        unnamed.unlink(missing_ok=True)
    return layers, saved


def with_ending(output: Path, ending: str) -> Path:
    """`output` with an ending; a name with a dot in it keeps it."""
    return output.with_name(output.name + ending)


def rendered_layers(frame: int, statistics_path: Path, write_still: bool = False) -> list[dict[str, Any]]:
    """Render one frame in Blender; what happened to each view layer. `write_still`: Blender writes the picture.

    Which layers a frame is made of Blender knows: compositor and sequencer may show other scenes, or none."""
    statistics_path.write_text("")
    asked: set[tuple[str, str]] = set()
    statistics.asked = asked
    bpy.context.scene.frame_set(frame)
    bpy.ops.render.render(write_still=write_still)
    layers = [json.loads(line) for line in statistics_path.read_text().splitlines()]
    missing = asked - {(layer["scene"], layer["view_layer"]) for layer in layers if layer["completed"]}
    if missing:
        names = ", ".join(f"'{layer}' of scene '{scene}'" for scene, layer in sorted(missing))
        raise RuntimeError(f"frame {frame}: not rendered: {names}; the messages above say why")
    if part_render.task is not None and not asked:
        raise RuntimeError(f"frame {frame}: its picture is made without Rayleaf, so that it has no parts")
    return layers


def render(frame: int, output: Path, statistics_path: Path) -> dict[str, Any]:
    """Render one frame, save it, and tell what happened."""
    started = time.perf_counter()
    png, exr = with_ending(output, ".png"), with_ending(output, ".exr")
    output.parent.mkdir(parents=True, exist_ok=True)
    if bpy.context.scene.render.use_multiview:
        layers, pngs = render_views(frame, png, exr, statistics_path)
    else:
        layers, pngs = rendered_layers(frame, statistics_path), [png]
        save(png, "PNG", "8")
        save(exr, "OPEN_EXR_MULTILAYER", "32")
    seconds = time.perf_counter() - started
    # Of a stereoscopic frame `pngs` lists a picture for each view.
    files: dict[str, Any] = {
        "png": str(pngs[0]),
        "exr": str(exr),
        **({"pngs": list(map(str, pngs))} if len(pngs) > 1 else {}),
    }
    return {"frame": frame, "seconds": seconds, **files, "view_layers": layers}


def parts_folder(output: Path) -> Path:
    """Where the parts of a frame lie."""
    return with_ending(output, ".parts")


def mute_file_outputs(tree: Any) -> None:
    """The compositor writes no files of a picture that is not whole."""
    for node in tree.nodes if tree is not None else ():
        if node.type == "OUTPUT_FILE":
            node.mute = True
        elif node.type == "GROUP":
            mute_file_outputs(node.node_tree)


def render_part(frame: int, output: Path, cut: parts.Cut, statistics_path: Path) -> dict[str, Any]:
    """Render a part of a frame into its file, unless it has been."""
    started = time.perf_counter()
    source = parts.source_of(Path(bpy.data.filepath), frame)
    path = parts.path_in(parts_folder(output), cut)
    layers = []
    if not parts.is_finished(path, source):
        mute_file_outputs(compositor(bpy.context.scene))
        part_render.task = task = part_render.PartTask(cut)
        layers = rendered_layers(frame, statistics_path)
        parts.write(path, source, cut, task.layers)
    return {"frame": frame, "seconds": time.perf_counter() - started, "part": str(path), "view_layers": layers}


def merge(frame: int, output: Path, statistics_path: Path) -> dict[str, Any]:
    """Make a frame's pictures of its parts, which are not needed any more then."""
    folder = parts_folder(output)
    found = parts.Parts(folder, parts.source_of(Path(bpy.data.filepath), frame))
    part_render.task = part_render.MergeTask(found)
    done = render(frame, output, statistics_path)
    shutil.rmtree(folder)
    return done


def readable(value: Any) -> str:
    """A number as people read it."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, int):
        return f"{value:,}"
    if isinstance(value, float):
        return f"{value:.4g}" if abs(value) < 1e4 else f"{value:,.0f}"
    return str(value)


def summary(statistics: dict[str, Any], indent: int = 2) -> list[str]:
    """The statistics as lines of text, one level of nesting a step of indentation."""
    lines = []
    plain = [str(key) for key, value in statistics.items() if not isinstance(value, (dict, list))]
    width = max(map(len, plain), default=0)
    for key, value in statistics.items():
        name = str(key).replace("_", " ")
        if isinstance(value, dict):
            lines += [f"{' ' * indent}{name}:"] + summary(value, indent + 2) if value else []
        elif isinstance(value, list):
            lines += (
                [f"{' ' * indent}{name}:"] + [f"{' ' * indent}  {readable(item)}" for item in value] if value else []
            )
        else:
            lines.append(f"{' ' * indent}{name:<{width}}  {readable(value)}")
    return lines


def rendered(options: argparse.Namespace, frame: int, output: Path, statistics_path: Path) -> dict[str, Any]:
    """What the options ask for, of one frame."""
    if options.merge:
        return merge(frame, output, statistics_path)
    if options.tile or options.sample_range:
        whole = parts.Share(1, 1)
        cut = parts.Cut(options.tile or whole, options.sample_range or whole)
        return render_part(frame, output, cut, statistics_path)
    return render(frame, output, statistics_path)


def main() -> None:
    options = arguments()
    if bpy.context.scene.render.engine != "RAYLEAF":  # Blender takes another where an engine is missing
        raise RuntimeError("Blender does not know the engine RAYLEAF; the messages above say why")
    done = []
    with tempfile.TemporaryDirectory() as folder:
        statistics_path = Path(folder) / "statistics.json"
        os.environ["RAYLEAF_STATS"] = str(statistics_path)
        for frame, output in frames_and_outputs(options):
            done.append(rendered(options, frame, output, statistics_path))
            paths = [done[-1][kind] for kind in ("png", "exr", "part") if kind in done[-1]] + done[-1].get("pngs", [])[
                1:
            ]
            files = "\n".join(f"  {path}" for path in paths)
            print(f"\nframe {frame}: {done[-1]['seconds']:.2f} s\n{files}")
            for layer in done[-1]["view_layers"]:
                print("\n".join(summary(layer)), flush=True)
    if options.stats:
        options.stats.parent.mkdir(parents=True, exist_ok=True)
        options.stats.write_text(json.dumps({"file": bpy.data.filepath, "frames": done}, indent=2) + "\n")


if __name__ == "__main__":
    try:
        main()
    except (
        RuntimeError,
        OSError,
        parts.PartError,
    ) as error:  # of Blender's operators, and a full disk: no traceback needed
        sys.exit(f"rayleaf: rendering failed: {str(error).strip()}")
