"""The pass table: passes.def, which the core compiles in, read by the add-on for registration, panels and results."""

import re
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from .names import name_of

_LINE = re.compile(r'^PASS\((\w+), "([\w ]+)", "(\w+)", "([\w.]*)", "(.*)"\)$')

# How the switches of Blender's light passes end; of each kind of light there are these three.
_LIGHT_PARTS = ("_direct", "_indirect", "_color")
_LIGHT = ("emit", "environment", "ambient")
_SPELLED = {"uv": "UV", "emit": "Emission", "denoising_store_passes": "Denoising Data"}
# Slots of the core's film (core/film/pass.h): light groups and AOVs.
MOST_SLOTS = 64
# Cryptomatte's kinds: as identifiers, pass names and switches have them.
_MATTES = ("object", "material", "asset")
_MOST_MATTE_LEVELS = 16
# How switches begin of passes that a view layer lists by name.
_CRYPTOMATTE, _NAMED = "cryptomatte.", "named."
# How the add-on's own switches begin: properties of `ViewLayer.rayleaf`; and those that Cycles keeps, which are
# the add-on's where Cycles is not enabled.
_OWN, _CYCLES = "rayleaf.", "cycles."
# And those of what other passes are made of, which nobody sees.
_HIDDEN = "hidden."
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
        return "COLOR" if self.channels.upper().startswith("RGB") else "VECTOR"

    @property
    def is_own(self) -> bool:
        """True if the switch is the add-on's, not Blender's."""
        return self.switch.startswith(_OWN)

    @property
    def is_hidden(self) -> bool:
        """True if other passes are made of it, and nothing shows it."""
        return self.switch.startswith(_HIDDEN)

    @property
    def needs_room(self) -> bool:
        """True if results have no room for it unless the engine makes some."""
        return bool(self.switch) and not self.switch.startswith("use_pass_")

    def place(self, view_layer: Any) -> tuple[Any, str]:
        """What has the switch, of a view layer, and the property's name."""
        if self.switch.startswith(_CYCLES):
            return getattr(view_layer, "cycles", view_layer.rayleaf), self.switch.removeprefix(_CYCLES)
        return (view_layer.rayleaf if self.is_own else view_layer), self.switch.removeprefix(_OWN)

    def is_wanted(self, view_layer: Any) -> bool:
        """True if a view layer asks for the pass."""
        if not self.switch:
            return True
        if self.is_hidden:
            return False
        owner, name = self.place(view_layer)
        return bool(getattr(owner, name, False))

    @property
    def group(self) -> str:
        """The heading under which panels show it: the kind of light, or Data, or Rays for the add-on's own."""
        if self.is_own:
            return "Data" if self.switch in _OWN_DATA else "Rays"
        kind = self._word.split("_")[0]
        return kind.title() if self.switch.endswith(_LIGHT_PARTS) else "Light" if kind in _LIGHT else "Data"

    @property
    def _word(self) -> str:
        """Of the switch, what names the pass."""
        return self.switch.removeprefix(_OWN).removeprefix(_CYCLES).removeprefix("use_pass_")

    @property
    def is_for_developers(self) -> bool:
        """True if it tells how the picture was made, not what it shows."""
        return self.switch.removeprefix(_OWN) in _FOR_DEVELOPERS

    @property
    def label(self) -> str:
        """For panels, under its heading."""
        words = self._word if self.switch else self.name
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


def enabled(view_layer: Any, scene: Any = None) -> list[Pass]:
    """The passes a view layer asks for, by the names of the Blender that runs; and what its scene does beside."""
    from .versions import pass_name  # which wants Blender, as the table does not

    fixed = [replace(entry, name=pass_name(entry.name)) for entry in table() if entry.is_wanted(view_layer)]
    if scene is not None and scene.render.use_motion_blur:  # as in Cycles
        fixed = [entry for entry in fixed if entry.identifier != VECTOR]
    if scene is not None and scene.rayleaf.use_denoising:
        fixed.append(NOISY)
    return fixed + mattes(view_layer) + list(Slots.of(view_layer).passes)


