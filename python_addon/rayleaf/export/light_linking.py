"""Which lights shine on which objects, and which objects cast their shadows: Blender's collections as the core's sets."""

from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import Any

from .. import versions
from ..messages import Messages, Subject
from ..names import name_of

# As many as the core has bits for (core/lights/light_linking.h).
_RECEIVER_SETS, _BLOCKER_SETS = 63, 24


@dataclass(frozen=True)
class _Chosen:
    """Objects by the pointers of their originals. With any included, only these; else all but the excluded."""

    included: frozenset[int]
    excluded: frozenset[int]

    @classmethod
    def by(cls, collection: Any) -> "_Chosen":
        """What a collection says."""
        entries = [(item.original.as_pointer(), included) for item, included in versions.linked_objects(collection)]
        included, excluded = (frozenset(item for item, each in entries if each == state) for state in (True, False))
        return cls(included, excluded)

    def has(self, pointer: int) -> bool:
        """Whether an object is among them."""
        return pointer not in self.excluded and (not self.included or pointer in self.included)

    def is_all(self) -> bool:
        """Whether it leaves nothing out."""
        return not (self.included or self.excluded)


@dataclass
class LightLinks:
    """Those of a view layer. Lights whose collections choose the same objects share a set."""

    receivers: list[_Chosen] = field(default_factory=list)
    blockers: list[_Chosen] = field(default_factory=list)
    of_light: dict[int, tuple[int, int]] = field(default_factory=dict)  # numbers of sets by light; -1: all objects
    too_many: list[Any] = field(default_factory=list, compare=False)  # lights for which there was no set left

    @classmethod
    def of(cls, objects: Iterable[Any]) -> "LightLinks":
        """As objects, evaluated or not, are linked."""
        links = cls()
        known: dict[int, _Chosen] = {}
        for item in objects:
            collections = versions.light_collections(item)
            if collections != (None, None):
                links._add(item, collections, known)
        return links

    def _add(self, light: Any, collections: tuple[Any, Any], known: dict[int, _Chosen]) -> None:
        numbers = []
        for collection, sets, most in zip(
            collections, (self.receivers, self.blockers), (_RECEIVER_SETS, _BLOCKER_SETS), strict=True
        ):
            numbers.append(-1)
            if collection is None:
                continue
            pointer = collection.original.as_pointer()
            if pointer not in known:
                known[pointer] = _Chosen.by(collection.original)
            chosen = known[pointer]
            if chosen.is_all():
                continue
            if chosen not in sets and len(sets) == most:
                self.too_many.append(light)
                continue
            if chosen not in sets:
                sets.append(chosen)
            numbers[-1] = sets.index(chosen)
        if numbers != [-1, -1]:
            self.of_light[light.original.as_pointer()] = (numbers[0], numbers[1])

    def __bool__(self) -> bool:
        return bool(self.of_light)

    def warn(self, messages: Messages) -> None:
        """Names the lights that are linked in vain."""
        for light in self.too_many:
            subject = Subject("Light" if light.type == "LIGHT" else "Object", name_of(light))
            limits = f"{_RECEIVER_SETS} sets of objects to light and {_BLOCKER_SETS} to cast shadows"
            messages.warn(f"{subject}: light linking knows {limits}; it is not linked beyond that", subject)

    def light(self, owner: Any) -> tuple[int, int]:
        """The sets of a light: on what it shines, and what casts its shadows."""
        return self.of_light.get(owner.original.as_pointer(), (-1, -1))

    def row(self, owner: Any, maker: Any = None) -> tuple[int, int, int, int]:
        """The core's numbers for an instance. `maker`: the object that makes it, which counts first if it is chosen."""
        pointer = owner.original.as_pointer()
        made_by = 0 if maker is None else maker.original.as_pointer()
        bits = (_bits(sets, pointer, made_by) for sets in (self.receivers, self.blockers))
        lit_by, blocks = (each | ~((1 << len(sets)) - 1) for each, sets in zip(bits, (self.receivers, self.blockers)))
        return (lit_by & (1 << _RECEIVER_SETS) - 1, blocks & (1 << _BLOCKER_SETS) - 1, *self.light(owner))

    @property
    def lit_by_of_world(self) -> int:
        """What shines on the world's medium: as on an object that nothing chooses."""
        unused = ~((1 << len(self.receivers)) - 1)
        return (_bits(self.receivers, 0, 0) | unused) & (1 << _RECEIVER_SETS) - 1


def _bits(sets: list[_Chosen], pointer: int, maker: int) -> int:
    """A bit for each set that has an object, or its maker if that is chosen otherwise than others."""

    def bits_of(item: int) -> int:
        return sum(1 << number for number, each in enumerate(sets) if each.has(item))

    of_maker = bits_of(maker)
    return bits_of(pointer) if of_maker == bits_of(0) else of_maker
