"""Meshes as cages whose limit the core renders: those that a modifier subdivides last, and those that are displaced."""

from dataclasses import dataclass, field
from hashlib import blake2b
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import versions
from ..names import find, name_of
from .attributes import ACTIVE_UV, Corners, attribute_values
from .corner_normals import corner_normals
from .mesh_derived import REST_PLACE, rest_moves

Floats = NDArray[np.float32]
Ints = NDArray[np.int32]

# From Blender's creases, 0 to 1, to OpenSubdiv's sharpness (BKE_subdiv_crease_to_sharpness).
_FULL_SHARPNESS = 10.0
_ANY_LEVELS = 100  # more than any modifier's
# Evaluating the modifiers once more than Blender does would disturb what these keep from frame to frame.
_STATEFUL = {
    *("CLOTH", "COLLISION", "DYNAMIC_PAINT", "EXPLODE", "FLUID", "PARTICLE_INSTANCE", "PARTICLE_SYSTEM"),
    *("SOFT_BODY", "SURFACE"),
}


@dataclass
class CageArrays:
    """The arguments of the core's `SubdivisionSurface`, attributes still by name."""

    vertices: Floats  # (n, 3), object space
    face_sizes: Ints  # (m,)
    corners: Ints  # (sum of sizes,)
    options: dict[str, Any] = field(default_factory=dict)
    uv_maps: dict[str, Floats] = field(default_factory=dict)  # (corners, 2)
    attributes: dict[str, Floats] = field(default_factory=dict)  # (corners, channels)


def _switch(depsgraph: Any) -> str:
    """The property that says whether a modifier counts."""
    return "show_render" if depsgraph.mode == "RENDER" else "show_viewport"


def _in_use(mesh_object: Any, depsgraph: Any) -> list[Any]:
    return [modifier for modifier in mesh_object.modifiers if getattr(modifier, _switch(depsgraph))]


def _most_levels(depsgraph: Any) -> int:
    """To which Simplify limits every subdivision."""
    render = depsgraph.scene.render
    if not render.use_simplify:
        return _ANY_LEVELS
    is_final = depsgraph.mode == "RENDER"
    return int(render.simplify_subdivision_render if is_final else render.simplify_subdivision)


def last_subdivision(mesh_object: Any, depsgraph: Any) -> Any:
    """The Subdivision Surface modifier that ends an object's stack and does something, or None."""
    modifiers = _in_use(mesh_object, depsgraph) if mesh_object.type == "MESH" else []
    last = modifiers[-1] if modifiers else None
    if last is None or last.type != "SUBSURF":
        return None
    levels = last.render_levels if depsgraph.mode == "RENDER" else last.levels
    return last if min(levels, _most_levels(depsgraph)) > 0 else None


class Wrapped:
    """Objects onto which others are shrink-wrapped: onto their meshes, which chords leave inside of the limit where it
    bulges. On the limit, a label would sink in."""

    def __init__(self, depsgraph: Any) -> None:
        self._depsgraph = depsgraph
        self._by: dict[int, Any] | None = None  # by pointer: one that lies on it; None: nobody has asked

    def by(self, item: Any) -> Any | None:
        """An object that is shrink-wrapped onto this one, or None."""
        if self._by is None:
            self._by = {
                target.original.as_pointer(): other
                for other in self._depsgraph.objects
                for modifier in _in_use(other, self._depsgraph)
                if modifier.type == "SHRINKWRAP"
                for target in (modifier.target, modifier.auxiliary_target)
                if target is not None
            }
        return self._by.get(item.original.as_pointer())


def fallback_reason(mesh_object: Any, depsgraph: Any, settings: Any, wrapped: Wrapped) -> str | None:
    """Why an object that ends in a subdivision is taken as Blender's mesh; None if its cage can be sent."""
    last = last_subdivision(mesh_object, depsgraph)
    if not (settings.use_subdivision_surfaces and mesh_object.rayleaf.use_subdivision_surface):
        return "exact subdivision is switched off"
    if last.subdivision_type != "CATMULL_CLARK":
        return f"modifier {name_of(last)} is simple subdivision"
    if (other := wrapped.by(mesh_object)) is not None:
        return f"{name_of(other)} is shrink-wrapped onto it"
    stateful = next((modifier for modifier in _in_use(mesh_object, depsgraph) if modifier.type in _STATEFUL), None)
    return None if stateful is None else f"modifier {name_of(stateful)}"