# Has Combined show shadow catchers as Cycles does, as their shadow, where that is no pass of its own.
_CATCHER, _SHADOW_IN_PICTURE = "shadow_catcher", "footage"


def for_catchers(asked: Iterable[Pass]) -> list[str]:
    """The core's names of the passes that shadow catchers need beside these."""
    identifiers = {entry.identifier for entry in asked}
    return [_SHADOW_IN_PICTURE] if "combined" in identifiers and _CATCHER not in identifiers else []


# How far things move from frame to frame: in sharp pictures.
VECTOR = "vector"
# The picture before it is denoised.
NOISY = Pass("combined", "Noisy Image", "RGBA", "denoising.", "the picture before it is denoised")


def mattes(view_layer: Any) -> list[Pass]:
    """Cryptomatte's passes of a view layer, two ranks each."""
    pairs = (min(view_layer.pass_cryptomatte_depth, _MOST_MATTE_LEVELS) + 1) // 2
    wanted = [kind for kind in _MATTES if getattr(view_layer, f"use_pass_cryptomatte_{kind}")]
    return [
        Pass(
            f"crypto_{kind}_{pair:02d}", f"{matte_name(kind)}{pair:02d}", "rgba", _CRYPTOMATTE + kind, "ids and shares"
        )
        for kind in wanted
        for pair in range(pairs)
    ]


def matte_name(kind: str) -> str:
    """Of the passes of a kind, without their numbers."""
    return f"Crypto{kind.title()}"


def matte_kinds(passes: Iterable[Pass]) -> list[str]:
    """The kinds of mattes among these passes."""
    switches = {entry.switch for entry in passes}
    return [kind for kind in _MATTES if _CRYPTOMATTE + kind in switches]


@dataclass(frozen=True)
class Slots:
    """What a view layer names: light groups and AOVs, each with a slot of the core's film."""

    light_groups: dict[str, int]  # by name
    aovs: dict[str, tuple[int, bool]]  # by name: the slot, and whether it is a colour
    passes: tuple[Pass, ...]
    left_out: tuple[str, ...]  # what has no slot, and why

    @classmethod
    def of(cls, view_layer: Any) -> "Slots":
        """Those that a view layer asks for."""
        from .versions import pass_name

        groups: dict[str, int] = {}
        outputs: dict[str, tuple[int, bool]] = {}
        entries: list[Pass] = []
        left_out: list[str] = []
        taken = {pass_name(entry.name) for entry in table()} | {entry.name for entry in (NOISY, *mattes(view_layer))}

        def add(name: str, channels: str, what: str) -> int | None:
            if name in taken:
                left_out.append(f"{what}: another pass has its name")
            elif len(entries) == MOST_SLOTS:
                left_out.append(f"{what}: a view layer has {MOST_SLOTS} light groups and shader outputs at most")
            else:
                taken.add(name)
                entries.append(Pass(f"slot{len(entries)}", name, channels, _NAMED, what))
                return len(entries) - 1
            return None

        for group in getattr(view_layer, "lightgroups", ()):
            name = name_of(group)
            slot = add(f"Combined_{name}", "RGB", f"light group '{name}'")
            if slot is not None:
                groups[name] = slot
        for output in view_layer.aovs:
            name, is_color = name_of(output), output.type == "COLOR"
            slot = add(name, "RGBA" if is_color else "X", f"shader AOV '{name}'")
            if slot is not None:
                outputs[name] = (slot, is_color)
        return cls(groups, outputs, tuple(entries), tuple(left_out))


def pixels(wanted: Iterable[Pass], of: Callable[[str], Any]) -> dict[str, Any]:
    """By Blender's pass name: what `of` gives for the core's names, (height, width, channels). Slots have four channels
    in the core."""
    return {entry.name: of(entry.identifier)[..., : len(entry.channels)] for entry in wanted}


def by_name(names: Iterable[str]) -> dict[str, Pass]:
    """Those of the table that a render result with these pass names can take, by Blender's name."""
    known = {entry.name: entry for entry in table()}
    return {name: known[name] for name in names if name in known}
