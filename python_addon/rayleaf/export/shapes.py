"""Shapes of the core from what objects are made of: splines, hair, cages, meshes."""

from dataclasses import dataclass, field, replace
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import cycles_versions
from ..messages import Messages, Subject
from ..names import name_of
from . import CancelCheck, curves, meshes, points, strand_arrays, strands, subdivision, surfaces, volumes
from .deformation import CAGE, CURVES, HAIR, MESH, POINTS, SPLINES, Deformation, Part
from .instances import Group
from .motion import Motions


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
    _motions: Motions
    _cages: subdivision.Cages
    _wrapped: subdivision.Wrapped

    def _deformation(self, group: Group, part: Part) -> Deformation | None:
        """How a part of a group's owner deforms; what cannot be followed is said."""
        found = self._motions.deformation(group.owner, part)
        if not isinstance(found, str):
            return found
        self._note_still(group.owner, found)
        return None

    def _exact_points(self, group: Group, part: Part, count: int) -> NDArray[Any] | None:
        """The control points, of which there are so many, of an exact surface that deforms: (steps, count, 3 or 4)."""
        if self._is_displaced(group):
            self._note_displaced(group, part)
            return None
        found = self._deformation(group, part)
        return None if found is None or found.points.shape[1] != count else found.points

    def _note_displaced(self, group: Group, part: Part) -> None:
        """Says why a part that deforms is shown as in the middle of the shutter's time."""
        if self._motions.deformation(group.owner, part) is not None:
            self._note_still(group.owner, "its surface is displaced")

    def _note_still(self, owner: Any, reason: str) -> None:
        subject = Subject("Object", name_of(owner))
        self._messages.warn(f"{subject}: {reason}; its deformation is not blurred", subject)

    def _is_displaced(self, group: Group) -> bool:
        """Whether a material of the group moves its points."""
        raise NotImplementedError

    def _export_shape(self, group: Group, wanted: frozenset[str], judged: dict[Any, curves.Judged]) -> int | None:
        if group.volume:
            return self._export_volume(group, wanted)
        if group.cloud is not None:
            return self._export_points(group, wanted)
        if group.hair is not None or group.owner.type == "CURVES":
            return self._export_strands(group, wanted)
        return self._export_surface(group, judged) if group.exact else self._export_mesh(group, wanted)

    def _export_volume(self, group: Group, reads: frozenset[str]) -> int | None:
        """The box around the grids that a volume's material reads."""
        name = name_of(group.owner)
        subject = Subject("Object", name)
        if not reads:
            self._leave_out(name, "its material reads no grid of a volume")
            return None
        try:
            grids = volumes.grids_of(self._core, group.owner, group.data, reads, self._blender_scene.frame_current)
            if not grids:
                self._leave_out(name, f"it has none of the grids that its material reads: {', '.join(sorted(reads))}")
                return None
            volumes.check_grids(grids, reads, lambda text: self._messages.warn(f"{subject}: {text}", subject))
            held = {self.scene.attribute(each): grid for each, grid in grids.items()}
            body = cycles_versions.volume_body(self._blender_scene)
            return int(self.scene.add_shape(self._core.volume(name, held, volumes.density_unit(group.data), body)))
        except self._core.InputError as error:
            self._leave_out(name, str(error))
            return None

    def _export_points(self, group: Group, wanted: frozenset[str]) -> int | None:
        name = name_of(group.owner)
        arrays = points.point_balls(group.data, wanted)
        if arrays is None:
            self._messages.note(f"Object '{name}' has no points; left out", Subject("Object", name))
            return None
        self._move_points(group, (POINTS, group.cloud or 0), arrays)
        self._drop_bad_points(name, arrays, "points have places")
        try:
            return points.add_points(self._core, self.scene, name, arrays)
        except self._core.InputError as error:
            self._leave_out(name, str(error))
            return None

    def _move_points(self, group: Group, part: Part, arrays: strand_arrays.StrandArrays) -> None:
        """Where strands, or balls, are at other times of the shutter."""
        deformation = self._deformation(group, part)
        if deformation is not None and deformation.points.shape[1] == len(arrays.points):
            arrays.moved_points = np.array(deformation.points, np.float64)

    def _drop_bad_points(self, name: str, arrays: strand_arrays.StrandArrays, what: str) -> None:
        dropped = strand_arrays.without_bad_points(arrays)
        if dropped:
            subject = Subject("Object", name)
            self._messages.warn(f"{subject}: {dropped} {what} that are not finite; left out", subject)

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
        self._move_points(group, (CURVES, 0) if group.hair is None else (HAIR, group.hair), arrays)
        self._drop_bad_points(name, arrays, "strands have points")
        try:
            settings = strands.curve_settings(self._blender_scene.rayleaf)
            return strands.add_strands(self._core, self.scene, name, arrays, settings, wanted)
        except self._core.InputError as error:
            self._leave_out(name, str(error))
            return None

    def _export_surface(self, group: Group, judged: dict[Any, curves.Judged]) -> int | None:
        name = name_of(group.owner)
        if group.owner.type == "SURFACE":
            moved = self._exact_points(group, (SPLINES, 0), len(surfaces.all_points(group.owner)))
            shape = surfaces.add_surface(self._core, self.scene, group.owner, self._messages, moved)
        else:
            self._deformation(group, (MESH, 0))  # one that could be followed is sent as a mesh
            settings = strands.curve_settings(self._blender_scene.rayleaf)
            # Once is enough: groups with the same key share the shape, and a million splines take memory.
            found = judged.pop(group.shape_key)
            shape = curves.add_curve(self._core, self.scene, name, found, self._messages, settings)
        if shape is None:
            self.report.left_out.setdefault(name, "no spline that can be rendered")
        return shape

    def _export_mesh(self, group: Group, wanted: frozenset[str]) -> int | None:
        if group.given is None or not group.from_owner or not group.given.is_editmode:
            return self._export_faces(group, wanted)
        # Of a mesh in Edit Mode no faces and no layers can be read, of its copy all.
        try:
            return self._export_faces(replace(group, given=group.owner.to_mesh()), wanted)
        finally:
            group.owner.to_mesh_clear()

    def _export_faces(self, group: Group, wanted: frozenset[str]) -> int | None:
        if group.from_owner and subdivision.last_subdivision(group.owner, self._depsgraph) is not None:
            shape = self._export_cage(group, wanted)
            if shape is not None:
                return shape
        if self._is_displaced(group):
            shape = self._export_polygons(group, wanted)
            if shape is not None:
                self._note_displaced(group, (MESH, 0))
                return shape
        name = name_of(group.owner)
        arrays = meshes.mesh_arrays(
            group.data, wanted, self._deformation(group, (MESH, 0)) if group.from_owner else None
        )
        if arrays is None:
            self.report.left_out[name] = "no faces"
            self._messages.note(f"Object '{name}' has no faces; left out", Subject("Object", name))
            return None
        try:
            return meshes.add_mesh(self.scene, name, arrays)
        except self._core.InputError as error:
            self._leave_out(name, str(error))
            return None

    def _export_cage(self, group: Group, wanted: frozenset[str]) -> int | None:
        """The shape of a mesh that is subdivided last; None, and a line in the report, if Blender's mesh must do."""
        owner, name = group.owner, name_of(group.owner)
        reason = subdivision.fallback_reason(owner, self._depsgraph, self._blender_scene.rayleaf, self._wrapped)
        if reason is None:
            try:
                arrays = subdivision.cage_arrays(owner, self._depsgraph, wanted)
                if arrays is None:
                    return None
                moved = self._exact_points(group, (CAGE, 0), len(arrays.vertices))
                shape = self._cages.add(name, arrays, moved)
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
            return None if arrays is None else self._cages.add(name, arrays)
        except self._core.InputError as error:
            self._messages.warn(f"{error}; its displacement is left out", Subject("Object", name))
            return None

    def _leave_out(self, name: str, reason: str) -> None:
        self.report.left_out[name] = reason
        text = reason if f"'{name}'" in reason else f"Object '{name}': {reason}"
        self._messages.warn(f"{text}; left out", Subject("Object", name))