def cage_arrays(mesh_object: Any, depsgraph: Any, wanted: frozenset[str]) -> CageArrays | None:
    """The cage of an evaluated object, with the attributes that are wanted and there; None without faces.

    The modifiers of the evaluated copy, not the user's, are switched for the time of one evaluation.
    """
    last, switch = last_subdivision(mesh_object, depsgraph), _switch(depsgraph)
    # Of a mesh that is evaluated here Blender does not know them. Subdivided, its vertices come first.
    moves = rest_moves(mesh_object.data) if REST_PLACE in wanted else None
    shown = [getattr(modifier, switch) for modifier in mesh_object.modifiers]
    without = [flag and modifier != last for flag, modifier in zip(shown, mesh_object.modifiers, strict=True)]
    # Unlike a property set by itself, these tell nobody that the object has changed.
    mesh_object.modifiers.foreach_set(switch, without)
    try:
        mesh = mesh_object.to_mesh(preserve_all_data_layers=True, depsgraph=depsgraph)
        try:
            arrays = _arrays_of(mesh, wanted - {REST_PLACE}, _options_of(mesh, last))
            if arrays is not None and moves is not None and len(moves) >= len(arrays.vertices):
                arrays.attributes[REST_PLACE] = _to_be_added(moves[arrays.corners])
            return arrays
        finally:
            mesh_object.to_mesh_clear()
    finally:
        mesh_object.modifiers.foreach_set(switch, shown)


def polygon_arrays(mesh: Any, wanted: frozenset[str]) -> CageArrays | None:
    """A mesh as a cage that is its own limit, with the normals that it is shaded with; None without faces."""
    options = {"scheme": "BILINEAR", "uv_smoothing": "NONE", "corner_normals": corner_normals(mesh)}
    return _arrays_of(mesh, wanted, options)


def _get(collection: Any, name: str, dtype: Any, width: int = 1) -> Any:
    values = np.empty(len(collection) * width, dtype)
    collection.foreach_get(name, values)
    return values


def _options_of(mesh: Any, modifier: Any) -> dict[str, Any]:
    """What a Subdivision Surface modifier says of the limit."""
    options = {
        "border_corners": "SHARP" if modifier.boundary_smooth == "PRESERVE_CORNERS" else "SMOOTH",
        "uv_smoothing": modifier.uv_smooth,
    }
    return options | _creases(mesh, modifier.use_creases)


def _arrays_of(mesh: Any, wanted: frozenset[str], options: dict[str, Any]) -> CageArrays | None:
    if len(mesh.polygons) == 0:
        return None
    sizes = _get(mesh.polygons, "loop_total", np.int32)
    corners = _get(mesh.loops, "vertex_index", np.int32)
    slots = _get(mesh.polygons, "material_index", np.int32)
    arrays = CageArrays(_get(mesh.vertices, "co", np.float32, 3).reshape(-1, 3), sizes, corners)
    arrays.options = options | {"material_slots": slots if slots.any() else None}
    faces = np.repeat(np.arange(len(sizes), dtype=np.int32), sizes)
    where = Corners(corners[:, None], np.arange(len(corners), dtype=np.int32)[:, None], faces[:, None])
    for name in wanted:
        values = attribute_values(mesh, name, where)
        if values is None:
            continue
        if name == REST_PLACE:  # a limit of custom normals is not where its cage is
            values = _to_be_added(values[:, 0] - arrays.vertices[corners])[:, None]
        is_uv = name == ACTIVE_UV or find(mesh.uv_layers, name) is not None
        (arrays.uv_maps if is_uv else arrays.attributes)[name] = np.ascontiguousarray(values[:, 0])
    return arrays


def _to_be_added(moves: Floats) -> Floats:
    """(corners, 4): the core's attribute, that says by its alpha that these are moves, no places."""
    return np.concatenate([moves, np.zeros((len(moves), 1), np.float32)], axis=1)


