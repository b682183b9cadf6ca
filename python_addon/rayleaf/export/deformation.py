"""Where the points of what deforms are while the shutter is open."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import versions
from . import points, strands, subdivision, surfaces
from .corner_normals import corner_normals
from .strand_arrays import StrandArrays

# Points that move along lines, up to this share of the size of all, need no steps between the first and the last.
_STRAIGHT = 1e-6

# What has faces only through the mesh that Blender evaluates beside it.
WITH_MESH_TWIN = {"CURVE", "SURFACE", "FONT", "META"}

# Which of an object's shapes: its mesh, the cage of its exact subdivision, its splines, its hair curves, or by number its
# particle hair or its point clouds.
Part = tuple[str, int]
MESH, CAGE, SPLINES, CURVES, HAIR, POINTS = "mesh", "cage", "splines", "curves", "hair", "points"


@dataclass
class Form:
    """The points of one shape at one time."""

    points: NDArray[Any]  # (n, 3), object space; of hair and balls (n, 4), with the radius, of splines with the weight
    normals: NDArray[np.float32] | None  # (corners, 3), of meshes
    topology: tuple[int, ...]  # equal where points of two times are the same ones


@dataclass
class Deformation:
    """The points of one shape at even times, the first and the last included."""

    points: NDArray[Any]  # (steps, n, 3 or 4), as a form's
    normals: NDArray[np.float32] | None  # (steps, corners, 3)


class Forms:
    """Takes the forms of objects that may deform, at the time that the scene is at."""

    def __init__(self, core: ModuleType, depsgraph: Any, check: Callable[[], None]) -> None:
        self._core, self._depsgraph, self._check = core, depsgraph, check
        self._known: dict[int, bool] = {}
        self._wrapped = subdivision.Wrapped(depsgraph)

    def may_deform(self, owner: Any, by_object: bool) -> bool:
        """By its settings and modifiers, as in Cycles: hair always may. `by_object`: whether its own settings count."""
        pointer = owner.original.as_pointer()
        if pointer not in self._known:
            self._known[pointer] = self.is_wanted(owner, by_object) and self._changes(owner)
        return self._known[pointer]

    def is_wanted(self, owner: Any, by_object: bool) -> bool:
        """Whether an object's settings ask for its deformation. `by_object`: whether they count."""
        return not by_object or bool(versions.cycles_setting(owner, "use_deform_motion", True))

    def _changes(self, owner: Any) -> bool:
        if owner.type == "CURVES" or (owner.type == "MESH" and strands.hair_systems(owner)):
            return True
        mode = "RENDER" if self._depsgraph.mode == "RENDER" else "PREVIEW"
        return bool(owner.is_deform_modified(self._depsgraph.scene, mode))

    def _cage(self, owner: Any) -> Form | None:
        """That of a mesh which is subdivided exactly."""
        if owner.type != "MESH" or subdivision.last_subdivision(owner, self._depsgraph) is None:
            return None
        settings = self._depsgraph.scene_eval.rayleaf
        if subdivision.fallback_reason(owner, self._depsgraph, settings, self._wrapped) is not None:
            return None
        arrays = subdivision.cage_arrays(owner, self._depsgraph, frozenset())
        if arrays is None:
            return None
        topology = (hash(arrays.face_sizes.tobytes()), hash(arrays.corners.tobytes()))
        return Form(arrays.vertices, None, topology)

    def of(self, owner: Any, mesh: Any) -> dict[Part, Form]:
        """Those of an evaluated object now; `mesh` is what it shows, where that is its own."""
        forms: dict[Part, Form] = {}
        if owner.type == "CURVES":
            _take(forms, (CURVES, 0), strands.curves_strands(self._core, owner.data, frozenset()))
            return forms
        if is_exact_surface(owner):
            forms[SPLINES, 0] = Form(surfaces.all_points(owner), None, surfaces.topology(owner))
            return forms
        if mesh is not None:
            forms[MESH, 0] = _mesh_form(mesh)
            cage = self._cage(owner)
            if cage is not None:
                forms[CAGE, 0] = cage
        for number, (system, modifier) in enumerate(strands.hair_systems(owner)):
            hair = strands.particle_strands(owner, system, modifier, frozenset(), self._check)
            _take(forms, (HAIR, number), hair)
        return forms


def of_points(cloud: Any) -> Form | None:
    """That of a point cloud; None if it has no points."""
    return _with_radii(points.point_balls(cloud, frozenset()))


def is_own_data(owner: Any, data: Any) -> bool:
    """True if the mesh is the owner's own, or made from it; geometry nodes may instance meshes of others."""
    return owner.type in WITH_MESH_TWIN or owner.data is None or owner.data.as_pointer() == data.as_pointer()


def is_exact_surface(owner: Any) -> bool:
    """Whether an object is rendered from the control points of surfaces."""
    return owner.type == "SURFACE" and surfaces.fallback_reason(owner) is None


def _mesh_form(mesh: Any) -> Form:
    vertices = np.empty(len(mesh.vertices) * 3, np.float32)
    mesh.vertices.foreach_get("co", vertices)
    corners = np.empty(len(mesh.loops), np.int32)
    mesh.loops.foreach_get("vertex_index", corners)
    topology = (len(mesh.polygons), len(corners), hash(corners.tobytes()))
    return Form(vertices.reshape(-1, 3), corner_normals(mesh), topology)


def _with_radii(arrays: StrandArrays | None) -> Form | None:
    if arrays is None:
        return None
    topology = (arrays.count, hash(arrays.offsets.tobytes()))
    return Form(np.column_stack([arrays.points, arrays.radii]), None, topology)


def _take(forms: dict[Part, Form], part: Part, arrays: StrandArrays | None) -> None:
    form = _with_radii(arrays)
    if form is not None:
        forms[part] = form


def deformation_of(forms: Iterable[Form | None]) -> Deformation | str | None:
    """Of forms at even times, None where there was none, an odd number; None where nothing changes. A text says why it
    cannot be known."""
    found = list(forms)
    middle = found[len(found) // 2]
    if middle is None:
        return None
    whole = [middle if form is None else form for form in found]
    if any(form.topology != middle.topology or form.points.shape != middle.points.shape for form in whole):
        return "its points are not the same ones at all times of the shutter"
    places = np.stack([form.points for form in whole])
    if not np.isfinite(places).all():
        return "some of its points are not finite at all times of the shutter"
    size = float(np.ptp(places.reshape(-1, places.shape[-1]), axis=0).max()) if places.size else 0.0
    apart = _STRAIGHT * size
    if np.abs(places - places[:1]).max(initial=0.0) <= apart:
        return None
    steps = [0, -1] if _is_straight(places, apart) else list(range(len(whole)))
    normals = [form.normals for form in (whole[step] for step in steps) if form.normals is not None]
    return Deformation(places[steps], np.stack(normals) if normals else None)


def _is_straight(values: NDArray[Any], apart: float) -> bool:
    """Whether the steps between the first and the last lie on the line between these."""
    shares = np.linspace(0.0, 1.0, len(values)).reshape(-1, *[1] * (values.ndim - 1))
    on_line = values[:1] + (values[-1:] - values[:1]) * shares
    return bool(np.abs(values - on_line).max(initial=0.0) <= apart)
