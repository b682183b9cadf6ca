"""Reads the plainest OpenEXR files: scan lines, 32-bit floats, no compression (Blender's codec NONE).

Since 5.0 Blender writes a part for each pass and view, before that one for all, and gives passes full names: here they
have those of before.
"""

import struct
from pathlib import Path

import numpy as np

SHORT_NAMES = {
    "Object Index": "IndexOB",
    "Material Index": "IndexMA",
    "Emission": "Emit",
    "Environment": "Env",
    "Ambient Occlusion": "AO",
} | {
    f"{kind} {part}": f"{kind[:length]}{part[:3]}"
    for kind, length in (("Diffuse", 4), ("Glossy", 5), ("Transmission", 5), ("Volume", 6))
    for part in ("Direct", "Indirect", "Color")
}
FLOAT = 2  # pixel type
MULTIPART = 0x1000  # of the flags


def _text(data, at):
    end = data.index(b"\0", at)
    return data[at:end].decode(), end + 1


def _header(data, at, texts=None):
    """Channel names in file order and the data window (x min, y min, x max, y max), then where the header ends. `texts`
    gets attributes that are texts."""
    channels, window = [], None
    while data[at] != 0:
        name, at = _text(data, at)
        kind, at = _text(data, at)
        (size,) = struct.unpack_from("<i", data, at)
        value, at = data[at + 4 : at + 4 + size], at + 4 + size
        if kind == "string" and texts is not None:
            texts[name] = value.decode(errors="replace")
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


def texts(path):
    """The attributes of a file's first header that are texts."""
    found = {}
    _header(Path(path).read_bytes(), 8, found)
    return found


def _short(channel):
    """ "ViewLayer.DiffDir.R" of "ViewLayer.Diffuse Direct.R"."""
    layer_and_pass, _, letter = channel.rpartition(".")
    layer, _, name = layer_and_pass.rpartition(".")
    return f"{layer}.{SHORT_NAMES[name]}.{letter}" if name in SHORT_NAMES else channel


def _in_view(channel, view):
    """ "ViewLayer.Depth.left.Z" of "ViewLayer.Depth.Z"."""
    layer_and_pass, _, letter = channel.rpartition(".")
    return f"{layer_and_pass}.{view}.{letter}" if view else channel


def _part(data, channels, window, at, before):
    """Channel name -> (height, width); the table of offsets is at `at`, `before` bytes lie before each row's number."""
    x_min, y_min, x_max, y_max = window
    width, height = x_max - x_min + 1, y_max - y_min + 1
    picture = np.empty((height, len(channels), width), np.float32)
    for offset in struct.unpack_from(f"<{height}Q", data, at):
        (y,) = struct.unpack_from("<i", data, offset + before)
        row = np.frombuffer(data, "<f4", len(channels) * width, offset + before + 8)
        picture[y - y_min] = row.reshape(-1, width)
    return {_short(name): picture[::-1, index] for index, name in enumerate(channels)}, at + 8 * height


def read(path):
    """Channel name -> (height, width), rows bottom to top as Blender counts them."""
    data = Path(path).read_bytes()
    is_multipart = bool(struct.unpack_from("<I", data, 4)[0] & MULTIPART)
    at, headers = 8, []
    while not headers or (is_multipart and data[at] != 0):
        attributes = {}
        channels, window, at = _header(data, at, attributes)
        headers.append((channels, window, attributes.get("view", "")))
    at += is_multipart  # headers of several parts end with an empty one
    pixels = {}
    for channels, window, view in headers:
        part, at = _part(data, channels, window, at, 4 if is_multipart else 0)
        pixels |= {_in_view(name, view): channel for name, channel in part.items()}
    return pixels
