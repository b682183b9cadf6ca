"""What the user is told: each thing once, with the name of what it is about."""

import textwrap
from collections.abc import Callable
from dataclasses import dataclass


_WIDTH = 100  # characters that fit a page of the preferences


@dataclass(frozen=True)
class Subject:
    """What a message is about; as text, what it begins with."""

    kind: str  # Object, Light, Camera, Material, World, Image, Scene, View layer
    name: str
    node: str = ""  # of its node tree

    def __str__(self) -> str:
        return f"{self.kind} '{self.name}'" + (f", node '{self.node}'" if self.node else "")


@dataclass(frozen=True)
class Message:
    """One message."""

    kind: str  # Blender's: INFO, WARNING, ERROR
    text: str
    about: Subject | None = None


def wrapped(text: str) -> list[str]:
    """Lines for Blender's labels, which do not wrap."""
    return textwrap.wrap(text, _WIDTH)


class Messages:
    """Collects messages; each new one is passed on at once."""

    def __init__(self, report: Callable[[Message], None] | None = None) -> None:
        self._report = report
        self._known: dict[str, Message] = {}

    @property
    def texts(self) -> list[str]:
        """What has been told, in order."""
        return list(self._known)

    def note(self, text: str, about: Subject | None = None) -> None:
        """Something worth knowing that takes nothing from the picture."""
        self._add("INFO", text, about)

    def warn(self, text: str, about: Subject | None = None) -> None:
        """Something is left out or replaced, and the render goes on."""
        self._add("WARNING", text, about)

    def error(self, text: str, about: Subject | None = None) -> None:
        """The render cannot go on."""
        self._add("ERROR", text, about)

    def _add(self, kind: str, text: str, about: Subject | None) -> None:
        text = printable(text)
        if text in self._known:
            return
        self._known[text] = Message(kind, text, about)
        if self._report is not None:
            self._report(self._known[text])


def printable(text: str) -> str:
    """Text that Blender takes: bytes of a path that are no UTF-8 become numbers."""
    return text.encode("utf-8", "backslashreplace").decode()
