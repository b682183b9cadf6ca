"""The pass table: passes.def, which the core compiles in, read by the add-on for registration, panels and results."""

import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

_LINE = re.compile(r'^PASS\((\w+), "([\w ]+)", "(\w+)", "([\w.]*)", "(.*)"\)$')

# How the switches of Blender's light passes end; of each kind of light there are these three.
_LIGHT_PARTS = ("_direct", "_indirect", "_color")
_LIGHT = ("emit", "environment", "ambient")
_SPELLED = {"uv": "UV", "emit": "Emission"}
# How switches begin that are the add-on's own: properties of `ViewLayer.rayleaf`.
_OWN = "rayleaf."
_OWN_DATA = ("rayleaf.use_pass_sample_count",)
_FOR_DEVELOPERS = ("use_pass_tree", "use_pass_level", "use_pass_cache_misses")


@dataclass(frozen=True)
class Pass:
    """One line of the table."""

    identifier: str  # the core's name
    name: str  # Blender's name, in results and on compositor sockets; in the table, that before 5.0
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
    def is_own(self) -> bool:
        """True if the switch is the add-on's, not Blender's."""
        return self.switch.startswith(_OWN)

    def place(self, view_layer: Any) -> tuple[Any, str]:
        """What has the switch, of a view layer, and the property's name."""
        return (view_layer.rayleaf if self.is_own else view_layer), self.switch.removeprefix(_OWN)

    def is_wanted(self, view_layer: Any) -> bool:
        """True if a view layer asks for the pass."""
        if not self.switch:
            return True
        owner, name = self.place(view_layer)
        return bool(getattr(owner, name, False))

    @property
    def group(self) -> str:
        """The heading under which panels show it: the kind of light, or Data, or Rays for the add-on's own."""
        if self.is_own:
            return "Data" if self.switch in _OWN_DATA else "Rays"
        kind = self.switch.removeprefix("use_pass_").split("_")[0]
        return kind.title() if self.switch.endswith(_LIGHT_PARTS) else "Light" if kind in _LIGHT else "Data"

    @property
    def is_for_developers(self) -> bool:
        """True if it tells how the picture was made, not what it shows."""
        return self.switch.removeprefix(_OWN) in _FOR_DEVELOPERS

    @property
    def label(self) -> str:
        """For panels, under its heading."""
        words = self.switch.removeprefix(_OWN).removeprefix("use_pass_") if self.switch else self.name
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
    """The passes a view layer asks for, by the names of the Blender that runs."""
    from .versions import pass_name  # which wants Blender, as the table does not

    return [replace(entry, name=pass_name(entry.name)) for entry in table() if entry.is_wanted(view_layer)]


def by_name(names: Iterable[str]) -> dict[str, Pass]:
    """Those of the table that a render result with these pass names can take, by Blender's name."""
    known = {entry.name: entry for entry in table()}
    return {name: known[name] for name in names if name in known}
