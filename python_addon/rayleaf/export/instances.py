"""The objects of a view layer, each once, grouped by what they share: up to millions of instances in seconds."""

from collections.abc import Callable
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import ExportCancelled, curves, surfaces
from .random_numbers import random_of_name
from .strands import hair_systems

# Instances between two looks at the Esc key: some 10 ms.
_CANCEL_STRIDE = 10_000
# Blender gives an instance's random number as 32 bits.
_RANDOM_RANGE = 0xFFFFFFFF

VISIBLE_CAMERA, VISIBLE_DIFFUSE, VISIBLE_GLOSSY, VISIBLE_TRANSMISSION, VISIBLE_SHADOW = 1, 2, 4, 8, 16

# What has faces only through the mesh that Blender evaluates beside it.
_WITH_MESH_TWIN = {"CURVE", "SURFACE", "FONT", "META"}
# Of these, what the core can render from control points.
WITH_EXACT_FORM = {"SURFACE", "CURVE", "FONT"}
_UNSUPPORTED = {"VOLUME": "volumes", "POINTCLOUD": "point clouds", "GPENCIL": "grease pencil"}


@dataclass
class Group:
    """Instances that share geometry, materials and settings."""

    owner: Any  # the evaluated object whose settings count
    data: Any  # what is rendered: a Mesh, or the data of an exact surface or curve
    exact: bool  # splines, not a mesh
    from_owner: bool  # the data is the owner's own, so its material slots count
    members: list[int]  # places in the depsgraph's list of instances
    hair: int | None = None  # which of the owner's hair particle systems, in place of the data

    @property
    def shape_key(self) -> Any:
        """Equal for groups that can share one shape in the core."""
        if self.hair is not None:
            return (self.owner.as_pointer(), self.hair)
        if not self.exact:
            return self.data.as_pointer()
        return _exact_shape_key(self.owner, self.data)


def _exact_shape_key(owner: Any, data: Any) -> tuple[int, int | None]:
    # Shape keys can be pinned per object.
    pinned = owner.as_pointer() if data.shape_keys is not None else None
    return (data.original.as_pointer(), pinned)


@dataclass
class Instances:
    """All that a view layer shows."""

    groups: list[Group]
    lamps: list[tuple[Any, int]]  # evaluated lamp object, place in the list
    matrices: NDArray[np.float64]  # (n, 4, 4) of every place
    randoms: NDArray[np.float32]  # (n,) 0..1
    skipped: dict[str, str]  # object name -> why it is not rendered
    without_faces: list[Any]  # curves, texts and the like of which Blender makes no mesh
    reasons: dict[str, str]  # object name -> why not from control points
    curves: dict[Any, curves.Judged]  # by the shape key of a group: what is known of a CURVE or FONT


class _ExactForms:
    """Which objects are rendered from control points."""

    def __init__(self, core: ModuleType, depsgraph: Any) -> None:
        self.reasons: dict[str, str] = {}
        self.curves: dict[Any, curves.Judged] = {}
        self._core, self._depsgraph = core, depsgraph
        self._known: dict[int, bool] = {}

    def has(self, owner: Any) -> bool:
        """Whether an object of a type with an exact form is."""
        pointer = owner.as_pointer()
        if pointer not in self._known:
            judged = None if owner.type == "SURFACE" else self._judged(owner)
            reason = judged.reason if judged else surfaces.fallback_reason(owner)
            if reason is not None:
                self.reasons[owner.name] = reason
            self._known[pointer] = reason is None and (judged is None or judged.has_faces)
        return self._known[pointer]

    def _judged(self, owner: Any) -> curves.Judged:
        """Objects that can share a shape are judged once; one with modifiers is never exact."""
        key = _exact_shape_key(owner, owner.data)
        if len(owner.modifiers) == 0 and key in self.curves:
            return self.curves[key]
        with curves.splines_of(owner, self._depsgraph) as splines:
            judged = curves.judge(self._core, owner, splines)
        if judged.has_faces and judged.reason is None:
            self.curves[key] = judged
        return judged


