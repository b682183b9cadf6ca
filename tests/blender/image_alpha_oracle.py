"""Runs inside Blender: images by what their alpha is set to be, of bytes and of floats, in files, packed and generated, in
both engines. Half of the pixels of each have an alpha of 0."""

import itertools
import sys
from pathlib import Path

import both_engines
import bpy
import color_spaces_oracle
import numpy as np

SIDE = color_spaces_oracle.SIDE
NUMBERS = np.random.default_rng(3).uniform(0.1, 0.95, (SIDE, SIDE, 4)).astype(np.float32)
NUMBERS[: SIDE // 2, :, 3] = 0.0
MODES = ("STRAIGHT", "PREMUL", "CHANNEL_PACKED", "NONE")
FORMATS = {"bytes": "PNG", "floats": "OPEN_EXR"}


def generated(kind):
    """Pixels that Blender holds."""
    made = bpy.data.images.new(kind, SIDE, SIDE, alpha=True, float_buffer=kind == "floats")
    made.pixels.foreach_set(NUMBERS.ravel())
    return made


def written(kind, folder):
    """The path of a file whose numbers are those here."""
    made = generated(kind)
    made.alpha_mode = "CHANNEL_PACKED"
    made.filepath_raw, made.file_format = str(folder / f"{kind}.{FORMATS[kind].lower()}"), FORMATS[kind]
    made.save()
    return made.filepath_raw


def images(folder):
    """By name, each made anew for every mode and space."""
    for kind, mode, is_data in itertools.product(FORMATS, MODES, (False, True)):
        for origin in ("file", "packed", "generated"):
            image = generated(kind) if origin == "generated" else bpy.data.images.load(written(kind, folder))
            if is_data:
                image.colorspace_settings.name = "Non-Color"
            image.alpha_mode = mode
            if origin == "packed":
                image.pack()
            yield f"{kind}, {origin}, {mode}, {'data' if is_data else 'colours'}", image


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    folder, found = Path(sys.argv[1]), {}
    scene = color_spaces_oracle.build("bytes", "sRGB", folder)
    nodes = bpy.data.materials["shining"].node_tree.nodes
    texture, emission = nodes["Image Texture"], nodes["Emission"]
    for name, image in images(folder):
        for socket in ("Color", "Alpha"):  # as the strength, as well
            texture.image = image
            links = bpy.data.materials["shining"].node_tree.links
            if socket == "Alpha":
                links.new(texture.outputs["Alpha"], emission.inputs["Strength"])
            pictures = [both_engines.picture(scene, e, folder / "picture.exr")[..., :3] for e in ("CYCLES", "RAYLEAF")]
            found[f"{name}, {socket}"] = [picture.ravel().tolist() for picture in pictures]
        links.remove(emission.inputs["Strength"].links[0])
    report(found=found, version=bpy.app.version)
