"""Reads the plainest OpenEXR files: scan lines, 32-bit floats, no compression (Blender's codec NONE)."""

import struct
from pathlib import Path

import numpy as np

FLOAT = 2  # pixel type


def _text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def _header(data):
    """Channel names in file order and the data window (x min, y min, x max, y max), then where the header ends."""
    at, channels, window = 8, [], None
    while data[at] != 0:
        name, at = _text(data, at)
        _, at = _text(data, at)
        (size,) = struct.unpack_from("<i", data, at)
        value, at = data[at + 4 : at + 4 + size], at + 4 + size
        if name == "channels":
            place = 0
            while value[place] != 0:
                channel, place = _text(value, place)
                assert struct.unpack_from("<i", value, place)[0] == FLOAT, channel
                channels.append(channel)
                place += 16
        elif name == "compression":
            assert value == b"\0", "compressed"
        elif name == "dataWindow":
            window = struct.unpack("<4i", value)
    return channels, window, at + 1


def read(path):
    """Channel name -> (height, width), rows bottom to top as Blender counts them."""
    data = Path(path).read_bytes()
    channels, (x_min, y_min, x_max, y_max), at = _header(data)
    width, height = x_max - x_min + 1, y_max - y_min + 1
    offsets = struct.unpack_from(f"<{height}Q", data, at)
    picture = np.empty((height, len(channels), width), np.float32)
    for offset in offsets:
        (y,) = struct.unpack_from("<i", data, offset)
        picture[y - y_min] = np.frombuffer(data, "<f4", len(channels) * width, offset + 8).reshape(-1, width)
    return {name: picture[::-1, index] for index, name in enumerate(channels)}
