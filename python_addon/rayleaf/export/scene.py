"""From an evaluated view layer to a scene the core can render."""

import re
from collections.abc import Callable
from types import ModuleType
from typing import Any

import numpy as np

from .. import versions
from ..messages import Messages, Subject
from ..names import name_of
from ..passes import Slots
from . import (
    CancelCheck,
    ExportError,
    camera,
    curves,
    instance_values,
    instances,
    ray_interpolation,
    unsupported,
)
from .images import ImageLibrary
from .instancer_attributes import of_instancers
from .kept import KeptExport, KeptShape
from .light_linking import LightLinks
from .lights import LightExporter
from .instances import Group, Instances
from .motion import Motions
from .materials import MaterialLibrary, VolumeMaterial, slots_of
from .nodes.resources import Resources
from .shapes import ExportReport, ShapeExporter
from .subdivision import Cages, Wrapped
from .texture_space import texture_space

_BYTES_PER_MEGABYTE = 1 << 20
# Instances sent between two questions whether to stop: some 100 ms.
_INSTANCE_CHUNK = 100_000

# How the core's messages begin.
_CORE_MESSAGE = re.compile("object '(.*?)': ", re.DOTALL)

# Why objects of these types come as meshes.
_EVALUATED_REASONS = {"META": "metaball"}


def _is_thread(group: Group) -> bool:
    """Whether a group is an exact curve, hair or points, which displacement leaves as they are."""
    is_curve = group.exact and group.owner.type != "SURFACE"
    return is_curve or group.cloud is not None or group.hair is not None or group.owner.type == "CURVES"


def _subject_of(problem: str) -> Subject | None:
    """The object that a message of the core's names."""
    found = _CORE_MESSAGE.match(problem)
    return Subject("Object", found[1]) if found else None


def _without_subject(problem: str) -> str:
    """A message of the core's without what it is about."""
    return _CORE_MESSAGE.sub("", problem, count=1)


def _asset_of(owner: Any) -> str:
    """What Cryptomatte calls an asset: the topmost parent."""
    while owner.parent is not None:
        owner = owner.parent
    return name_of(owner)


