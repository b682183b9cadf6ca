"""Blender's images as the core's textures."""

import os
from collections.abc import Callable
from types import ModuleType
from typing import Any

import bpy
import numpy as np
from numpy.typing import NDArray

from ..messages import Messages, Subject
from ..names import name_of
from . import CancelCheck

# Blender's colour space names, 3.4 and later.
_COLOR_SPACES = {
    "sRGB": "SRGB",
    "Linear": "LINEAR",
    "Linear Rec.709": "LINEAR",
    "Linear BT.709": "LINEAR",
    "Non-Color": "NON_COLOR",
    "Raw": "NON_COLOR",
}

# As many tiles as the core takes of one image.
_MOST_TILES = 1000


class ImageLibrary:
    """Each image once; what is missing is named once."""

    def __init__(
        self, core: ModuleType, scene: Any, messages: Messages, check_cancel: CancelCheck | None = None
    ) -> None:
        self._check_cancel = check_cancel or CancelCheck(lambda: False)
        self._core, self.scene, self._messages = core, scene, messages
        self.known: dict[tuple[int, str], int | None] = {}  # textures by image and path
        self._computed: dict[tuple[Any, ...], int] = {}
        self.asked = 0  # how often something was
        self.added = 0

    def go_on_in(self, scene: Any) -> None:
        """What is asked for from now on, which may have changed, is added to another scene."""
        self.scene = scene
        self.known.clear()
        self._computed.clear()

    def texture(self, image: Any, user: Any, frame: int) -> int | None:
        """The texture id of an image as a node uses it, or None if it cannot be read."""
        return self._texture_at(image, self._path(image, user, frame))

    def _texture_at(self, image: Any, path: str) -> int | None:
        self.asked += 1
        key = (image.original.as_pointer(), path)
        if key not in self.known:
            self._check_cancel()
            try:
                self.known[key] = self._add(image, path)
            except self._core.InputError as error:
                self._messages.warn(f"{error}; rendered pink", Subject("Image", name_of(image)))
                self.known[key] = None
        return self.known[key]

    def computed(self, name: str, key: tuple[Any, ...], make: Callable[[], NDArray[np.float32]]) -> int:
        """The texture id of a table that is computed, linear colours in rows from below; once for each key."""
        self.asked += 1
        if (name, *key) not in self._computed:
            table = np.ascontiguousarray(make(), np.float32)
            add = self.scene.add_image_pixels
            self.added += 1
            self._computed[(name, *key)] = int(self._check_cancel.while_waiting_for(lambda: add(name, table, "LINEAR")))
        return self._computed[(name, *key)]

    def tiles(self, image: Any) -> list[int]:
        """The UDIM tiles of an image: number and texture id of each in turn."""
        self.asked += 1
        found = []
        for tile in list(image.tiles)[:_MOST_TILES]:
            path = str(bpy.path.abspath(image.filepath, library=image.library)).replace("<UDIM>", str(tile.number))
            texture = self._texture_at(image, path)
            if texture is not None:
                found += [tile.number, texture]
        return found

    def _warn(self, image: Any, text: str) -> None:
        subject = Subject("Image", name_of(image))
        self._messages.warn(f"{subject}: {text}", subject)

    def _path(self, image: Any, user: Any, frame: int) -> str:
        if image.source == "SEQUENCE" and user is not None:
            user.frame_current = frame
            return str(bpy.path.abspath(image.filepath_from_user(image_user=user), library=image.library))
        path = str(bpy.path.abspath(image.filepath, library=image.library))
        if image.source == "TILED":
            path = path.replace("<UDIM>", str(image.tiles[0].number) if image.tiles else "1001")
        return path

    def _add(self, image: Any, path: str) -> int | None:
        if image.source in ("MOVIE", "VIEWER"):
            self._warn(image, f"{image.source.lower()} images are not supported; rendered pink")
            return None
        space = self._color_space(image)
        if image.packed_file is not None or image.source == "GENERATED" or image.is_dirty:
            return self._add_pixels(image, path, space)
        if not os.path.isfile(path):
            self._warn(image, f"no file at {path or 'an empty path'}; rendered pink")
            return None
        return self._send(self.scene.add_image_file, image, os.fsencode(path), space)

    def _send(self, add: Callable[[str, Any, str], int], image: Any, what: Any, space: str) -> int:
        """Hand an image to the core, which converts it: seconds for a large one."""
        name = name_of(image)
        self.added += 1
        return int(self._check_cancel.while_waiting_for(lambda: add(name, what, space)))

    def _color_space(self, image: Any) -> str:
        name = name_of(image.colorspace_settings)
        if name in _COLOR_SPACES:
            return _COLOR_SPACES[name]
        self._warn(image, f"colour space {name} is not supported; taken as sRGB")
        return "SRGB"

    def _add_pixels(self, image: Any, path: str, space: str) -> int | None:
        width, height = image.size
        if width == 0 or height == 0:
            self._warn(image, f"no pixels in {path or 'the packed file'}; rendered pink")
            return None
        pixels = np.empty(width * height * image.channels, np.float32)
        image.pixels.foreach_get(pixels)
        pixels = pixels.reshape(height, width, image.channels)
        if image.channels == 2:  # grey and alpha
            pixels = np.ascontiguousarray(pixels[..., [0, 0, 0, 1]])
        if image.is_float:
            # Blender holds float images scene-linear, with the colour multiplied by alpha.
            space = "LINEAR" if space == "SRGB" else space
            if pixels.shape[2] == 4 and image.alpha_mode not in ("CHANNEL_PACKED", "NONE"):
                alpha = pixels[..., 3:]
                pixels[..., :3] /= np.where(alpha > 0.0, alpha, np.float32(1.0))
        return self._send(self.scene.add_image_pixels, image, pixels, space)
