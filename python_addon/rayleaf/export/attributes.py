"""Named data over a mesh by triangle corner, and over hair: UV maps, colour attributes and generic ones."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import versions
from ..names import find
from . import mesh_derived

Floats = NDArray[np.float32]
Ints = NDArray[np.int32]

# Names no attribute can have in Blender: the UV map and the colour attribute that are active for rendering.
ACTIVE_UV = "\nactive uv"
ACTIVE_COLOR = "\nactive color"

# What strands tell of themselves, as attributes: the core's name -> ours.
STRAND_INFO = {name: "\nstrand " + name.lower() for name in ("IS_STRAND", "INTERCEPT", "LENGTH", "THICKNESS")}
STRAND_RANDOM = "\nstrand random"
STRAND_NORMAL = "\nstrand normal"  # across hair curves, object space: an axis of a cross section that is not round

# Blender's kinds of attribute: how their values are read (property, NumPy type, channels).
_KINDS: dict[str, tuple[str, Any, int]] = {
    "FLOAT": ("value", np.float32, 1),
    "INT": ("value", np.int32, 1),
    "INT8": ("value", np.int32, 1),
    "BOOLEAN": ("value", bool, 1),
    "FLOAT2": ("vector", np.float32, 2),
    "FLOAT_VECTOR": ("vector", np.float32, 3),
    "FLOAT_COLOR": ("color", np.float32, 4),
    "BYTE_COLOR": ("color", np.float32, 4),
}


def active_uv(mesh: Any) -> Any:
    """The UV map that is active for rendering; None without one."""
    return next((layer for layer in mesh.uv_layers if layer.active_render), None)


def active_color(mesh: Any) -> Any:
    """The colour attribute that is active for rendering; None without one."""
    index = mesh.color_attributes.render_color_index
    return mesh.color_attributes[index] if 0 <= index < len(mesh.color_attributes) else None


def _flat(attribute: Any) -> Floats | None:
    """(elements, channels); None for kinds that shading cannot use."""
    if attribute.data_type not in _KINDS:
        return None
    property_name, dtype, channels = _KINDS[attribute.data_type]
    values = np.empty(len(attribute.data) * channels, dtype)
    attribute.data.foreach_get(property_name, values)
    return values.reshape(-1, channels).astype(np.float32)


def flat_values(attributes: Any, name: str, domain: str) -> Floats | None:
    """(elements, channels) of the attribute of a name, if there is one on the domain."""
    attribute = find(attributes, name)
    return _flat(attribute) if attribute is not None and attribute.domain == domain else None


def integers(attributes: Any, name: str) -> Ints | None:
    """(elements,) of the attribute of a name, if it is of whole numbers."""
    attribute = find(attributes, name)
    if attribute is None or attribute.data_type != "INT":
        return None
    values = np.empty(len(attribute.data), np.int32)
    attribute.data.foreach_get("value", values)
    return values


def for_shading(values: Floats | None) -> Floats | None:
    """What shaders see of an attribute's values: a single number as a grey."""
    return np.repeat(values, 3, axis=1) if values is not None and values.shape[1] == 1 else values


@dataclass
class Corners:
    """Corners of faces, (m, k) each: what attributes may be stored on there."""

    vertices: Ints
    loops: Ints
    polygons: Ints


def _at_vertices(mesh: Any, values: Floats) -> Floats:
    """Of each vertex the mean of its edges, as Cycles takes values of edges."""
    ends = mesh_derived.edges(mesh).ravel()
    count = np.maximum(np.bincount(ends, minlength=len(mesh.vertices)), 1)
    channels = np.repeat(values, 2, axis=0).T
    sums = [np.bincount(ends, channel, minlength=len(mesh.vertices)) for channel in channels]
    return (np.stack(sums, -1) / count[:, None]).astype(np.float32)


def _generic(mesh: Any, attribute: Any, corners: Corners) -> Floats | None:
    """(m, k, channels) of an attribute, whatever it is stored on; None for kinds that shading cannot use."""
    values = for_shading(_flat(attribute))
    if attribute.domain == "EDGE" and values is not None:
        return np.ascontiguousarray(_at_vertices(mesh, values)[corners.vertices])
    where = {"POINT": corners.vertices, "CORNER": corners.loops, "FACE": corners.polygons}.get(attribute.domain)
    return None if where is None or values is None else np.ascontiguousarray(values[where])


def _derived(mesh: Any, name: str, corners: Corners) -> Floats | None:
    if name == mesh_derived.POINTINESS:
        return np.ascontiguousarray(mesh_derived.pointiness(mesh)[corners.vertices][..., None])
    if name == mesh_derived.ISLAND_RANDOM:
        return np.ascontiguousarray(mesh_derived.island_random(mesh)[corners.vertices][..., None])
    if name == mesh_derived.REST_PLACE:
        places = mesh_derived.rest_places(mesh)
        return None if places is None else np.ascontiguousarray(places[corners.vertices])
    if name.startswith(mesh_derived.TANGENT_OF):
        values = mesh_derived.tangents(mesh, name.removeprefix(mesh_derived.TANGENT_OF))
        return None if values is None else np.ascontiguousarray(values[corners.loops])
    return None


def attribute_values(mesh: Any, name: str, corners: Corners) -> Floats | None:
    """(m, k, channels): an attribute at corners, linear colours; None if the mesh has none of that name."""
    if name == ACTIVE_COLOR:
        color = active_color(mesh)
        return None if color is None else _generic(mesh, color, corners)
    if name.startswith("\n") and name != ACTIVE_UV:
        return _derived(mesh, name, corners)
    layer = active_uv(mesh) if name == ACTIVE_UV else find(mesh.uv_layers, name)
    if layer is not None:
        return np.ascontiguousarray(versions.uv_map(layer, len(mesh.loops))[corners.loops])
    attribute = find(mesh.attributes, name)
    return None if attribute is None else _generic(mesh, attribute, corners)
