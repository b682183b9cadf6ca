"""The objects of a view layer, each once, grouped by what they share: up to millions of instances in seconds."""

from array import array
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from itertools import chain
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..names import bytes_of_name, name_of
from . import curves, surfaces
from .deformation import MESH, WITH_MESH_TWIN, Deformation, is_own_data
from .motion import CloudNumbers, Motions
from .random_numbers import random_of_name
from .strands import curve_settings, hair_systems
from .subdivision import last_subdivision
from .volumes import gas_domain

# Instances between two questions whether to stop: some 10 ms.
_CANCEL_STRIDE = 10_000
# Blender gives an instance's random number as 32 bits.
_RANDOM_RANGE = 0xFFFFFFFF

VISIBLE_CAMERA, VISIBLE_DIFFUSE, VISIBLE_GLOSSY, VISIBLE_TRANSMISSION, VISIBLE_SHADOW = 1, 2, 4, 8, 16
VISIBLE_VOLUME = 32  # to rays that a medium has scattered
IN_FOOTAGE = 64  # shadow catchers, and lamps that light them

# Of what has a mesh beside it, what the core can render from control points.
WITH_EXACT_FORM = {"SURFACE", "CURVE", "FONT"}
_UNSUPPORTED = {"GPENCIL": "grease pencil"}


@dataclass
class Group:
    """Instances that share geometry, materials and settings."""

    owner: Any  # the evaluated object whose settings count
    given: Any  # what is rendered: a Mesh, or the data of an exact surface or curve; None: the owner's subdivided mesh
    exact: bool  # splines, not a mesh
    from_owner: bool  # the data is the owner's own, so its material slots count
    members: list[int]  # places in the depsgraph's list of instances
    hair: int | None = None  # which of the owner's hair particle systems, in place of the data
    instanced: bool = False  # some member is made by another object
    in_footage: bool = False  # what makes them is a shadow catcher
    volume: bool = False  # the data is a Volume, or the mesh of a simulation's domain
    cloud: int | None = None  # the data is a PointCloud: which of its owner's
    maker: Any = None  # what makes them, where lights are linked
    shown: int = ~0  # visibility bits that what makes them leaves
    held_out: bool = False  # what makes them is a holdout

    @property
    def data(self) -> Any:
        """What is rendered. Blender's window leaves subdivision to the graphics card until somebody asks for the mesh."""
        return self.owner.data if self.given is None else self.given

    @property
    def sources(self) -> frozenset[int]:
        """Pointers of the original data blocks that its geometry comes from."""
        owner = self.owner.original
        blocks = [owner] if owner.data is None else [owner, owner.data]
        return frozenset(block.as_pointer() for block in blocks)

    @property
    def shape_key(self) -> Any:
        """Equal for groups that can share one shape in the core."""
        if self.hair is not None:
            return (self.owner.as_pointer(), self.hair)
        if self.given is None:
            return self.owner.as_pointer()
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

    matrices: NDArray[np.float64]  # (n, 4, 4) of every place
    randoms: NDArray[np.float32]  # (n,) 0..1
    groups: list[Group] = field(default_factory=list)
    lamps: list[tuple[Any, int]] = field(default_factory=list)  # evaluated lamp object, place in the list
    instanced_lamps: bool = False  # some lamp is made by another object
    skipped: dict[str, str] = field(default_factory=dict)  # object name -> why it is not rendered
    without_faces: list[Any] = field(default_factory=list)  # curves, texts and the like of which Blender makes no mesh
    reasons: dict[str, str] = field(default_factory=dict)  # object name -> why not from control points
    particles: dict[int, tuple[Any, int]] = field(default_factory=dict)  # place -> its particle system, and the number
    motions: dict[int, NDArray[np.float64]] = field(default_factory=dict)  # place -> matrices, of what moves
    judged: dict[Any, curves.Judged] = field(default_factory=dict)  # what is known of a CURVE or FONT, by shape key


