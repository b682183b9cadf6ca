"""What `blender --command extension` of a real Blender says to the extension: it is checked, built again, listed, and installed."""

import os
import subprocess
import zipfile
from pathlib import Path

import blenders

_RENDER = """
import sys, bpy
bpy.context.scene.render.engine = "RAYLEAF"
bpy.context.scene.render.resolution_percentage = 5
bpy.context.scene.rayleaf.samples = 1
bpy.ops.render.render()
import importlib
print("RENDERED", importlib.import_module(sys.argv[-1]).last_statistics["completed"])
"""


class Commands:
    """Commands of one Blender, with a user's folders of their own."""

    def __init__(self, blender: blenders.Blender, folder: Path) -> None:
        self._blender = blender
        self._folders = {
            f"BLENDER_USER_{kind}": str(folder / kind.lower())
            for kind in ("CONFIG", "SCRIPTS", "EXTENSIONS", "DATAFILES")
        }
        for each in self._folders.values():
            Path(each).mkdir(parents=True)

    def start(self, *arguments: object, before: tuple[str, ...] = ()) -> str:
        """What Blender prints; with its exit code where that is not 0. `before`: words in front of its command line."""
        command = [*before, str(self._blender.program), *map(str, arguments)]
        done = subprocess.run(
            command,
            env=os.environ | self._folders,
            capture_output=True,
            text=True,
            timeout=600,
            stdin=subprocess.DEVNULL,
        )
        return done.stdout + done.stderr + (f"\nexit code {done.returncode}" if done.returncode else "")

    def extension(self, *arguments: object) -> str:
        """The same of `--command extension`."""
        return self.start("--online-mode", "--command", "extension", *arguments)

    def where_nothing_can_be_written(self, *arguments: object) -> str:
        """`extension`, with a folder for extensions on a file system that is read alone."""
        script = 'mount --bind "$0" "$0" && mount -o remount,bind,ro "$0" && exec "$@"'
        before = ("unshare", "--mount", "sh", "-c", script, self._folders["BLENDER_USER_EXTENSIONS"])
        return self.start("--online-mode", "--command", "extension", *arguments, before=before)

    def render(self, module: str) -> str:
        """What is said where an extension is to render."""
        return self.start("--background", "--addons", module, "--python-expr", _RENDER, "--", module)

    def renders(self, module: str) -> bool:
        """Whether it does."""
        return "RENDERED True" in self.render(module)


def faults(blender: blenders.Blender, extension: Path, folder: Path) -> list[str]:
    """Of each command that does not do as it should, what it said."""
    source, built, listed = folder / "source", folder / "built", folder / "listed"
    for each in (source, built, listed):
        each.mkdir(parents=True)
    with zipfile.ZipFile(extension) as archive:
        archive.extractall(source)
    (listed / extension.name).write_bytes(extension.read_bytes())
    commands, found = Commands(blender, folder / "user"), []
    for wanted, *arguments in (
        ("Success parsing TOML", "validate", extension),
        ("created: ", "build", "--source-dir", source, "--output-dir", built),
        ("found 1 packages", "server-generate", "--repo-dir", listed),
        ('Installed "rayleaf"', "install-file", "--repo", "user_default", "--enable", extension),
    ):
        if wanted not in (said := commands.extension(*arguments)):
            found.append(f"extension {arguments[0]}: {said}")
    if not commands.renders("bl_ext.user_default.rayleaf"):
        found.append("extension install-file: what it installs does not render")
    commands.extension("remove", "user_default.rayleaf")
    commands.extension("repo-remove", "blender_org")  # which `sync` would ask, over the network
    commands.extension("repo-add", "--url", f"file://{listed}/index.json", "local")
    commands.extension("sync")
    if 'Installed "rayleaf"' not in (said := commands.extension("install", "--enable", "local.rayleaf")):
        found.append(f"extension install: {said}")
    if not commands.renders("bl_ext.local.rayleaf"):
        found.append("extension install: what it installs from a repository does not render")
    return found
