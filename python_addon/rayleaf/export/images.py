"""Blender's images as the core's textures."""

import os
from collections.abc import Callable
from functools import partial
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import versions
from ..messages import Messages, Subject
from ..names import name_of
from . import CancelCheck
from .color_spaces import BY_DEFAULT, ColorSpaces

# What the core calls alphas that are not the colours' opacity.
_OTHER_ALPHAS = {"CHANNEL_PACKED": "SEPARATE", "NONE": "IGNORED"}

# As many tiles as the core takes of one image.
_MOST_TILES = 1000


def shown_frame(user: Any, frame: int) -> int:
    """Which frame of a sequence or movie is seen in a scene's frame (BKE_image_user_frame_get)."""
    length = int(user.frame_duration)
    if length == 0:
        return 0
    shown = frame - int(user.frame_start) + 1
    if user.use_cyclic:
        shown = (shown - 1) % length + 1
    return min(max(shown, 0), length) + int(user.frame_offset)


def _of_tile(path: str, number: int) -> str:
    """The file of a UDIM tile, by either of Blender's tokens."""
    row, column = divmod(number - 1001, 10)
    return path.replace("<UDIM>", str(number)).replace("<UVTILE>", f"u{column + 1}_v{row + 1}")


def _begins_as_bytes(data: bytes) -> bool:
    """Whether a file is a JPEG, or a PNG of 8 bits at most: no floats to Blender, which had to decode it to tell."""
    return data[:3] == b"\xff\xd8\xff" or (data[:8] == b"\x89PNG\r\n\x1a\n" and data[24:25] <= b"\x08")


def _tells_alpha(image: Any) -> bool:
    """Whether colours are multiplied by alpha as it is usual in such files, of which the file that is packed tells."""
    if image.alpha_mode not in ("STRAIGHT", "PREMUL"):
        return True
    of_bytes = _begins_as_bytes(image.packed_file.data) or not image.is_float
    return image.alpha_mode != ("PREMUL" if of_bytes else "STRAIGHT")


def _packed_tile(image: Any, path: str) -> bytes | None:
    """What a tile's file holds, where the tiles are packed."""
    packed = image.packed_files if image.source == "TILED" else ()
    found = (each for each in packed if versions.absolute_path(each.filepath, image) == path)
    tile = next(found, None)
    return None if tile is None or tile.packed_file is None else tile.packed_file.data