class _ExactForms:
    """Which objects are rendered from control points."""

    def __init__(self, core: ModuleType, depsgraph: Any, motions: Motions) -> None:
        self.reasons: dict[str, str] = {}
        self.curves: dict[Any, curves.Judged] = {}
        self._core, self._depsgraph, self._motions = core, depsgraph, motions
        self._known: dict[int, bool] = {}
        self._open: dict[int, tuple[Any, curves.Judged]] = {}  # by pointer: who may still turn out not to be
        self._sweeps = curve_settings(depsgraph.scene_eval.rayleaf).primitive == "EXACT"

    def has(self, owner: Any) -> bool:
        """Whether an object is rendered from its control points. Of filled curves `settle` may still take it back."""
        pointer = owner.as_pointer()
        if pointer not in self._known:
            judged = None if owner.type == "SURFACE" else self._judged(owner)
            reason = self._reason(owner, judged) if judged else surfaces.fallback_reason(owner)
            if reason is not None:
                self.reasons[name_of(owner)] = reason
            self._known[pointer] = reason is None and (judged is None or judged.has_faces)
            if judged is not None and judged.is_open:
                self._open[pointer] = owner, judged
        return self._known[pointer]

    def is_open(self, owner: Any) -> bool:
        """Whether `settle` may take back what `has` said."""
        return owner.as_pointer() in self._open

    def settle(self, check_cancel: Callable[[], None]) -> set[int]:
        """Pointers of those objects that are not after all. The core has had time to make their surfaces."""
        failed = set()
        for pointer, (owner, judged) in self._open.items():
            check_cancel()
            judged.settle(self._core)
            if judged.reason is not None:
                self.reasons[name_of(owner)] = judged.reason
                failed.add(pointer)
        self._open = {}
        self.curves = {key: judged for key, judged in self.curves.items() if judged.reason is None}
        return failed

    def _reason(self, owner: Any, judged: curves.Judged) -> str | None:
        if judged.reason is not None:
            return judged.reason
        reason = self._deforms(owner)
        if reason is not None:
            judged.settle(self._core)
        return judged.reason or reason

    def _deforms(self, owner: Any) -> str | None:
        """A curve's rings are exact at one time only: what its polygons can follow is blurred as these are."""
        followed = isinstance(self._motions.deformation(owner, (MESH, 0)), Deformation)
        return "it deforms while the shutter is open" if followed else None

    def _judged(self, owner: Any) -> curves.Judged:
        """Objects that can share a shape are judged once; one with modifiers is never exact."""
        key = _exact_shape_key(owner, owner.data)
        if len(owner.modifiers) == 0 and key in self.curves:
            return self.curves[key]
        with curves.splines_of(owner, self._depsgraph) as splines:
            judged = curves.judge(self._core, owner, splines)
        if judged.has_faces and judged.reason is None:
            self.curves[key] = judged
        if judged.curve is not None and self._sweeps:
            judged.curve.begin()
        return judged


