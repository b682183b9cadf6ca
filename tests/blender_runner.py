"""The fixture `run_blender`: scripts inside `blender --background`, the add-on enabled, nobody's settings touched."""

import json
import os
import subprocess
import textwrap
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest

HELPERS = Path(__file__).resolve().parent / "blender"

# Gives a script `report(name=value, …)`, whose values the test reads as `run.report`, and lets it import helpers that
# lie beside the tests. Blender does not read PYTHONPATH.
PREAMBLE = """
import json, runpy, sys

def report(**values):
    with open({report!r}, "a") as file:
        file.write(json.dumps(values) + "\\n")

sys.path[:0] = [{folder!r}, {helpers!r}]
sys.argv = [{script!r}] + sys.argv[sys.argv.index("--") + 1:]
runpy.run_path({script!r}, init_globals={{"report": report}}, run_name="__main__")
"""


@dataclass
class BlenderRun:
    """What a script left: Blender's log, its exit code, and the values it gave to `report(name=value)`."""

    command: list[str]
    code: int
    log: str
    report: dict[str, Any]


def blender_path() -> str:
    """The Blender under test; BLENDER chooses another."""
    return os.environ.get("BLENDER") or "/usr/bin/blender"


def is_module() -> bool:
    """True if it is Blender as a Python module, which has no window, and loads its libraries when it starts."""
    return bool(os.environ.get("RAYLEAF_BLENDER_IS_MODULE"))


@pytest.fixture
def run_blender(tmp_path: Path, addons: Path) -> Callable[..., BlenderRun]:
    """`run_blender(script, *args, timeout=120, check=True, background=True, env={})` -> BlenderRun.

    script: a Path, or Python source. It runs in a factory-fresh Blender with the add-on enabled, with `args` as
    sys.argv[1:], and answers by `report(name=value, …)`. With `check`, an exit code other than 0 (an exception in the
    script too) or a time-out fails the test and shows Blender's log.
    """
    count = 0

    def run(
        script: Path | str,
        *args: object,
        timeout: float = 120,
        check: bool = True,
        background: bool = True,
        env: dict[str, str] | None = None,
    ) -> BlenderRun:
        nonlocal count
        count += 1
        folder = tmp_path / f"blender{count}"
        folder.mkdir()
        if isinstance(script, str):
            source, script = script, folder / "script.py"
            script.write_text(textwrap.dedent(source))
        report = folder / "report.jsonl"
        preamble = folder / "preamble.py"
        preamble.write_text(
            PREAMBLE.format(report=str(report), script=str(script), folder=str(script.parent), helpers=str(HELPERS))
        )
        command = [blender_path()] + (["--background"] if background else []) + ["--factory-startup"]
        command += ["--python-exit-code", "1", "--addons", "rayleaf", "--python", str(preamble), "--"]
        command += [str(argument) for argument in args]
        scripts = os.environ.get("RAYLEAF_BLENDER_SCRIPTS") or str(addons.parent)
        environment = dict(os.environ, BLENDER_USER_SCRIPTS=scripts)
        for kind in ("CONFIG", "DATAFILES"):
            environment[f"BLENDER_USER_{kind}"] = str(folder / kind.lower())
        environment.update(env or {})
        try:
            done = subprocess.run(
                command,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                errors="replace",
                timeout=timeout * float(os.environ.get("RAYLEAF_PATIENCE", "1")),
            )
        except subprocess.TimeoutExpired as expired:
            log = (expired.stdout or b"").decode(errors="replace")
            pytest.fail(f"Blender took more than {timeout} s\n{' '.join(command)}\n{log}", pytrace=False)
        if check and done.returncode:
            pytest.fail(
                f"Blender ended with exit code {done.returncode}\n{' '.join(command)}\n{done.stdout}", pytrace=False
            )
        lines = report.read_text().splitlines() if report.exists() else []
        values = {key: value for line in lines for key, value in json.loads(line).items()}
        return BlenderRun(command, done.returncode, done.stdout, values)

    return run
