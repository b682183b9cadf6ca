"""The larger scenes of `rayleaf bench frames` hold what they promise, and Rayleaf renders them."""

import pytest

DESCRIBE = """
import runpy, sys
import bpy, numpy as np
import rayleaf

script, folder, *words = sys.argv[1:]
sys.argv = [script, "--", folder, *words]
runpy.run_path(script, run_name="__main__")
scene = bpy.context.scene
objects = list(scene.objects)
splines = [spline for thing in objects if thing.name.startswith("tile") for spline in thing.data.splines]
patches = sum((spline.point_count_u - 3) * (spline.point_count_v - 3) for spline in splines)
plants = sum(len(thing.data.polygons) for thing in objects if thing.instance_type == "FACES")
images = {image.name for image in bpy.data.images if image.users and image.packed_file}
report(
    patches=patches,
    plants=plants,
    images=len(images),
    lamps=sum(thing.type == "LIGHT" for thing in objects),
    cache=scene.rayleaf.geometry_cache_size,
)
scene.render.resolution_x, scene.render.resolution_y, scene.rayleaf.samples = 32, 18, 1
bpy.ops.render.render()
last = rayleaf.last_statistics
report(left_out=last["export"]["left_out"], messages=last["messages"], core=last["core"]["geometry"])
scene.render.image_settings.file_format = "OPEN_EXR"
bpy.data.images["Render Result"].save_render(folder + "/picture.exr", scene=scene)
image = bpy.data.images.load(folder + "/picture.exr")
pixels = np.empty(32 * 18 * 4, np.float32)
image.pixels.foreach_get(pixels)
report(finite=bool(np.isfinite(pixels).all()), brightest=float(pixels.max()), mean=float(pixels.mean()))
"""


@pytest.fixture
def made(root, run_blender, tmp_path):
    """What is in a scene that its script has made, and in its picture."""

    def make(name, *words):
        run = run_blender(DESCRIBE, root / "tests" / "bench" / f"make_{name}.py", tmp_path, *words, timeout=300)
        assert (tmp_path / f"{name}.blend").exists()
        found = run.report
        assert found["finite"] and 0.02 < found["mean"] < 2.0, found
        assert (found["left_out"], found["messages"]) == ({}, []), found
        return found

    return make


@pytest.mark.slow
def test_the_garden_holds_a_hundred_thousand_plants_and_each_is_an_instance(made):
    found = made("garden")
    assert found["plants"] == 100_000
    assert found["core"]["instances"] > 100_000 and found["core"]["shapes"] < 20


@pytest.mark.slow
def test_the_dunes_are_a_million_patches_beside_a_cache_of_thirty_megabytes(made):
    found = made("subpatches")
    assert found["patches"] == 1_000_000 and found["cache"] == 30.0
    assert found["core"]["subpatches"] >= 1_000_000


@pytest.mark.slow
def test_the_interior_has_two_hundred_textures_and_forty_lamps(made):
    found = made("interior", 16)
    assert (found["images"], found["lamps"]) == (200, 40)


def test_the_pictures_of_the_interior_are_all_different(root, monkeypatch):
    monkeypatch.syspath_prepend(str(root / "tests" / "bench"))
    from interior_textures import textures

    pictures = [picture.tobytes() for group in textures(7, 16).values() for picture in group]
    assert len(pictures) == len(set(pictures)) == 200
