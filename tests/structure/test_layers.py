"""The floors of the house: who may include whom. core/README.md says what lives on each."""

import ast
import re
from collections.abc import Iterator
from pathlib import Path

from structure.sources import ADDON, CORE, core_files, python_files

FLOORS = {
    "base": 0,
    "rays": 1,
    "splines": 1,
    "film": 1,
    "geometry": 2,
    "textures": 2,
    "tessellation": 3,
    "shading": 3,
    "trace": 4,
    "lights": 4,
    "ri_tree": 5,
    "scene": 6,
    "integrators": 7,
    "render": 8,
    "python": 9,
}

# Neighbours on one floor that may meet, in this direction only.
WITHIN_A_FLOOR = {("lights", "trace"): "emitting surfaces are found and sampled through the tracer's instances"}

# The files of the add-on that import Blender's modules. The others get what they need handed over, and work (and are
# tested) in plain Python.
MEET_BLENDER = {
    *(
        "animation.py",
        "enabling.py",
        "engine.py",
        "frame.py",
        "kept_messages.py",
        "preferences.py",
        "light_paths.py",
        "properties.py",
        "registration.py",
    ),
    *(
        "ray_interpolation.py",
        "sampling_presets.py",
        "self_test.py",
        "ui.py",
        "ui_debug.py",
        "ui_messages.py",
        "ui_rays.py",
        "denoising.py",
        "ui_camera.py",
        "ui_motion.py",
        "ui_passes.py",
        "ui_view_layer.py",
        "cycles_versions.py",
        "versions.py",
    ),
    *(
        "export/color_spaces.py",
        "report/panel.py",
        "report/render_points.py",
        "report/render_silhouettes.py",
    ),
    *(f"viewport/{name}.py" for name in ("changes", "render_pass", "undo", "values", "viewport")),
}
# The files that import the core; the others get it, or what it made, handed over.
MEET_CORE = {"core_module.py", "report/curve_primitives.py"}

INCLUDE = re.compile(r'^\s*#\s*include\s+"([^"]+)"', re.MULTILINE)


def includes() -> Iterator[tuple[Path, str]]:
    """(file, what it includes in quotes), files relative to core/."""
    for path in core_files():
        for target in INCLUDE.findall(path.read_text()):
            yield path.relative_to(CORE), target


def test_every_folder_of_the_core_has_its_floor():
    folders = {path.relative_to(CORE).parts[0] for path in core_files()}
    assert folders <= set(FLOORS)


def test_a_quoted_include_names_a_file_by_its_path_from_the_core():
    assert [f"{path} includes {target}" for path, target in includes() if not (CORE / target).is_file()] == []


def test_includes_run_downward_only():
    wrong = []
    for path, target in includes():
        here, there = path.parts[0], Path(target).parts[0]
        if here != there and FLOORS[there] >= FLOORS[here] and (here, there) not in WITHIN_A_FLOOR:
            wrong.append(f"{path} (floor {FLOORS[here]}) includes {target} (floor {FLOORS[there]})")
    assert wrong == []


def check_no_circle(graph: dict[str, set[str]]) -> None:
    """Fails with the names of the first circle."""
    finished: set[str] = set()

    def visit(name: str, trail: list[str]) -> None:
        assert name not in trail, " -> ".join([*trail[trail.index(name) :], name])
        if name not in finished:
            for target in graph.get(name, ()):
                visit(target, [*trail, name])
            finished.add(name)

    for name in graph:
        visit(name, [])


def test_no_header_includes_itself_by_a_detour():
    graph: dict[str, set[str]] = {}
    for path, target in includes():
        graph.setdefault(str(path), set()).add(target)
    check_no_circle(graph)


def own_imports(path: Path) -> set[str]:
    """The modules of the add-on, by their paths, that one of them imports anywhere in it, for type checkers too."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.level:
            folder = path.parents[node.level - 1]
            base = folder.joinpath(*node.module.split(".")) if node.module else folder
            for candidate in [base, *(base / alias.name for alias in node.names)]:
                if candidate.with_suffix(".py").exists():
                    found.add(str(candidate.with_suffix(".py").relative_to(ADDON)))
    return found


def test_no_module_of_the_add_on_imports_itself_by_a_detour():
    graph = {str(path.relative_to(ADDON)): own_imports(path) for path in python_files("python_addon/rayleaf")}
    assert graph["export/strands.py"] >= {"export/strand_arrays.py", "export/attributes.py"}
    check_no_circle(graph)


def imports(path: Path) -> set[str]:
    """The top-level packages that a Python file imports anywhere in it."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            names.add(node.module.split(".")[0])
    return names


BLENDER = {"bpy", "mathutils", "bl_ui", "gpu", "addon_utils", "bpy_extras"}


def test_blender_is_met_only_where_the_table_says():
    found = {str(path.relative_to(ADDON)) for path in python_files("python_addon/rayleaf") if imports(path) & BLENDER}
    assert found == MEET_BLENDER


def test_the_core_is_met_only_where_the_table_says():
    pattern = re.compile(
        r"^.*(from [.\w]* import .*\b_core\b|import .*\b_core\b|import_module\(.*_core\b)", re.MULTILINE
    )
    found = {str(p.relative_to(ADDON)) for p in python_files("python_addon/rayleaf") if pattern.search(p.read_text())}
    assert found == MEET_CORE


def test_the_core_knows_nothing_of_what_it_is_measured_against():
    assert [f"{path} includes {target}" for path, target in includes() if target.startswith("rivals/")] == []
