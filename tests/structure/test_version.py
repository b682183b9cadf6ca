"""The version stands in four places, for CMake, old and new Blenders and Python each in its own way."""

import ast
import re

from structure.sources import ADDON, ROOT


def test_all_places_say_the_same_version():
    manifest = re.search(r'^version = "(.+)"$', (ADDON / "blender_manifest.toml").read_text(), re.MULTILINE)
    project = re.search(r"project\(rayleaf VERSION ([\d.]+)", (ROOT / "CMakeLists.txt").read_text())
    values = {
        node.targets[0].id: ast.literal_eval(node.value)
        for node in ast.parse((ADDON / "__init__.py").read_text()).body
        if isinstance(node, ast.Assign) and isinstance(node.targets[0], ast.Name)
    }
    assert manifest and project
    bl_info = ".".join(map(str, values["bl_info"]["version"]))
    assert {manifest[1], project[1], bl_info, values["__version__"]} == {project[1]}
