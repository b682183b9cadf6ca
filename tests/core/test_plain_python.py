"""Rayleaf without Blender: what the README shows runs, and pictures come as PPM."""

import re

import numpy as np
import pytest
from core import scenes


def read_ppm(path):
    """(height, width, 3) bytes, top row first."""
    content = path.read_bytes()
    header = re.match(rb"P6\s+(\d+)\s+(\d+)\s+255\s", content)
    width, height = int(header[1]), int(header[2])
    return np.frombuffer(content[header.end() :], np.uint8).reshape(height, width, 3)


def session(core, **settings):
    """A rendered picture of a lamp and a matte floor."""
    scene = core.SceneDescription()
    materials = scene.add_material_list([scene.add_material("matte", scenes.diffuse(core))])
    scene.add_instance("floor", scenes.quad(scene, "floor", 1.0), scenes.matrix(), materials)
    scene.add_lamp("lamp", "POINT", scenes.matrix((0, 0, 2)), (60, 50, 40), radius=0.2)
    scenes.look_down(scene, 3.0, 0.5)
    made = core.Session(scene, core.Settings(**({"width": 12, "height": 8, "samples": 4} | settings)))
    assert made.render()
    return made


def test_a_ppm_is_the_combined_pass_in_srgb_bytes(core, tmp_path):
    made = session(core)
    made.write_ppm(str(tmp_path / "picture.ppm"))
    linear = np.clip(made.pass_pixels("combined")[::-1, :, :3].astype(float), 0.0, 1.0)
    encoded = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)
    got = read_ppm(tmp_path / "picture.ppm")
    assert got.shape == (8, 12, 3) and got.max() > 100
    assert np.abs(got - 255.0 * encoded).max() <= 0.51


def test_supersampling_quiets_a_pixel(core):
    spread = [np.std([session(core, samples=n, seed=s).pass_pixels("combined")[2, 2, 0] for s in range(12)])
              for n in (1, 64)]  # fmt: skip
    assert spread[1] < spread[0] / 3


@pytest.mark.parametrize("name", ["picture.png", "missing folder/picture.ppm", ""])
def test_a_ppm_that_cannot_be_written_is_named(core, tmp_path, name):
    with pytest.raises(core.InputError, match="path.*ppm"):
        session(core).write_ppm(str(tmp_path / name) if name else "")


def test_a_ppm_needs_the_combined_pass(core, tmp_path):
    with pytest.raises(core.InputError, match="Combined"):
        session(core, passes=["depth"]).write_ppm(str(tmp_path / "depth.ppm"))


def test_the_readmes_example_runs(root, tmp_path, monkeypatch):
    text = (root / "README.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    monkeypatch.chdir(tmp_path)
    exec(compile(code.replace("samples=64", "samples=1"), "README.md", "exec"), {})
    picture = read_ppm(tmp_path / "hair.ppm")
    assert picture.shape == (270, 480, 3) and picture.std() > 10