class _Collector:
    """Walks over Blender's list of instances once.

    Blender lists a CURVE, SURFACE, FONT or META object and, if it has faces, an instance with its evaluated mesh: of the
    two exactly one is taken.
    """

    def __init__(self, core: ModuleType, depsgraph: Any, space: Any, motions: Motions, linked: bool) -> None:
        self._exact = _ExactForms(core, depsgraph, motions)
        self._depsgraph, self._motions = depsgraph, motions
        self._space, self._linked = space, linked
        self._known: dict[tuple[int, int, bool, int, int, bool], Group | None] = {}
        self._has_catchers = has_shadow_catchers(depsgraph)
        self._makers: dict[int, tuple[int, bool]] = {}
        self._hair: dict[int, list[Group]] = {}
        self._clouds = CloudNumbers()
        self._twins: list[Group] = []  # the meshes beside splines that may turn out not to be exact
        self._matrices, self._randoms = array("f"), array("d")
        self._result = Instances(np.empty((0, 4, 4)), np.empty(0, np.float32))

    def take(self, place: int, instance: Any, check_cancel: Callable[[], None]) -> None:
        """The instance at a place of the list."""
        self._matrices.extend(chain.from_iterable(instance.matrix_world))
        self._randoms.append((instance.random_id & _RANDOM_RANGE) / _RANDOM_RANGE)
        shown, with_particles = instance.show_self, instance.show_particles
        if not shown and not with_particles:
            return
        motion = self._motions.of(instance)
        if motion is not None:
            self._result.motions[place] = motion
        if self._space is not None and self._is_hidden(instance):
            return
        item, owner = instance.object, instance.instance_object
        is_subdivided = owner is None and last_subdivision(item, self._depsgraph) is not None
        data = None if is_subdivided else item.data
        if data is None and not is_subdivided:
            return
        settings = item if owner is None else owner
        if with_particles:
            self._take_hair(settings, place)
        if not shown:
            return
        in_footage = self._has_catchers and owner is not None and instance.parent.is_shadow_catcher
        maker = instance.parent if self._linked and owner is not None else None
        key = (
            settings.as_pointer(),
            0 if data is None else data.as_pointer(),
            in_footage,
            0 if maker is None else maker.as_pointer(),
            *self._left_by(instance.parent if owner is not None else None),
        )
        try:
            group = self._known[key]
        except KeyError:
            check_cancel()
            group = self._known[key] = self._new_group(item, owner, data)
        if group is not None:
            group.members.append(place)
            group.in_footage, group.maker = in_footage, maker
            group.shown, group.held_out = key[-2:]
            group.instanced |= owner is not None
            system = None if owner is None else instance.particle_system
            if system is not None:
                self._result.particles[place] = (system, instance.persistent_id[0])
            if owner is None:
                self._randoms[place] = random_of_name(bytes_of_name(item))
        elif item.type == "LIGHT":
            self._result.lamps.append((settings, place))
            self._result.instanced_lamps |= owner is not None

    def _left_by(self, maker: Any) -> tuple[int, bool]:
        """The visibility bits that an object leaves to what it makes, and whether it cuts that out of the picture."""
        if maker is None:
            return ~0, False
        pointer = maker.as_pointer()
        if pointer not in self._makers:
            layer = self._depsgraph.view_layer
            self._makers[pointer] = visibility(maker, layer) | IN_FOOTAGE, is_holdout(maker, layer)
        return self._makers[pointer]

    def _is_hidden(self, instance: Any) -> bool:
        """Whether a 3-D view hides what others show, as local view does."""
        shown = instance.parent if instance.is_instance else instance.object
        return shown is not None and not shown.visible_in_viewport_get(self._space)

    def result(self, check_cancel: Callable[[], None]) -> Instances:
        """What was taken."""
        result = self._result
        result.matrices = np.frombuffer(self._matrices, np.float32).reshape(-1, 4, 4).astype(np.float64)
        result.randoms = np.frombuffer(self._randoms, np.float64).astype(np.float32)
        self._settle(check_cancel)
        result.reasons, result.judged = self._exact.reasons, self._exact.curves
        with_faces = {group.owner.as_pointer() for group in result.groups}
        result.without_faces = [owner for owner in result.without_faces if owner.as_pointer() not in with_faces]
        return result

    def _settle(self, check_cancel: Callable[[], None]) -> None:
        """Keep one of each two groups of which one was too many."""
        result, failed = self._result, self._exact.settle(check_cancel)
        taken_back = [group for group in result.groups if group.exact and group.owner.as_pointer() in failed]
        result.without_faces += [group.owner for group in taken_back]
        needless = [group for group in self._twins if group.owner.as_pointer() not in failed]
        dropped = {id(group) for group in taken_back + needless}
        result.groups = [group for group in result.groups if id(group) not in dropped]

    def _take_hair(self, owner: Any, place: int) -> None:
        """The particle hair of an object, one group a system."""
        pointer = owner.as_pointer()
        if pointer not in self._hair:
            count = len(hair_systems(owner)) if owner.type == "MESH" else 0
            self._hair[pointer] = [Group(owner, owner.data, False, True, [], hair=number) for number in range(count)]
            self._result.groups += self._hair[pointer]
        for group in self._hair[pointer]:
            group.members.append(place)

    def _new_group(self, item: Any, owner: Any, data: Any) -> Group | None:
        """The group an instance of a new kind opens; None for what is no shape."""
        group = self._group_of(item, item if owner is None else owner, data)
        if group is not None:
            self._result.groups.append(group)
        return group

    def _group_of(self, item: Any, settings: Any, data: Any) -> Group | None:
        kind = item.type
        if kind == "MESH":
            beside_splines = settings.type in WITH_EXACT_FORM and self._exact.has(settings)
            if beside_splines and not self._exact.is_open(settings):
                return None
            own = data is None or is_own_data(settings, data)
            smokes = own and settings.type == "MESH" and gas_domain(settings) is not None
            group = Group(settings, data, exact=False, from_owner=own, members=[], volume=smokes)
            if beside_splines:
                self._twins.append(group)
            return group
        if kind in WITH_EXACT_FORM and settings.type == kind and self._exact.has(settings):
            return Group(settings, data, exact=True, from_owner=True, members=[])
        if kind == "VOLUME":
            return Group(settings, data, exact=False, from_owner=settings.type == kind, members=[], volume=True)
        if kind == "POINTCLOUD":
            own, number = settings.type == kind, self._clouds.of(settings, data)
            return Group(settings, data, exact=False, from_owner=own, members=[], cloud=number)
        if kind == "CURVES":
            return Group(settings, data, exact=False, from_owner=True, members=[])
        if kind in _UNSUPPORTED:
            self._result.skipped[name_of(settings)] = f"{_UNSUPPORTED[kind]} are not supported"
        if kind in WITH_MESH_TWIN:
            self._result.without_faces.append(settings)
        return None


