"""Runs inside Blender: a movie and a sequence of images, as their nodes place them in time, in both engines."""

import sys
from pathlib import Path

import both_engines
import bpy
import color_spaces_oracle
import numpy as np
import scenes

SIDE, LENGTH = 32, 5
# Of the node's image user: first frame, offset, length, cyclic; and the scene's frame.
CASES = {
    "as it is": (1, 0, LENGTH, False, 3),
    "later": (4, 0, LENGTH, False, 6),
    "from its third": (1, 2, 3, False, 2),
    "before": (10, 0, LENGTH, False, 3),
    "after": (1, 0, 3, False, 40),
    "again and again": (1, 0, LENGTH, True, 14),
    "again, before": (10, 0, LENGTH, True, 3),
    "beyond its end": (1, 3, LENGTH, False, 5),
}


def write_frames(folder):
    """Pictures of one colour each."""
    for number in range(LENGTH):
        image = bpy.data.images.new("frame", SIDE, SIDE)
        level = (number + 1) / (LENGTH + 1)
        image.pixels.foreach_set(np.tile(np.float32([level, 1 - level, 0.5 * level, 1]), SIDE * SIDE))
        image.filepath_raw, image.file_format = str(folder / f"step_{number + 1:04d}.png"), "PNG"
        image.save()


def write_movie(folder):
    """The same as a movie."""
    scenes.empty_file()
    scene = bpy.context.scene
    editor = scene.sequence_editor_create()
    strips = editor.strips if hasattr(editor, "strips") else editor.sequences
    strip = strips.new_image("frames", str(folder / "step_0001.png"), 1, 1)
    for number in range(2, LENGTH + 1):
        strip.elements.append(f"step_{number:04d}.png")
    scene.frame_start, scene.frame_end = 1, LENGTH
    scene.render.resolution_x = scene.render.resolution_y = SIDE
    scene.view_settings.view_transform = "Standard"
    settings = scene.render.image_settings
    if hasattr(settings, "media_type"):  # 5.0
        settings.media_type = "VIDEO"
    settings.file_format = "FFMPEG"
    scene.render.ffmpeg.format, scene.render.ffmpeg.codec = "MPEG4", "H264"
    scene.render.ffmpeg.constant_rate_factor = "LOSSLESS"
    scene.render.filepath = str(folder / "movie.mp4")
    bpy.ops.render.render(animation=True)


def build(folder, source, start, offset, length, cyclic, frame):
    """The plane of images, in one picture's colour."""
    scene = color_spaces_oracle.build("bytes", "sRGB", folder)
    (texture,) = [node for node in bpy.data.materials["shining"].node_tree.nodes if node.type == "TEX_IMAGE"]
    texture.image = bpy.data.images.load(str(folder / ("movie.mp4" if source == "MOVIE" else "step_0001.png")))
    texture.image.source = source
    user = texture.image_user
    user.frame_start, user.frame_offset, user.frame_duration, user.use_cyclic = start, offset, length, cyclic
    user.use_auto_refresh = True
    scene.frame_set(frame)
    return scene


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    folder, found = Path(sys.argv[1]), {}
    write_frames(folder)
    write_movie(folder)
    for source in ("SEQUENCE", "MOVIE"):
        for case, described in CASES.items():
            scene = build(folder, source, *described)
            pictures = [both_engines.picture(scene, e, folder / "picture.exr")[..., :3] for e in ("CYCLES", "RAYLEAF")]
            found[f"{source}, {case}"] = [picture[6, 6].tolist() for picture in pictures]
    report(found=found)
