"""Settings that oracles make for Cycles and Rayleaf alike, and the picture of either. Inside Blender."""

import bpy
import numpy as np
import plain_exr
import scenes


def engines(scene):
    """The settings of either, which share names."""
    return scene.cycles, scene.rayleaf


def set_alike(scene, **values):
    """Settings that both have by one name."""
    for own in engines(scene):
        for name, value in values.items():
            setattr(own, name, value)


def sample_plainly(scene, samples):
    """As many samples in each pixel, and nothing that trades light for less noise."""
    set_alike(scene, samples=samples)
    scene.cycles.use_adaptive_sampling = scene.cycles.use_denoising = False
    scene.cycles.sample_clamp_indirect = scene.rayleaf.clamp_indirect = 0.0
    if hasattr(scene.cycles, "use_light_tree"):  # 3.5
        # With it, hair that mirrors lamps is still far too bright after a thousand samples: its oracle would not converge.
        scene.cycles.use_light_tree = False


def without_blur(scene):
    """Narrow lobes stay narrow after wide scattering (Filter Glossy)."""
    blur(scene, 0.0)


def blur(scene, amount):
    """Filter Glossy."""
    scene.cycles.blur_glossy = scene.rayleaf.filter_glossy = amount


def filter_by_box(scene, width=1.0):
    """Pixels that are means over squares. Cycles' box is a pixel wide."""
    scene.cycles.pixel_filter_type = scene.rayleaf.filter_type = "BOX"
    scene.rayleaf.filter_width = width


def channels(scene, engine, path):
    """All channels of a render as plain_exr reads them; `scenes.write_layers` says the format."""
    scene.render.engine, scene.render.filepath = engine, str(path)
    bpy.ops.render.render(write_still=True)
    return plain_exr.read(path)


def color(by_name, layer="Combined", letters="RGB"):
    """One pass as an array by row (bottom to top), column and channel."""
    return np.stack([by_name[f"ViewLayer.{layer}.{letter}"] for letter in letters], -1)


def picture(scene, engine, path):
    """Colour and alpha by row (bottom to top), column and channel."""
    return color(channels(scene, engine, path), letters="RGBA").astype(np.float64)


def means(picture, side):
    """Means over the parts of a square picture that are `side` pixels wide and high, by channel."""
    cells = len(picture) // side
    return picture.reshape(cells, side, cells, side, -1).mean((1, 3)).ravel().tolist()


def look_straight_down(scene, width, pixels):
    """A square picture of what stands around the origin, `width` wide, of few samples; nothing behind it."""
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", width
    scene.camera = scenes.add(camera)
    scene.camera.location = (0, 0, 5)
    scene.render.resolution_x = scene.render.resolution_y = pixels
    scene.render.film_transparent = True
    scenes.write_layers()
    sample_plainly(scene, 4)
    filter_by_box(scene)


def white_floor(size):
    """A diffuse floor seen from straight above, `size` wide in the picture, without any light."""
    scenes.plain_world((0, 0, 0))
    floor = scenes.quad("floor")
    floor.location, floor.scale = (-50, -50, 0), (100, 100, 1)
    material, tree, _ = scenes.material("white")
    scenes.diffuse_alone(tree).inputs[0].default_value = (1, 1, 1, 1)
    floor.data.materials.append(material)
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", size
    scene = bpy.context.scene
    scene.camera = scenes.add(camera)
    scene.camera.location = (0, 0, 20)


def show_direct_light(scene, size, samples):
    """Square pictures, as multilayer files, of what lamps and glowing bodies light at once."""
    scene.render.resolution_x = scene.render.resolution_y = size
    scenes.write_layers()
    set_alike(scene, max_bounces=0)
    sample_plainly(scene, samples)
    filter_by_box(scene)


def pictures_of_squares(scene, cases, pixels, samples, folder):
    """What stands in unit squares side by side along x, seen from straight above: by case the pictures of both engines."""
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", len(cases)
    scene.camera = scenes.add(camera)
    scene.camera.location = (len(cases) / 2, 0.5, 5)
    scene.render.resolution_x, scene.render.resolution_y = pixels * len(cases), pixels
    scene.render.film_transparent = True
    scenes.write_layers()
    sample_plainly(scene, samples)
    filter_by_box(scene)
    pictures = {case: [] for case in cases}
    for name in ("CYCLES", "RAYLEAF"):
        whole = picture(scene, name, folder / f"{name}.exr")
        for number, case in enumerate(cases):
            pictures[case].append(whole[:, number * pixels : (number + 1) * pixels].tolist())
    return pictures
