"""Blender's command line for `bpy`, Blender as a Python module: what the tests use of it. BLENDER_OF_MODULE names the launcher.

Understood: --background, --factory-startup, --python-exit-code, --addons, --engine, --python, --python-expr, a .blend file, --.
"""

import os
import sys
import traceback
from collections.abc import Callable

import bpy  # first: it shows Python where Blender's modules are

import addon_utils

_WITHOUT_VALUE = {"--background", "-b", "--factory-startup"}


def run_file(path: str) -> None:
    """As Blender does: as __main__, with the file's name."""
    with open(path, encoding="utf-8") as file:
        code = compile(file.read(), path, "exec")
    exec(code, {"__name__": "__main__", "__file__": path})


def steps(arguments: list[str]) -> tuple[list[Callable[[], object]], int]:
    """What to do, in order, and the exit code of a script that fails."""
    found: list[Callable[[], object]] = []
    exit_code, waiting = 0, iter(arguments)
    for argument in waiting:
        if argument == "--":
            break
        if argument in _WITHOUT_VALUE:
            continue
        if argument.endswith(".blend"):
            found.append(lambda path=argument: bpy.ops.wm.open_mainfile(filepath=path))
            continue
        value = next(waiting)
        match argument:
            case "--python-exit-code":
                exit_code = int(value)
            case "--addons":
                found += [lambda name=name: addon_utils.enable(name) for name in value.split(",")]
            case "--engine" | "-E":
                found.append(lambda: setattr(bpy.context.scene.render, "engine", value))
            case "--python" | "-P":
                found.append(lambda path=value: run_file(path))
            case "--python-expr":
                found.append(lambda text=value: exec(text, {"__name__": "__main__"}))
            case _:
                raise SystemExit(f"this stand-in for Blender does not know {argument}")
    return found, exit_code


def main() -> None:
    bpy.app.binary_path = os.environ["BLENDER_OF_MODULE"]
    sys.argv[0] = bpy.app.binary_path
    todo, exit_code = steps(sys.argv[1:])
    code = 0
    for step in todo:
        try:
            step()
        except SystemExit:
            raise
        except BaseException:
            traceback.print_exc()
            code = exit_code
            if code:
                break
    sys.stdout.flush()
    sys.stderr.flush()
    os._exit(code)  # Blender's module crashes at times when Python takes it apart


if __name__ == "__main__":
    main()
