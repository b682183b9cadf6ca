"""Tries the packaged zips in every Blender, and prints a table. `rayleaf test compat` runs it; see its --help."""

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree as ElementTree
import zipfile
from dataclasses import dataclass, field
from pathlib import Path

import bad_packages
import blenders
import debian_releases
import extension_commands

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests" / "blender"))
import plain_exr  # noqa: E402

INSTALL = Path(__file__).with_name("install_and_render.py")
# What a foreign Embree, OpenImageIO or OpenSubdiv would spoil: glass, textures, limits of subdivision.
SURROUNDED = ("glass_vase", "studio", "psychedelic_dragons")
# Not asked of later Blenders: tests of the window, of `rayleaf` itself, and of spoilt copies of the development build.
NOT_FOR_THEM = (
    "test_window.py",
    "test_command_line.py",
    "test_run_blender.py",
    "test_enabling.py",
    "test_bench_scenes.py",
)


@dataclass
class Row:
    """What one Blender did with the package."""

    version: str
    installed: str = "no"
    surrounded: str = ""
    scenes: str = ""
    tests: str = ""
    commands: str = ""
    warnings: int = 0
    faults: list[str] = field(default_factory=list)

    def cells(self) -> list[str]:
        """As the table has them."""
        columns = [self.installed, self.surrounded, self.commands, self.scenes, self.tests, str(self.warnings)]
        return [self.version, *columns]


HEADINGS = [
    *("Blender", "installed", "among Blender's libraries", "extension commands"),
    *("scenes as they should be", "tests passed", "warnings"),
]


def environment(user: Path, **more: str) -> dict[str, str]:
    """A user's folders of its own."""
    found = {name: value for name, value in os.environ.items() if not name.startswith(("BLENDER_USER", "LD_PRELOAD"))}
    user.mkdir(parents=True, exist_ok=True)
    folders = {
        f"BLENDER_USER_{kind}": str(user / kind.lower()) for kind in ("CONFIG", "DATAFILES", "EXTENSIONS", "SCRIPTS")
    }
    for folder in folders.values():
        Path(folder).mkdir(exist_ok=True)
    return found | folders | more


def install_and_render(
    row: Row, blender: blenders.Blender, archive: Path, scene: str, folder: Path, preload: str
) -> Path | None:
    """Install if need be, and render; the picture, or None with the fault written down."""
    picture = folder / f"{scene}{'_surrounded' if preload else ''}.exr"
    command = [str(blender.program), "--background", "--factory-startup", "--python-exit-code", "1"]
    command += [
        "--python",
        str(INSTALL),
        "--",
        str(archive),
        str(ROOT / "blend_scenes" / f"{scene}.blend"),
        str(picture),
    ]
    more = {"LD_PRELOAD": preload} if preload else {}
    done = subprocess.run(
        command, env=environment(folder / "user", **more), capture_output=True, text=True, timeout=1200
    )
    results = dict(line.split(" ", 2)[1:] for line in done.stdout.splitlines() if line.startswith("RESULT "))
    row.warnings = max(row.warnings, int(results.get("warnings", 0)))
    if re.search("isn't compatible with|found but not compatible with this system", done.stdout + done.stderr):
        row.installed = f"no: Blender refuses it for its Python {results.get('python')}"
        return None
    wanted = {"installed": "yes", "problem": "none", "self-test": "FINISHED", "completed": "True"}
    if any(results.get(key) != value for key, value in wanted.items()) or not picture.is_file():
        row.faults.append(
            f"{scene}{' among foreign libraries' if preload else ''}: {results}\n{done.stdout}{done.stderr}"
        )
        return None
    row.installed = "yes"
    return picture


def same_pixels(one: Path, other: Path) -> bool:
    """To the bit."""
    first, second = plain_exr.read(one), plain_exr.read(other)
    return first.keys() == second.keys() and all((first[name] == second[name]).all() for name in first)


def try_installing(row: Row, blender: blenders.Blender, archive: Path, folder: Path) -> None:
    """Install as a person does; render with and without Blender's libraries in front."""
    preload = " ".join(map(str, blender.libraries))
    equal = 0
    for scene in SURROUNDED:
        plain = install_and_render(row, blender, archive, scene, folder, "")
        if plain is None or not preload:
            continue
        surrounded = install_and_render(row, blender, archive, scene, folder, preload)
        if surrounded is not None and same_pixels(plain, surrounded):
            equal += 1
        elif surrounded is not None:
            row.faults.append(f"{scene}: another picture among foreign libraries")
    row.surrounded = f"{equal} of {len(SURROUNDED)} same bits" if preload else "its own are not in front"