def collect(core: ModuleType, depsgraph: Any, should_stop: Callable[[], bool]) -> Instances:
    """Walk the view layer once. Blender lists a CURVE, SURFACE, FONT or META object and, if it has faces, an instance
    with its evaluated mesh: of the two exactly one is taken."""
    listed = depsgraph.object_instances
    count = len(listed)
    result = Instances([], [], _matrices(listed, count), _randoms(listed, count), {}, [], {}, {})
    shown, with_particles = _flags(listed, "show_self", count), _flags(listed, "show_particles", count)

    groups: dict[tuple[int, int], Group | None] = {}
    hair: dict[int, list[Group]] = {}
    exact = _ExactForms(core, depsgraph)
    for place, instance in enumerate(listed):
        if place % _CANCEL_STRIDE == 0 and should_stop():
            raise ExportCancelled
        if not shown[place] and not with_particles[place]:
            continue
        item = instance.object
        data = item.data
        if data is None:
            continue
        owner = instance.instance_object
        is_instance = owner is not None
        if with_particles[place]:
            _collect_hair(owner if is_instance else item, place, hair, result)
            if not shown[place]:
                continue
        key = ((owner if is_instance else item).as_pointer(), data.as_pointer())
        try:
            group = groups[key]
        except KeyError:
            group = groups[key] = _new_group(item, owner, data, exact, result)
            if group is not None:
                result.groups.append(group)
        if group is not None:
            group.members.append(place)
            if not is_instance:
                result.randoms[place] = random_of_name(item.name)
        elif item.type == "LIGHT":
            result.lamps.append((owner if is_instance else item, place))
    with_faces = {group.owner.as_pointer() for group in result.groups}
    result.reasons, result.curves = exact.reasons, exact.curves
    result.without_faces = [owner for owner in result.without_faces if owner.as_pointer() not in with_faces]
    return result


def _collect_hair(owner: Any, place: int, known: dict[int, list[Group]], result: Instances) -> None:
    """The particle hair of an object, one group a system."""
    pointer = owner.as_pointer()
    if pointer not in known:
        count = len(hair_systems(owner)) if owner.type == "MESH" else 0
        known[pointer] = [Group(owner, owner.data, False, True, [], hair=number) for number in range(count)]
        result.groups += known[pointer]
    for group in known[pointer]:
        group.members.append(place)


def _new_group(item: Any, owner: Any, data: Any, exact: _ExactForms, result: Instances) -> Group | None:
    """The group an instance of a new kind opens; None for what is no shape."""
    kind = item.type
    settings = item if owner is None else owner
    if kind == "MESH":
        if settings.type in WITH_EXACT_FORM and exact.has(settings):
            return None  # the mesh beside exact splines
        return Group(settings, data, exact=False, from_owner=_is_own_data(settings, data), members=[])
    if kind in WITH_EXACT_FORM and exact.has(settings):
        return Group(settings, data, exact=True, from_owner=True, members=[])
    if kind == "CURVES":
        return Group(settings, data, exact=False, from_owner=True, members=[])
    if kind in _UNSUPPORTED:
        result.skipped[settings.name] = f"{_UNSUPPORTED[kind]} are not supported"
    if kind in _WITH_MESH_TWIN:
        result.without_faces.append(settings)
    return None


def _is_own_data(owner: Any, data: Any) -> bool:
    """True if the mesh is the owner's own, or made from it; geometry nodes may instance meshes of others."""
    return owner.type in _WITH_MESH_TWIN or owner.data is None or owner.data.as_pointer() == data.as_pointer()


def _flags(listed: Any, name: str, count: int) -> list[bool]:
    values = np.empty(count, bool)
    listed.foreach_get(name, values)
    return [bool(value) for value in values.tolist()]


def _matrices(listed: Any, count: int) -> NDArray[np.float64]:
    values = np.empty(count * 16, np.float32)
    listed.foreach_get("matrix_world", values)
    # Blender stores matrices by columns.
    return np.ascontiguousarray(values.reshape(-1, 4, 4).transpose(0, 2, 1), np.float64)


def _randoms(listed: Any, count: int) -> NDArray[np.float32]:
    values = np.empty(count, np.int32)
    listed.foreach_get("random_id", values)
    return (values.astype(np.int64) & _RANDOM_RANGE).astype(np.float32) / np.float32(_RANDOM_RANGE)


def visibility(owner: Any, view_layer: Any) -> int:
    """The core's visibility bits of an object in a view layer."""
    bits = 0
    for flag, name in (
        (VISIBLE_CAMERA, "visible_camera"),
        (VISIBLE_DIFFUSE, "visible_diffuse"),
        (VISIBLE_GLOSSY, "visible_glossy"),
        (VISIBLE_TRANSMISSION, "visible_transmission"),
        (VISIBLE_SHADOW, "visible_shadow"),
    ):
        if getattr(owner, name, True):
            bits |= flag
    original = owner.original
    if original.indirect_only_get(view_layer=view_layer):
        bits &= ~VISIBLE_CAMERA
    return bits


def is_holdout(owner: Any, view_layer: Any) -> bool:
    """True if the object cuts a hole into the picture, by itself or by its collection."""
    original = owner.original
    return bool(original.is_holdout or original.holdout_get(view_layer=view_layer))
