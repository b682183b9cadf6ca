"""Colour spaces of images, as the core knows them: a name, and the OpenColorIO configuration that defines it.

The core's OpenColorIO may be older than Blender's, and unable to read its configuration. Blender's own then writes down
what it makes of one space, as a Color Transform Format file, which older ones read too.
"""

import hashlib
import importlib.util
import os
import sys
from importlib.machinery import PathFinder
from pathlib import Path
from types import ModuleType
from typing import Any

import bpy

from ..names import name_of

# What needs no configuration: names in Blender's own, 3.4 and later.
_KNOWN = {
    "sRGB": "SRGB",
    "Linear": "LINEAR",
    "Linear Rec.709": "LINEAR",
    "Linear BT.709": "LINEAR",
    "Non-Color": "NON_COLOR",
    "Raw": "NON_COLOR",
}
# What the core takes an image for where nothing tells its space.
BY_DEFAULT = ("SRGB", "")

# Of one space, for any OpenColorIO 2.
_NAME = "image"
_CONFIGURATION = """\
ocio_profile_version: 2
roles: {scene_linear: light of the scene, default: light of the scene}
displays:
  none: [!<View> {name: none, colorspace: light of the scene}]
colorspaces:
  - !<ColorSpace> {name: light of the scene}
  - !<ColorSpace> {name: image, to_scene_reference: !<FileTransform> {src: space.ctf}}
"""


def _configuration() -> tuple[bool, str]:
    """Whether Blender's colours are by its own configuration of OpenColorIO, and where that, or the other one, is."""
    other = os.environ.get("OCIO", "")
    if os.path.isfile(other):
        return False, other
    folders = [bpy.utils.user_resource("DATAFILES"), bpy.utils.system_resource("DATAFILES")]
    files = [os.path.join(folder, "colormanagement", "config.ocio") for folder in folders if folder]
    return True, next(filter(os.path.isfile, files), files[-1] if files else "config.ocio")


def _open_color_io() -> ModuleType | None:
    """That of Blender, where it comes with one. Blender as a Python module keeps it beside its data."""
    name = "PyOpenColorIO"
    if name not in sys.modules:
        version = f"python{sys.version_info[0]}.{sys.version_info[1]}"
        beside = os.path.join(bpy.utils.resource_path("LOCAL"), "python", "lib", version, "site-packages")
        spec = PathFinder.find_spec(name) or PathFinder.find_spec(name, [beside])
        if spec is None or spec.loader is None:
            return None
        sys.modules[name] = importlib.util.module_from_spec(spec)
        try:
            spec.loader.exec_module(sys.modules[name])
        except ImportError:
            del sys.modules[name]
    return sys.modules.get(name)


def _written_down(configuration: str, space: str) -> str | None:
    """Another configuration, of this space alone, which an older OpenColorIO can read; None where none can be made."""
    library = _open_color_io()
    if library is None:
        return None
    try:
        read = library.Config.CreateFromFile(configuration)
        processor = read.getProcessor(space, "scene_linear").getOptimizedProcessor(library.OPTIMIZATION_LOSSLESS)
        transform = processor.createGroupTransform().write("Color Transform Format", read)
    except library.Exception:
        return None
    # A new place for each content: the core knows a configuration by its place and its text.
    digest = hashlib.sha256(transform.encode()).hexdigest()[:16]
    folder = Path(bpy.app.tempdir) / f"rayleaf_color_{digest}"
    folder.mkdir(exist_ok=True)
    (folder / "space.ctf").write_text(transform, encoding="utf-8")
    path = folder / "config.ocio"
    path.write_text(_CONFIGURATION, encoding="utf-8")
    return str(path)


class ColorSpaces:
    """Those of a render's images."""

    def __init__(self) -> None:
        self._configuration: tuple[bool, str] | None = None  # looked for once
        self._written_down: dict[tuple[str, str], str | None] = {}

    def of(self, image: Any) -> tuple[str, str]:
        """What the core knows it by: a name, and the configuration that it is of, if it needs one."""
        settings = image.colorspace_settings
        name = name_of(settings)
        if getattr(settings, "is_data", False):
            return "NON_COLOR", ""
        if self._configuration is None:
            self._configuration = _configuration()
        own, configuration = self._configuration
        if own and name in _KNOWN:
            return _KNOWN[name], ""
        written = self._written_down.get((name, configuration))
        return (_NAME, written) if written else (name, configuration)

    def for_older(self, space: tuple[str, str]) -> tuple[str, str] | None:
        """The same space, where the core could not read its configuration; None where Blender does not help either."""
        name, configuration = space
        if configuration in self._written_down.values():  # too new for it in that form too
            return None
        if space not in self._written_down:
            self._written_down[space] = _written_down(configuration, name)
        found = self._written_down[space]
        return (_NAME, found) if found else None