class ImageLibrary:
    """Each image once; what is missing is named once."""

    def __init__(
        self, core: ModuleType, scene: Any, messages: Messages, check_cancel: CancelCheck | None = None
    ) -> None:
        self._check_cancel = check_cancel or CancelCheck(lambda: False)
        self._core, self.scene, self._messages = core, scene, messages
        self.known: dict[tuple[int, str, int], int | None] = {}  # textures by image, path and picture
        self._color_spaces = ColorSpaces()
        self.asked = 0  # how often something was
        self.added = 0

    def go_on_in(self, scene: Any) -> None:
        """What is asked for from now on, which may have changed, is added to another scene."""
        self.scene = scene
        self.known.clear()

    def texture(self, image: Any, user: Any, frame: int) -> int | None:
        """The texture id of an image as a node uses it, or None if it cannot be read."""
        picture = max(shown_frame(user, frame) - 1, 0) if image.source == "MOVIE" and user is not None else 0
        return self._texture_at(image, self._path(image, user, frame), picture)

    def _texture_at(self, image: Any, path: str, picture: int = 0) -> int | None:
        """`picture`: of those of a movie."""
        self.asked += 1
        key = (image.original.as_pointer(), path, picture)
        if key not in self.known:
            self._check_cancel()
            try:
                self.known[key] = self._add(image, path, picture)
            except self._core.InputError as error:
                self._messages.warn(f"{error}; rendered pink", Subject("Image", name_of(image)))
                self.known[key] = None
        return self.known[key]

    def tiles(self, image: Any) -> list[int]:
        """The UDIM tiles of an image: number and texture id of each in turn."""
        self.asked += 1
        found = []
        for tile in list(image.tiles)[:_MOST_TILES]:
            path = _of_tile(versions.absolute_path(image.filepath, image), tile.number)
            texture = self._texture_at(image, path)
            if texture is not None:
                found += [tile.number, texture]
        return found

    def leave_out_unreadable(self) -> None:
        """Names the images that cannot be read, of which the core knows only after all; they are pink."""
        if self.added == 0:
            return
        for name, reason in self._check_cancel.while_waiting_for(self.scene.leave_out_unreadable_images):
            self._messages.warn(f"{reason}; rendered pink", Subject("Image", name))

    def _warn(self, image: Any, text: str) -> None:
        subject = Subject("Image", name_of(image))
        self._messages.warn(f"{subject}: {text}", subject)

    def _path(self, image: Any, user: Any, frame: int) -> str:
        if image.source == "SEQUENCE" and user is not None:
            user.frame_current = shown_frame(user, frame)
            return versions.absolute_path(image.filepath_from_user(image_user=user), image)
        path = versions.absolute_path(image.filepath, image)
        if image.source == "TILED":
            path = _of_tile(path, image.tiles[0].number if image.tiles else 1001)
        return path

    def _add(self, image: Any, path: str, picture: int) -> int | None:
        if image.source == "VIEWER":
            self._warn(image, "viewer images are not supported; rendered pink")
            return None
        space = self._color_spaces.of(image)
        if image.packed_file is not None and image.source == "FILE" and not image.is_dirty and _tells_alpha(image):
            return self._add_packed(image, path, space)
        tile = _packed_tile(image, path)
        if tile is not None:
            return self._send(self.scene.add_packed_image, image, tile, space)
        if image.packed_file is not None or image.source == "GENERATED" or image.is_dirty:
            return self._add_pixels(image, path, space)
        if not os.path.isfile(path):
            self._warn(image, f"no file at {path or 'an empty path'}; rendered pink")
            return None
        add = self.scene.add_image_file
        if image.source == "MOVIE":
            add = partial(add, picture=min(picture, max(image.frame_duration - 1, 0)))
        return self._send(add, image, os.fsencode(path), space)

    def _send(
        self,
        add: Callable[..., int],
        image: Any,
        what: Any,
        space: tuple[str, str],
        opacity: str = "OPACITY",
        refused: str = "",
    ) -> int:
        """Hand an image to the core, which may take seconds for a large one. `opacity`: what its alpha is, where it is
        the colours' opacity. `refused`: what the core said of its colour space, in place of which `space` is tried."""
        alpha = _OTHER_ALPHAS.get(image.alpha_mode, opacity)
        name = name_of(image)
        self.added += 1
        try:
            return int(self._check_cancel.while_waiting_for(lambda: add(name, what, *space, alpha=alpha)))
        except self._core.InputError as error:
            if not space[1] or "colour space" not in str(error):
                raise
            refused, readable = refused or str(error), self._color_spaces.for_older(space)
            if readable is None:
                self._warn(image, f"{refused}; taken as sRGB")
            return self._send(add, image, what, readable or BY_DEFAULT, opacity, refused)

    def _add_packed(self, image: Any, path: str, space: tuple[str, str]) -> int | None:
        """By the file that is packed, which is far smaller than Blender's pixels; by these where the core cannot read it."""
        try:
            return self._send(self.scene.add_packed_image, image, image.packed_file.data, space)
        except self._core.InputError:
            return self._add_pixels(image, path, space)

    def _add_pixels(self, image: Any, path: str, space: tuple[str, str]) -> int | None:
        width, height = image.size
        if width == 0 or height == 0:
            self._warn(image, f"no pixels in {path or 'the packed file'}; rendered pink")
            return None
        pixels = np.empty(width * height * image.channels, np.float32)
        image.pixels.foreach_get(pixels)
        pixels = pixels.reshape(height, width, image.channels)
        if image.channels == 2:  # grey and alpha
            pixels = np.ascontiguousarray(pixels[..., [0, 0, 0, 1]])
        if not image.is_float:
            return self._send(self.scene.add_image_pixels, image, pixels, space)
        # Blender holds float images scene-linear, with the colour multiplied by alpha.
        space = space if space[0] == "NON_COLOR" else ("LINEAR", "")
        return self._send(self.scene.add_image_pixels, image, pixels, space, "MULTIPLIED")
