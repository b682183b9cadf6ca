"""Shapes of the core from what objects are made of: splines, hair, cages, meshes."""

from dataclasses import dataclass, field
from types import ModuleType
from typing import Any

from ..messages import Messages, Subject
from ..names import name_of
from . import CancelCheck, curves, meshes, strand_arrays, strands, subdivision, surfaces
from .instances import Group


@dataclass
class ExportReport:
    """What was sent, and how."""

    exact: list[str] = field(default_factory=list)  # objects sent as splines
    strands: list[str] = field(default_factory=list)  # objects whose hair was sent
    subdivision: list[str] = field(default_factory=list)  # objects sent as cages
    evaluated: dict[str, str] = field(default_factory=dict)  # object -> why as its evaluated mesh
    left_out: dict[str, str] = field(default_factory=dict)  # object -> why not rendered
    shapes: int = 0
    instances: int = 0
    lamps: int = 0


class ShapeExporter:
    """Sends the shape of one group of instances."""

    scene: Any  # the core's SceneDescription
    report: ExportReport
    _core: ModuleType
    _depsgraph: Any
    _blender_scene: Any
    _messages: Messages
    _check_cancel: CancelCheck

    def _is_displaced(self, group: Group) -> bool:
        """Whether a material of the group moves its points."""
        raise NotImplementedError

    def _export_shape(self, group: Group, wanted: frozenset[str], judged: dict[Any, curves.Judged]) -> int | None:
        if group.hair is not None or group.owner.type == "CURVES":
            return self._export_strands(group, wanted)
        return self._export_surface(group, judged) if group.exact else self._export_mesh(group, wanted)

    def _export_strands(self, group: Group, wanted: frozenset[str]) -> int | None:
        name = name_of(group.owner)
        if group.hair is None:
            arrays = strands.curves_strands(self._core, group.data, wanted)
        else:
            system, modifier = strands.hair_systems(group.owner)[group.hair]
            arrays = strands.particle_strands(group.owner, system, modifier, wanted, self._check_cancel)
        if arrays is None:
            self._messages.note(f"Object '{name}' has no hair; left out", Subject("Object", name))
            return None
        dropped = strand_arrays.without_bad_points(arrays)
        if dropped:
            subject = Subject("Object", name)
            self._messages.warn(f"{subject}: {dropped} strands have points that are not finite; left out", subject)
        try:
            settings = strands.curve_settings(self._blender_scene.rayleaf)
            return strands.add_strands(self._core, self.scene, name, arrays, settings, wanted)
        except self._core.InputError as error:
            self._leave_out(name, str(error))
            return None

    def _export_surface(self, group: Group, judged: dict[Any, curves.Judged]) -> int | None:
        name = name_of(group.owner)
        if group.owner.type == "SURFACE":
            shape = surfaces.add_surface(self._core, self.scene, group.owner, self._messages)
        else:
            settings = strands.curve_settings(self._blender_scene.rayleaf)
            # Once is enough: groups with the same key share the shape, and a million splines take memory.
            found = judged.pop(group.shape_key)
            shape = curves.add_curve(self._core, self.scene, name, found, self._messages, settings)
        if shape is None:
            self.report.left_out.setdefault(name, "no spline that can be rendered")
        return shape

    def _export_mesh(self, group: Group, wanted: frozenset[str]) -> int | None:
        if group.from_owner and subdivision.last_subdivision(group.owner, self._depsgraph) is not None:
            shape = self._export_cage(group.owner, wanted)
            if shape is not None:
                return shape
        if self._is_displaced(group):
            shape = self._export_polygons(group, wanted)
            if shape is not None:
                return shape
        name = name_of(group.owner)
        arrays = meshes.mesh_arrays(group.data, wanted)
        if arrays is None:
            self.report.left_out[name] = "no faces"
            self._messages.note(f"Object '{name}' has no faces; left out", Subject("Object", name))
            return None
        try:
            return meshes.add_mesh(self.scene, name, arrays)
        except self._core.InputError as error:
            self._leave_out(name, str(error))
            return None

    def _export_cage(self, owner: Any, wanted: frozenset[str]) -> int | None:
        """The shape of a mesh that is subdivided last; None, and a line in the report, if Blender's mesh must do."""
        name = name_of(owner)
        reason = subdivision.fallback_reason(owner, self._depsgraph, self._blender_scene.rayleaf)
        if reason is None:
            try:
                arrays = subdivision.cage_arrays(owner, self._depsgraph, wanted)
                if arrays is None:
                    return None
                shape = subdivision.add_cage(self._core, self.scene, name, arrays)
                self.report.subdivision.append(name)
                return shape
            except self._core.InputError as error:
                reason = str(error)
                self._messages.warn(f"{reason}; Blender's mesh is rendered", Subject("Object", name))
        self.report.evaluated[name] = reason
        return None

    def _export_polygons(self, group: Group, wanted: frozenset[str]) -> int | None:
        """The shape of a mesh that has points wherever displacement asks for them; None, and a warning, without."""
        name = name_of(group.owner)
        try:
            arrays = subdivision.polygon_arrays(group.data, wanted)
            return None if arrays is None else subdivision.add_cage(self._core, self.scene, name, arrays)
        except self._core.InputError as error:
            self._messages.warn(f"{error}; its displacement is left out", Subject("Object", name))
            return None

    def _leave_out(self, name: str, reason: str) -> None:
        self.report.left_out[name] = reason
        text = reason if name in reason else f"Object '{name}': {reason}"
        self._messages.warn(f"{text}; left out", Subject("Object", name))