def _creases(mesh: Any, are_asked_for: bool) -> dict[str, Any]:
    """Creases of edges and of vertices. As in Blender a vertex of two edges is as sharp as the less sharp of them, beside its own
    crease, and one that an edge without faces ends at is as sharp as can be, even where no creases are asked for."""
    edges, vertices = versions.creases(mesh) if are_asked_for else (None, None)
    ends = _get(mesh.edges, "vertices", np.int32, 2).reshape(-1, 2)
    has_face = np.zeros(len(ends), bool)
    has_face[_get(mesh.loops, "edge_index", np.int32)] = True
    sharp = (
        np.zeros(len(mesh.vertices), np.float32) if vertices is None else vertices ** 2 * np.float32(_FULL_SHARPNESS)
    )
    result = {}
    if edges is not None and edges.any():
        chosen = np.flatnonzero(edges)
        sharpness = edges[chosen] ** 2 * np.float32(_FULL_SHARPNESS)
        result["crease_edges"], result["crease_sharpness"] = ends[chosen], sharpness
        sharp += _of_corners(len(sharp), ends[has_face], ends[chosen], sharpness)
    sharp[ends[~has_face]] = _FULL_SHARPNESS
    chosen = np.intersect1d(np.flatnonzero(sharp), ends[has_face])  # of vertices with faces
    if len(chosen) > 0:
        result["crease_vertices"] = chosen.astype(np.int32)
        result["vertex_sharpness"] = np.minimum(sharp[chosen], np.float32(_FULL_SHARPNESS))
    return result


def _of_corners(vertices: int, ends: Ints, creased: Ints, sharpness: Floats) -> Floats:
    """What the creases of edges make of vertices that two edges of faces end at: the lesser sharpness of the two."""
    count = np.bincount(ends.ravel(), minlength=vertices)
    of_creases = np.bincount(creased.ravel(), minlength=vertices)
    least = np.full(vertices, np.inf, np.float32)
    np.minimum.at(least, creased, sharpness[:, None])
    return np.where((count == 2) & (of_creases == 2), least, np.float32(0.0))


class Cages:
    """Sends the cages of one export. Equal ones are one shape: copies that the artist did not link, or that have a
    modifier each."""

    def __init__(self, core: ModuleType, scene: Any) -> None:
        self._core, self._scene = core, scene
        self._known: dict[bytes, int] = {}  # the shape of each content

    def add(self, name: str, arrays: CageArrays, moved: Floats | None = None) -> int:
        """The shape's index. Raises the core's InputError. `moved`: the vertices at the shutter's steps."""
        content = _digest([vars(arrays), moved])
        if content not in self._known:
            self._known[content] = int(self._scene.add_shape(self._shape(name, arrays, moved)))
        return self._known[content]

    def _shape(self, name: str, arrays: CageArrays, moved: Floats | None) -> Any:
        scene = self._scene
        return self._core.SubdivisionSurface(
            name,
            arrays.vertices,
            arrays.face_sizes,
            arrays.corners,
            **arrays.options,
            uv_maps={scene.attribute(key): values for key, values in arrays.uv_maps.items()},
            uv=scene.attribute(ACTIVE_UV) if ACTIVE_UV in arrays.uv_maps else -1,
            attributes={scene.attribute(key): values for key, values in arrays.attributes.items()},
            moved_vertices=moved,
        )


def _digest(content: Any) -> bytes:
    """Of arrays, dictionaries and lists of them, and plain values."""
    digest = blake2b(digest_size=16)

    def add(value: Any) -> None:
        if isinstance(value, np.ndarray):
            digest.update(f"{value.dtype} {value.shape}".encode())
            digest.update(np.ascontiguousarray(value).data)
        elif isinstance(value, dict):
            add([part for item in value.items() for part in item])
        elif isinstance(value, list):
            digest.update(f"list {len(value)}".encode())
            for part in value:
                add(part)
        else:
            digest.update(f"{value!r};".encode())

    add(content)
    return digest.digest()
