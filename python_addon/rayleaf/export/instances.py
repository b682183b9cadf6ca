"""The objects of a view layer, each once, grouped by what they share: up to millions of instances in seconds."""

from array import array
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
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
    members: list[int]  # places in Instances
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

    matrices: NDArray[np.float64]  # (n, 4, 4) by place: the number of what is rendered
    numbers: NDArray[np.int64]  # (n,) in the depsgraph's list
    randoms: NDArray[np.float32]  # (n,) 0..1
    groups: list[Group] = field(default_factory=list)
    lamps: list[tuple[Any, int]] = field(default_factory=list)  # evaluated lamp object, place
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


# Of what makes an instance: visibility bits that it leaves, whether it cuts out of the picture, whether it catches shadows.
_Left = tuple[int, bool, bool]


class _Collector:
    """Walks over Blender's list of instances once.

    Blender lists a CURVE, SURFACE, FONT or META object and, if it has faces, an instance with its evaluated mesh: of the
    two exactly one is taken.
    """

    def __init__(self, core: ModuleType, depsgraph: Any, space: Any, motions: Motions, linked: bool) -> None:
        self._exact = _ExactForms(core, depsgraph, motions)
        self._depsgraph, self._motions = depsgraph, motions
        self._space, self._linked = space, linked
        self._known: dict[tuple[int, int, int, _Left], Group | None] = {}
        self._has_catchers = has_shadow_catchers(depsgraph)
        self._left: dict[int, _Left] = {}  # by what makes instances
        self._hair: dict[int, list[Group]] = {}
        self._clouds = CloudNumbers()
        self._twins: list[Group] = []  # the meshes beside splines that may turn out not to be exact
        self._rows, self._randoms = array("f"), array("d")  # three rows of each matrix; 0..1
        self._numbers = array("q")
        self._result = Instances(np.empty((0, 4, 4)), np.empty(0, np.int64), np.empty(0, np.float32))

    def take(self, number: int, instance: Any, check_cancel: Callable[[], None]) -> None:
        """The instance of a number of the list. Scattered things are hundreds of thousands, so little is asked of each."""
        shown, with_particles = instance.show_self, instance.show_particles
        if not shown and not with_particles or self._space is not None and self._is_hidden(instance):
            return
        item, owner = instance.object, instance.instance_object
        is_subdivided = owner is None and last_subdivision(item, self._depsgraph) is not None
        data = None if is_subdivided else item.data
        if data is None and not is_subdivided:
            return
        settings = item if owner is None else owner
        pointer, place = settings.as_pointer(), None
        if with_particles:
            hair = self._hair.get(pointer)
            if hair is None:
                hair = self._hair[pointer] = self._hair_of(settings)
            if hair:
                place = self._add_place(number, instance)
                for group in hair:
                    group.members.append(place)
        if not shown:
            return
        maker = instance.parent if owner is not None else None
        maker_pointer = 0 if maker is None else maker.as_pointer()
        left = self._left.get(maker_pointer)
        if left is None:
            left = self._left[maker_pointer] = self._left_by(maker)
        of_maker = maker_pointer if self._linked else 0
        key = (pointer, 0 if data is None else data.as_pointer(), of_maker, left)
        try:
            known = self._known[key]
        except KeyError:
            check_cancel()
            known = self._known[key] = self._new_group(item, owner, data, maker, left)
        if known is None and item.type != "LIGHT":
            return
        if place is None:
            place = self._add_place(number, instance)
        if known is None:
            self._result.lamps.append((settings, place))
            if owner is None:
                self._randoms[place] = random_of_name(bytes_of_name(item))
            self._result.instanced_lamps |= owner is not None
            return
        known.members.append(place)
        if owner is None:
            self._randoms[place] = random_of_name(bytes_of_name(item))
            return
        known.instanced = True
        system = instance.particle_system
        if system is not None:
            self._result.particles[place] = (system, instance.persistent_id[0])

    def _add_place(self, number: int, instance: Any) -> int:
        """A number for an instance that is rendered."""
        place = len(self._numbers)
        self._numbers.append(number)
        # Rows of a copy do not ask the instance for each of their numbers.
        first, second, third, _ = instance.matrix_world.copy()
        self._rows.fromlist([*first, *second, *third])
        self._randoms.append((instance.random_id & _RANDOM_RANGE) / _RANDOM_RANGE)
        motion = self._motions.of(instance)
        if motion is not None:
            self._result.motions[place] = motion
        return place

    def _left_by(self, maker: Any) -> _Left:
        if maker is None:
            return ~0, False, False
        layer = self._depsgraph.view_layer
        in_footage = self._has_catchers and maker.is_shadow_catcher
        return visibility(maker, layer) | IN_FOOTAGE, is_holdout(maker, layer), in_footage

    def _is_hidden(self, instance: Any) -> bool:
        """Whether a 3-D view hides what others show, as local view does."""
        shown = instance.parent if instance.is_instance else instance.object
        return shown is not None and not shown.visible_in_viewport_get(self._space)

    def result(self, check_cancel: Callable[[], None]) -> Instances:
        """What was taken."""
        result = self._result
        result.matrices = np.tile(np.eye(4), (len(self._randoms), 1, 1))
        result.matrices[:, :3] = np.frombuffer(self._rows, np.float32).reshape(-1, 3, 4)
        result.numbers = np.frombuffer(self._numbers, np.int64)
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

    def _hair_of(self, owner: Any) -> list[Group]:
        """New groups for the particle hair of an object, one a system."""
        count = len(hair_systems(owner)) if owner.type == "MESH" else 0
        groups = [Group(owner, owner.data, False, True, [], hair=number) for number in range(count)]
        self._result.groups += groups
        return groups

    def _new_group(self, item: Any, owner: Any, data: Any, maker: Any, left: _Left) -> Group | None:
        """The group an instance of a new kind opens; None for what is no shape."""
        group = self._group_of(item, item if owner is None else owner, data)
        if group is not None:
            group.shown, group.held_out, group.in_footage = left
            group.maker = maker if self._linked else None
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
        for number, instance in enumerate(listed):
            if number % _CANCEL_STRIDE == 0:
                check_cancel()
            collector.take(number, instance, check_cancel)
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
