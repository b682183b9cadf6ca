"""Image textures: files, packed and generated pixels, colour spaces; the rendered colours are those Blender means."""

import numpy as np
import plain_exr
import pytest

# A quad that fills the picture shines in the colours of a 2 x 2 image: below red and green, above blue and grey.
SCENE = """
import sys, bpy, scenes, rayleaf
scene = scenes.empty_scene()
render = scene.render
render.resolution_x, render.resolution_y, render.resolution_percentage = 16, 16, 100
render.image_settings.file_format = "OPEN_EXR"
render.image_settings.color_depth, render.image_settings.exr_codec = "32", "NONE"
scene.camera.location, scene.camera.data.type, scene.camera.data.ortho_scale = (0.5, 0.5, 5), "ORTHO", 1
scene.rayleaf.samples = 4
item = scenes.quad()
material, tree, output = scenes.material()
item.data.materials.append(material)
shader, texture = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeTexImage")
texture.interpolation = "Closest"
tree.links.new(texture.outputs["Color"], shader.inputs["Color"])
tree.links.new(shader.outputs[0], output.inputs["Surface"])
folder = sys.argv[1]
PIXELS = [1, 0, 0, 1,  0, 0.5, 0, 1,  0, 0, 0.25, 1,  0.5, 0.5, 0.5, 1]

def picture(name, **settings):
    image = bpy.data.images.new(name, 2, 2, **settings)
    image.pixels.foreach_set(PIXELS)
    return image

def saved(name):
    image = picture(name)
    image.filepath_raw, image.file_format = f"{folder}/{name}.png", "PNG"
    image.save()
    bpy.data.images.remove(image)
    return bpy.data.images.load(f"{folder}/{name}.png")

def shot(image, name):
    texture.image = image
    render.filepath = f"{folder}/{name}.exr"
    bpy.ops.render.render(write_still=True)
    report(**{name: rayleaf.last_statistics["messages"]})

"""


def quadrants(path):
    """The colours of the four quarters' middles: lower left, lower right, upper left, upper right."""
    picture = plain_exr.read(path)
    return [[float(picture[channel][y, x]) for channel in "RGB"] for y in (4, 12) for x in (4, 12)]


def linear(value):
    """sRGB to linear light (IEC 61966-2-1), of 8-bit values."""
    value = np.round(np.array(value) * 255) / 255
    return np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)


COLORS = [[1, 0, 0], [0, 0.5, 0], [0, 0, 0.25], [0.5, 0.5, 0.5]]


def test_files_packed_and_generated_images_render_alike(run_blender, tmp_path):
    lines = """
shot(saved("file"), "file")
packed = saved("packed")
packed.pack()
import os
os.remove(f"{folder}/packed.png")
packed.buffers_free()
shot(packed, "packed")
report(decoded=packed.has_data)
shot(picture("generated"), "generated")
edited = saved("edited")
edited.pixels.foreach_set([0.0] * 16)
edited.pixels.foreach_set(PIXELS)
edited.update()
os.remove(f"{folder}/edited.png")
shot(edited, "edited")
"""
    run = run_blender(SCENE + lines, tmp_path)
    assert not run.report["decoded"]  # Blender need not: the core has
    for name in ("file", "packed", "generated", "edited"):
        assert run.report[name] == [], name
        assert np.allclose(quadrants(tmp_path / f"{name}.exr"), linear(COLORS), atol=2e-3), name


@pytest.mark.parametrize("place", ["file", "packed"])
def test_an_image_of_which_the_end_is_missing_is_named_and_pink(run_blender, tmp_path, place):
    lines = f"""
import os
torn = picture("torn")
torn.scale(64, 64)
torn.filepath_raw, torn.file_format = f"{{folder}}/torn.png", "PNG"
torn.save()
os.truncate(f"{{folder}}/torn.png", os.path.getsize(f"{{folder}}/torn.png") // 2)
loaded = bpy.data.images.load(f"{{folder}}/torn.png")
if {place == "packed"}:
    loaded.pack()
    os.remove(f"{{folder}}/torn.png")
shot(loaded, "shown")
"""
    run = run_blender(SCENE + lines, tmp_path)
    (text,) = run.report["shown"]
    assert "torn.png" in text and text.endswith("rendered pink")
    assert np.allclose(quadrants(tmp_path / "shown.exr"), [[1, 0, 1]] * 4, atol=2e-3)


def test_colour_spaces_and_float_images_mean_what_blender_means(run_blender, tmp_path):
    lines = """
for space, name in (("Non-Color", "data"), (scenes.LINEAR, "linear")):
    image = saved(name)
    image.colorspace_settings.name = space
    shot(image, name)
shot(picture("float", float_buffer=True), "float")
image = saved("strange")
image.colorspace_settings.name = scenes.XYZ
shot(image, "strange")
from rayleaf.export import color_spaces
color_spaces._configuration = lambda: (True, f"{folder}/gone.ocio")
scene.rayleaf.seed += 1
other = saved("lost")
other.colorspace_settings.name = scenes.XYZ
shot(other, "lost")
"""
    run = run_blender(SCENE + lines, tmp_path)
    for name in ("data", "linear", "float"):
        assert np.allclose(quadrants(tmp_path / f"{name}.exr"), COLORS, atol=3e-3), name
    assert run.report["strange"] == []
    (text,) = run.report["lost"]
    assert "lost.png" in text and "XYZ" in text and "gone.ocio" in text and "taken as sRGB" in text
    assert np.allclose(quadrants(tmp_path / "lost.exr"), linear(COLORS), atol=2e-3)


@pytest.mark.parametrize("extension", ["REPEAT", "EXTEND", "CLIP"])
def test_what_lies_beyond_an_image_is_as_its_node_says(run_blender, tmp_path, extension):
    lines = f"""
texture.extension = {extension!r}
mapping, uv = tree.nodes.new("ShaderNodeMapping"), tree.nodes.new("ShaderNodeTexCoord")
mapping.inputs["Location"].default_value = (1, 0, 0)
tree.links.new(uv.outputs["UV"], mapping.inputs["Vector"])
tree.links.new(mapping.outputs[0], texture.inputs["Vector"])
shot(saved("beyond"), "beyond")
"""
    run_blender(SCENE + lines, tmp_path)
    red, green, blue, grey = linear(COLORS)
    expected = {"REPEAT": [red, green, blue, grey], "EXTEND": [green, green, grey, grey], "CLIP": np.zeros((4, 3))}
    assert np.allclose(quadrants(tmp_path / "beyond.exr"), expected[extension], atol=2e-3)


def test_a_sequence_of_images_shows_the_frames_picture(run_blender, tmp_path):
    lines = """
for number in (1, 2):
    image = saved(f"step_{number:04d}")
    bpy.data.images.remove(image)
image = bpy.data.images.load(f"{folder}/step_0001.png")
image.source = "SEQUENCE"
texture.image = image
texture.image_user.frame_duration, texture.image_user.frame_start = 2, 1
import recording_core
paths = []
for frame in (1, 2):
    scene.frame_set(frame)
    paths.append(recording_core.export()[0].images[0]["path"])
report(paths=paths)
"""
    run = run_blender(SCENE + lines, tmp_path)
    assert [path.rsplit("/", 1)[1] for path in run.report["paths"]] == ["step_0001.png", "step_0002.png"]