def collect(
    core: ModuleType,
    depsgraph: Any,
    check_cancel: Callable[[], None],
    space: Any = None,
    motions: Motions | None = None,
    linked: bool = False,
) -> Instances:
    """Walk over the view layer once. `space`: a 3-D view, which may hide some. `linked`: lights are.

    Blender frees the instances that an object makes only when their list has been walked to its end. `foreach_get` looks at
    the first entry alone to learn its type, and leaves such a list behind: so values are read one by one, and whoever stops
    early goes on to the end.
    """
    collector = _Collector(core, depsgraph, space, motions or Motions(), linked)
    listed = iter(depsgraph.object_instances)
    try:
        for place, instance in enumerate(listed):
            if place % _CANCEL_STRIDE == 0:
                check_cancel()
            collector.take(place, instance, check_cancel)
    finally:
        deque(listed, maxlen=0)
    return collector.result(check_cancel)


def has_shadow_catchers(depsgraph: Any) -> bool:
    """Whether some object catches shadows."""
    return any(item.is_shadow_catcher and item.type != "LIGHT" for item in depsgraph.objects)


def visibility(owner: Any, view_layer: Any, in_footage: bool = False) -> int:
    """The core's visibility bits of an object in a view layer. `in_footage`: whatever the object says."""
    is_caught = (in_footage or owner.is_shadow_catcher) and not is_holdout(owner, view_layer)
    bits = IN_FOOTAGE if is_caught else 0
    for flag, name in (
        (VISIBLE_CAMERA, "visible_camera"),
        (VISIBLE_DIFFUSE, "visible_diffuse"),
        (VISIBLE_GLOSSY, "visible_glossy"),
        (VISIBLE_TRANSMISSION, "visible_transmission"),
        (VISIBLE_SHADOW, "visible_shadow"),
        (VISIBLE_VOLUME, "visible_volume_scatter"),
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