class SceneExporter(ShapeExporter, LightExporter):
    """Exports one view layer once."""

    def __init__(
        self,
        core: ModuleType,
        depsgraph: Any,
        messages: Messages,
        should_stop: Callable[[], bool] = lambda: False,
        parts: Any = None,
        former: KeptExport | None = None,
        space: Any = None,
    ) -> None:
        """`should_stop` is asked often; when it says so, `export` raises ExportCancelled. `parts`: SceneParts, or None.
        `former`: what an earlier export left, and still holds. `space`: the 3-D view that shows it, which may hide some.
        """
        self._core, self._depsgraph, self._messages = core, depsgraph, messages
        self._check_cancel = CancelCheck(should_stop)
        self._blender_scene = depsgraph.scene_eval
        self._view_layer = depsgraph.view_layer
        self._space = space
        self._former = former or KeptExport()
        self._motions = Motions()
        self.links = LightLinks.of(depsgraph.objects)
        self.scene = core.SceneDescription(parts) if self._former.scene is None else self._former.scene.emptied()
        self._cages = Cages(core, self.scene)
        self._wrapped = Wrapped(depsgraph)
        self._shapes: dict[Any, KeptShape] = {}
        self.rows: dict[int, int] | None = {}  # instances that are objects' own, by pointer; None: not known
        self.lamps: list[Any] | None = []  # original objects; None: some are instanced
        self.report = ExportReport()
        # Views show no pass by name.
        self._named = Slots.of(self._view_layer) if space is None else Slots({}, {}, (), ())
        images = ImageLibrary(core, self.scene, messages, self._check_cancel)
        self._resources = Resources(
            self.scene.attribute,
            images,
            self._blender_scene.frame_current,
            self._named.aovs,
            scene_holders=instance_values.scene_holders(depsgraph),
            scene_properties=dict(self._former.scene_properties),
        )
        self.materials = MaterialLibrary(
            core, self.scene, self._resources, messages, depsgraph, self._check_cancel, self._former
        )

    def export(
        self,
        frame: camera.Frame,
        needs_uv: bool,
        camera_arguments: dict[str, Any] | None = None,
        motions: Motions | None = None,
        eye: Callable[[], camera.Eye] | None = None,
    ) -> Any:
        """The scene description. `needs_uv`: a pass shows the UV map. `camera_arguments`: of the core's `set_camera`, where
        the scene is not seen by its own. `motions`: what moves. `eye`: where the scene's camera stands, if it is not
        itself. Raises ExportError, InputError, ExportCancelled."""
        self.scene.texture_memory = self._blender_scene.rayleaf.texture_memory * _BYTES_PER_MEGABYTE
        self._motions = motions or Motions()
        if camera_arguments is None:
            self._export_camera(frame, self._motions, eye)
        else:
            self.scene.set_camera(**camera_arguments)
        unsupported.name_scene_settings(self._blender_scene, self._messages)
        unsupported.name_passes(self._blender_scene, self._view_layer, self._messages)
        self.links.warn(self._messages)
        listed = instances.collect(
            self._core, self._depsgraph, self._check_cancel, self._space, self._motions, bool(self.links)
        )
        listed.groups = [group for group in listed.groups if self._is_in_layer(group)]
        for name, reason in listed.skipped.items():
            self._leave_out(name, reason)
        for owner in listed.without_faces:
            self.report.left_out[name_of(owner)] = f"{owner.type.lower()} without faces"
        material_lists = [self._material_list(group) for group in listed.groups]
        self.export_world()
        self._export_lamps(listed)
        if needs_uv:
            self._resources.active_uv()
        shapes = self._export_shapes(listed)
        self._note_undisplaced(listed.groups)
        self._export_instances(listed, shapes, material_lists)
        self.leave_out_unreadable_images()
        return self.scene

    def leave_out_unreadable_images(self) -> None:
        """The last step, also of an edit: images are read meanwhile."""
        self._resources.images.leave_out_unreadable()

    @property
    def left(self) -> KeptExport:
        """What a later export may go on with."""
        return KeptExport(self.scene, self._shapes, self.materials.compiled, self._resources.scene_properties)

    def reads_same_scene(self, depsgraph: Any) -> bool:
        """Whether the scene's properties that programs hold are what they were."""
        holders, held = instance_values.scene_holders(depsgraph), self._resources.scene_properties
        return all(instance_values.first_property(holders, name) == value for name, value in held.items())

    @property
    def wanted_attributes(self) -> frozenset[str]:
        """What shapes and instances carry."""
        return frozenset(self._resources.wanted_attributes)

    @property
    def textures(self) -> int:
        """How many this exporter has added."""
        return self._resources.images.added

    def edit(self, scene: Any, depsgraph: Any) -> None:
        """What is exported from now on goes into another description, a copy of the one that was."""
        self.scene = scene
        self._resources.images.go_on_in(scene)
        self._depsgraph, self._blender_scene, self._view_layer = depsgraph, depsgraph.scene_eval, depsgraph.view_layer

    def _is_in_layer(self, group: Group) -> bool:
        """Whether the view layer's filter lets a group through: hair, or any other surface."""
        if group.volume:
            return bool(self._view_layer.use_volumes)
        is_hair = group.hair is not None or group.owner.type == "CURVES"
        return bool(self._view_layer.use_strand if is_hair else self._view_layer.use_solid)

    def _note_undisplaced(self, groups: list[Group]) -> None:
        """Exact curves, hair and points stay as they are."""
        for group in groups:
            if _is_thread(group) and self._is_displaced(group):
                subject = Subject("Object", name_of(group.owner))
                self._messages.warn(f"{subject}: curves, hair and points are not displaced; left out", subject)

    def _export_camera(
        self, frame: camera.Frame, motions: Motions, eye: Callable[[], camera.Eye] | None = None
    ) -> None:
        camera_object = self._blender_scene.camera
        if camera_object is None:
            raise ExportError(f"Scene '{name_of(self._blender_scene)}' has no camera")
        seen_from = camera.eye_of(camera_object.evaluated_get(self._depsgraph)) if eye is None else eye()
        arguments = camera.describe(self._core, seen_from, frame)
        try:
            self.scene.set_camera(**arguments, **motions.camera)
        except self._core.InputError as error:  # it calls every camera by one name
            raise ExportError(f"Camera '{name_of(camera_object)}': {_without_subject(str(error))}") from error

    def _slots(self, group: Group) -> list[Any]:
        """The materials of a group, None for empty slots."""
        override = self._depsgraph.view_layer_eval.material_override
        slots = slots_of(group.owner, group.given, group.from_owner)
        return slots if override is None else [override] * max(len(slots), 1)

    def _material_list(self, group: Group) -> int:
        unsupported.name_object_settings(group.owner, self._blender_scene, self._messages)
        if group.volume:
            volume = self._volume_material(group)
            return -1 if volume is None else volume.material_list
        is_holdout = group.held_out or instances.is_holdout(group.owner, self._view_layer)
        return self.materials.slot_list(self._slots(group), is_holdout)

    def _volume_material(self, group: Group) -> VolumeMaterial | None:
        return self.materials.volume(self._slots(group))

    def _is_displaced(self, group: Group) -> bool:
        return any(slot is not None and self.materials.displaces(slot) for slot in self._slots(group))

    def _export_shapes(self, listed: Instances) -> list[int | None]:
        """The shape of each group; groups with the same data share one."""
        wanted = frozenset(self._resources.wanted_attributes)
        known: dict[Any, int | None] = {}
        result = []
        for group in listed.groups:
            self._check_cancel()
            # An object's own material may displace what another object shows smooth.
            key: Any = (group.shape_key, not _is_thread(group) and self._is_displaced(group))
            attributes = wanted
            if group.volume:
                volume = self._volume_material(group)
                attributes = frozenset() if volume is None else volume.reads
                key = (group.shape_key, attributes)
            if key not in known:
                known[key] = self._kept_or_exported(key, group, attributes, listed.judged)
            result.append(known[key])
            self._note_way(group, listed.reasons)
        self.report.shapes = sum(shape is not None for shape in known.values())
        return result

    def _kept_or_exported(
        self, key: Any, group: Group, wanted: frozenset[str], judged: dict[Any, curves.Judged]
    ) -> int | None:
        sources = self._sources(group)
        kept = self._former.shapes.get(key)
        if kept is not None and kept.is_of(sources, wanted):
            self._shapes[key] = kept
            return int(self.scene.add_shape(kept.shape))
        index = self._export_shape(group, wanted, judged)
        space = texture_space(group.owner.original.data if group.given is None else group.given)
        if index is not None and space is not None:
            self.scene.set_texture_space(index, *space)
        if index is not None and group.hair is None:  # hair depends on settings that are no data block's of these
            self._shapes[key] = KeptShape(self.scene.shape(index), sources, wanted)
        return index

    def _sources(self, group: Group) -> frozenset[int]:
        """As of the group, and what decides whether it is a mesh."""
        other = self._wrapped.by(group.owner) if group.given is None else None
        return group.sources if other is None else group.sources | {other.original.as_pointer()}

    def _note_way(self, group: Group, reasons: dict[str, str]) -> None:
        """Which way an object went: exact or as a mesh, and why."""
        name, kind = name_of(group.owner), group.owner.type
        if name in self.report.left_out:
            return
        if group.hair is not None or kind == "CURVES":
            if name not in self.report.strands:
                self.report.strands.append(name)
            return
        if group.exact:
            if name not in self.report.exact:
                self.report.exact.append(name)
        elif kind in instances.WITH_EXACT_FORM:
            self.report.evaluated[name] = reasons.get(name, "geometry made by other means")
        elif kind in _EVALUATED_REASONS:
            self.report.evaluated[name] = _EVALUATED_REASONS[kind]

    def _export_instances(self, listed: Instances, shapes: list[int | None], material_lists: list[int]) -> None:
        chosen = [
            (group, shape, materials)
            for group, shape, materials in zip(listed.groups, shapes, material_lists, strict=True)
            if shape is not None
        ]
        if not chosen:
            return
        counts = [len(group.members) for group, _, _ in chosen]
        self._note_rows([group for group, _, _ in chosen], counts)
        places = np.concatenate([np.array(group.members, np.int64) for group, _, _ in chosen])

        def spread(values: list[int]) -> Any:
            return np.repeat(np.array(values, np.int32), counts)

        names = [name for group, _, _ in chosen for name in [name_of(group.owner)] * len(group.members)]
        columns = (
            spread([shape for _, shape, _ in chosen]),
            spread([materials for _, _, materials in chosen]),
            spread([group.owner.pass_index for group, _, _ in chosen]),
            spread([self._visibility(group) for group, _, _ in chosen]),
            spread([self._ray_interpolation(group.owner) for group, _, _ in chosen]),
            spread([self._light_group(group.owner) for group, _, _ in chosen]),
        )
        terminators = [versions.shadow_terminator(group.owner) for group, _, _ in chosen]
        terminator_rows = np.repeat(np.array(terminators, np.float32), counts)
        linkings = None
        if self.links:
            rows = [self.links.row(group.owner, group.maker) for group, _, _ in chosen]
            linkings = np.repeat(np.array(rows, np.int64), counts, axis=0)
        assets = [name for group, _, _ in chosen for name in [_asset_of(group.owner)] * len(group.members)]
        values = self._instance_values(listed, [(group.owner, group.members) for group, _, _ in chosen])
        for first in range(0, len(places), _INSTANCE_CHUNK):
            self._check_cancel()
            part = slice(first, first + _INSTANCE_CHUNK)
            shape, materials, index, visibility, interpolation, light_groups = (column[part] for column in columns)
            matrices, randoms = listed.matrices[places[part]], listed.randoms[places[part]]
            problems = self.scene.add_instances(
                names[part],
                shape,
                matrices,
                materials,
                index,
                randoms,
                visibility,
                interpolation,
                {identifier: rows[part] for identifier, rows in values.items()},
                light_groups,
                assets[part],
                {row: listed.motions[place] for row, place in enumerate(places[part]) if place in listed.motions}
                if listed.motions
                else None,
                terminator_rows[part],
                None if linkings is None else linkings[part],
            )
            self.report.instances += len(shape) - len(problems)
            for problem in problems:
                self.rows = None  # those that follow have moved up
                self._messages.warn(f"{problem}; left out", _subject_of(problem))

    def _visibility(self, group: Group) -> int:
        return group.shown & instances.visibility(group.owner, self._view_layer, group.in_footage)

    def _note_rows(self, groups: list[Group], counts: list[int]) -> None:
        rows: dict[int, int] = {}
        instanced: set[int] = set()
        for group, first, count in zip(groups, np.cumsum([0, *counts]), counts, strict=False):
            pointer = group.owner.original.as_pointer()
            if group.instanced or count > 1 or pointer in rows:
                instanced.add(pointer)
            rows[pointer] = int(first)
        self.rows = {pointer: row for pointer, row in rows.items() if pointer not in instanced}

    def _instance_values(self, listed: Instances, owned: list[tuple[Any, list[int]]]) -> dict[int, Any]:
        """What materials ask for of whole instances: (instances, 4) by attribute."""
        values = {}
        for name in filter(instance_values.is_instance_value, self._resources.wanted_attributes):
            rows: list[Any] = []
            of_all = self._of_instancers(name)
            of_place = None if of_all is None else of_all[listed.numbers]
            for owner, members in owned:
                if of_place is not None:
                    rows += of_place[members].tolist()
                elif name.startswith(instance_values.PARTICLE):
                    frame, particles = self._resources.frame, listed.particles
                    rows += [instance_values.of_particle(particles.get(place), name, frame) for place in members]
                else:
                    rows += [instance_values.of_object(owner, name)] * len(members)
            values[self._resources.attribute_id(name)] = np.array(rows, np.float32)
        return values

    def _of_instancers(self, name: str) -> Any | None:
        """(n, 4): what instances have from what makes them, of all in the depsgraph's list; None for other attributes."""
        if name.startswith(instance_values.INSTANCER):
            return instance_values.of_instancer(self._depsgraph, name)
        if not name.startswith(instance_values.INSTANCER_ATTRIBUTE):
            return None
        return of_instancers(self._depsgraph, name.removeprefix(instance_values.INSTANCER_ATTRIBUTE), self._messages)

    def _ray_interpolation(self, owner: Any) -> int:
        """The index of an object's own settings for ray interpolation, -1 for the scene's."""
        own = ray_interpolation.of_object(
            self._core, owner.rayleaf.ray_interpolation, self._blender_scene.rayleaf.ray_interpolation
        )
        return -1 if own is None else int(self.scene.add_ray_interpolation(name_of(owner), own))