def run_tests(row: Row, blender: blenders.Blender, scripts: Path, folder: Path, tests: list[str]) -> str:
    """Run pytest with the unpacked add-on in this Blender; "passed of all"."""
    report = folder / f"{Path(tests[0]).name}.xml"
    settings = {"BLENDER": str(blender.program), "RAYLEAF_BLENDER_SCRIPTS": str(scripts)}
    settings["RAYLEAF_PACKAGE_DIR"] = str(scripts / "addons")
    settings["RAYLEAF_PATIENCE"] = "5"  # all cores are busy
    if blender.is_module:
        settings["RAYLEAF_BLENDER_IS_MODULE"] = "1"
    command = [
        sys.executable,
        "-m",
        "pytest",
        "--rootdir",
        str(ROOT),
        "-c",
        str(ROOT / "pyproject.toml"),
        "-q",
        "-n",
        "auto",
    ]
    command += ["-p", "no:cacheprovider", f"--junitxml={report}", *tests]
    subprocess.run(command, env=os.environ | settings, cwd=ROOT, capture_output=True)
    passed = total = 0
    for case in ElementTree.parse(report).iter("testcase"):
        if case.find("skipped") is not None:
            continue
        total += 1
        fault = case.find("failure") if case.find("failure") is not None else case.find("error")
        passed += fault is None
        if fault is not None:
            row.faults.append(f"{case.get('classname')}.{case.get('name')}\n{(fault.text or '')[-1500:]}")
    return f"{passed} of {total}"


def zips() -> tuple[Path, Path]:
    """The extension and the add-on, made now."""
    made = subprocess.run([str(ROOT / "rayleaf"), "package"], check=True, stdout=subprocess.PIPE, text=True).stdout
    extension, add_on = (Path(line.split("  (")[0]) for line in made.splitlines() if line.startswith("/"))
    return extension, add_on


def repository(extension: Path, folder: Path, blender: blenders.Blender) -> Path:
    """A repository index that this Blender's own command has made of the extension, after it has validated it."""
    folder.mkdir()
    (folder / extension.name).write_bytes(extension.read_bytes())
    if blender.has_commands:
        command = [str(blender.program), "--command", "extension", "server-generate", "--repo-dir", str(folder)]
        subprocess.run(command, check=True, capture_output=True)
        return folder / "index.json"
    tool = next(
        blender.program.parent.glob("lib/python*/site-packages/bpy/*/scripts/addons_core/bl_pkg/cli/blender_ext.py")
    )
    python = blender.program.parent / "bin" / "python"
    for arguments in (["validate", str(extension)], ["server-generate", "--repo-dir", str(folder)]):
        subprocess.run([str(python), str(tool), *arguments], check=True, capture_output=True)
    return folder / "index.json"


def tried(blender: blenders.Blender, extension: Path, add_on: Path, quick: bool) -> Row:
    """The row of one Blender. What takes too long is a fault, and leaves the rest of the row empty."""
    row = Row(blender.name)
    with tempfile.TemporaryDirectory() as temporary:
        try:
            fill(row, blender, extension, add_on, quick, Path(temporary))
        except subprocess.TimeoutExpired as expired:
            row.faults.append(f"it took more than {expired.timeout:.0f} s: {' '.join(map(str, expired.cmd))}")
    return row


def fill(row: Row, blender: blenders.Blender, extension: Path, add_on: Path, quick: bool, folder: Path) -> None:
    """Try everything in one Blender."""
    archive = repository(extension, folder / "repository", blender) if blender.has_extensions else add_on
    try_installing(row, blender, archive, folder)
    if row.installed != "yes":
        return
    if blender.has_commands:
        faults = extension_commands.faults(blender, extension, folder / "commands")
        faults += bad_packages.faults(blender, extension, folder / "bad")
        row.faults += faults
        row.commands = "fail" if faults else "accept it"
    scripts = folder / "scripts"
    with zipfile.ZipFile(add_on) as content:
        content.extractall(scripts / "addons")
    row.scenes = run_tests(row, blender, scripts, folder, ["tests/golden/test_golden.py"])
    if not quick:
        left_out = [f"--ignore=tests/blender/{name}" for name in NOT_FOR_THEM]
        row.tests = run_tests(row, blender, scripts, folder, ["tests/blender", *left_out])


def table(rows: list[Row]) -> str:
    """Markdown."""
    lines = [HEADINGS, ["---"] * len(HEADINGS), *(row.cells() for row in rows)]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def main() -> None:
    known = ["debian", *blenders.MODULES, *blenders.RELEASES]
    parser = argparse.ArgumentParser(prog="rayleaf test compat", description=__doc__)
    parser.add_argument("version", nargs="*", choices=[*known, []], help=f"one of {', '.join(known)}; default: all")
    parser.add_argument("--quick", action="store_true", help="without the tests that run inside Blender")
    options = parser.parse_args()
    rows = []
    extension, add_on = zips()
    for version in options.version or known:
        began = time.monotonic()
        try:
            blender = blenders.called(version)
        except debian_releases.Unavailable as reason:
            print(f"{version} is left out: {reason}", file=sys.stderr, flush=True)
            continue
        rows.append(tried(blender, extension, add_on, options.quick))
        faults = rows[-1].faults
        said = [f"--- {blender.name}: {fault}" for fault in faults]
        said.append(f"{blender.name}: {time.monotonic() - began:.0f} s, {len(faults)} faults")
        print(*said, sep="\n", file=sys.stderr, flush=True)
    print(table(rows))
    sys.exit(1 if any(row.faults for row in rows) else 0)


if __name__ == "__main__":
    main()
