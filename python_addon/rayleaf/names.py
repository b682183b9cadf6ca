"""Strings of Blender's as text.

Files of old Blenders hold names in other encodings than UTF-8. Blender shows and renders them, but its Python raises
UnicodeDecodeError where it should hand them over. So every name that a user may have given is read here.
"""

from collections.abc import Iterable
from typing import Any


def text_of(owner: Any, attribute: str) -> str:
    """A string of Blender's. Bytes that are not UTF-8 are taken as Latin-1, which has a letter for each: names that
    differ stay different."""
    try:
        return str(getattr(owner, attribute))
    except UnicodeDecodeError as error:
        return bytes(error.object).decode("latin-1")


def name_of(thing: Any) -> str:
    """The name of a data block, node, layer, socket or whatever else has one."""
    return text_of(thing, "name")


def bytes_of_name(thing: Any) -> bytes:
    """The name as Blender holds it."""
    try:
        return str(thing.name).encode()
    except UnicodeDecodeError as error:
        return bytes(error.object)


def is_plain(thing: Any) -> bool:
    """Whether Blender takes the name back: it does so only in UTF-8."""
    return bytes_of_name(thing) == name_of(thing).encode()


def find(collection: Iterable[Any], name: str) -> Any:
    """The item of that name as read here; None if there is none."""
    return next((item for item in collection if name_of(item) == name), None)
