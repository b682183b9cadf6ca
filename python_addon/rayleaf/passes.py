"""The pass table: passes.def, which the core compiles in, read by the add-on for registration, panels and results."""

import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

_LINE = re.compile(r'^PASS\((\w+), "(\w+)", "(\w+)", "(\w*)", "(.*)"\)$')

# How the switches of Blender's light passes end; of each kind of light there are these three.
_LIGHT_PARTS = ("_direct", "_indirect", "_color")
_LIGHT = ("emit", "environment", "ambient")
_SPELLED = {"uv": "UV", "emit": "Emission"}


@dataclass(frozen=True)
class Pass:
    """One line of the table."""

    identifier: str  # the core's name
    name: str  # Blender's name, in results and on compositor sockets
    channels: str  # one letter each
    switch: str  # property of a view layer that switches the pass on; empty: always on
    meaning: str

    @property
    def socket_type(self) -> str:
        """The kind of compositor socket: VALUE, VECTOR or COLOR."""
        if len(self.channels) == 1:
            return "VALUE"
        return "COLOR" if self.channels.startswith("RGB") else "VECTOR"

    @property
    def group(self) -> str:
        """The heading under which panels show it: the kind of light, or Data."""
        kind = self.switch.removeprefix("use_pass_").split("_")[0]
        return kind.title() if self.switch.endswith(_LIGHT_PARTS) else "Light" if kind in _LIGHT else "Data"

    @property
    def label(self) -> str:
        """For panels, under its heading."""
        words = self.switch.removeprefix("use_pass_") if self.switch else self.name
        words = words.split("_")[1] if self.switch.endswith(_LIGHT_PARTS) else words
        return _SPELLED.get(words, words.replace("_", " ").title())


def parse_table(text: str) -> tuple[Pass, ...]:
    """The passes that the lines `PASS(…)` of a text declare, in order."""
    matches = (_LINE.match(line.strip()) for line in text.splitlines() if line.startswith("PASS("))
    passes = []
    for match in matches:
        if match is None:
            raise ValueError("passes.def: a PASS line is not of the form written at its head")
        passes.append(Pass(*match.groups()))
    return tuple(passes)


@cache
def table() -> tuple[Pass, ...]:
    """The passes, in the order of passes.def, which lies beside this module."""
    return parse_table((Path(__file__).parent / "passes.def").read_text(encoding="utf-8"))


def enabled(view_layer: Any) -> list[Pass]:
    """The passes a view layer asks for."""
    return [entry for entry in table() if not entry.switch or getattr(view_layer, entry.switch, False)]


def by_name(names: Iterable[str]) -> dict[str, Pass]:
    """Those of the table that a render result with these pass names can take, by Blender's name."""
    known = {entry.name: entry for entry in table()}
    return {name: known[name] for name in names if name in known}
