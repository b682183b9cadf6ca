"""Hair to plain arrays: the particle hair of meshes, and hair curves."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import chain
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..names import find, name_of
from .attributes import ACTIVE_COLOR, ACTIVE_UV, STRAND_INFO, STRAND_NORMAL, STRAND_RANDOM
from .attributes import active_color, active_uv, flat_values, for_shading
from .curve_bases import CURVE_TYPES, hair_as_bezier
from .random_numbers import random_of_index
from .strand_arrays import StrandArrays

Doubles = NDArray[np.float64]
Floats = NDArray[np.float32]

# Radius of hair curves without that attribute, as in Blender's own engine.
_DEFAULT_RADIUS = 0.005


_FACETS = ("TRIANGLES", "QUADS")


@dataclass(frozen=True)
class CurveSettings:
    """What hair and round bevelled curves are rendered as: the scene's Curves panel."""

    strand_shape: str  # of exact hair: ROUND or RIBBON
    primitive: str  # EXACT, or one of those to compare with
    detail: int  # balls a segment; rings a segment and sides of a tube

    @property
    def form(self) -> str:
        """The form of the core's Strands; tubes of facets are made from round ones."""
        if self.primitive == "EXACT":
            return self.strand_shape
        return "ROUND" if self.primitive in _FACETS else self.primitive

    def of_strands(self, core: ModuleType, strands: Any) -> Any:
        """The shape that is rendered for strands of this form."""
        if self.primitive not in _FACETS:
            return strands
        return core.strand_tubes(strands, self.detail, max(3, self.detail), self.primitive)

    def of_curve(self, core: ModuleType, curve: Any) -> Any | None:
        """What replaces a bevelled curve; None if nothing does: exact, or not a round tube of one thickness."""
        if self.primitive == "EXACT":
            return None
        strands = core.strands_along(curve, self.form, self.detail)
        return None if strands is None else self.of_strands(core, strands)


def curve_settings(own: Any) -> CurveSettings:
    """Those of `scene.rayleaf`."""
    return CurveSettings(own.strand_shape, own.curve_primitive, own.curve_detail)


def add_strands(
    core: ModuleType, scene: Any, name: str, arrays: StrandArrays, settings: CurveSettings, wanted: frozenset[str]
) -> int:
    """Send strands; the shape's index. Raises the core's InputError."""

    def by_id(attributes: dict[str, Floats]) -> dict[int, Floats]:
        return {scene.attribute(key): values for key, values in attributes.items()}

    if STRAND_RANDOM in wanted:
        arrays.attributes[STRAND_RANDOM] = random_of_index(arrays.count)[:, None]
    has_uv = ACTIVE_UV in arrays.attributes or ACTIVE_UV in arrays.point_attributes
    strands = core.Strands(
        name,
        arrays.points,
        arrays.radii,
        arrays.offsets,
        basis=arrays.basis,
        form=settings.form,
        cyclic=arrays.cyclic,
        material_slots=np.full(arrays.count, arrays.material_slot, np.int32),
        spheres_per_segment=settings.detail,
        uv=scene.attribute(ACTIVE_UV) if has_uv else -1,
        attributes=by_id(arrays.attributes),
        point_attributes=by_id(arrays.point_attributes),
        info={key: scene.attribute(value) for key, value in STRAND_INFO.items() if value in wanted},
        moved_points=arrays.moved_points,
        has_inside=False,
    )
    return int(scene.add_shape(settings.of_strands(core, strands)))


# --- Particle hair ---


def hair_systems(owner: Any) -> list[tuple[Any, Any]]:
    """(particle system, its modifier) of the particle hair that an evaluated object shows as strands."""
    modifiers = [item for item in owner.modifiers if item.type == "PARTICLE_SYSTEM" and item.show_render]
    return [
        (modifier.particle_system, modifier)
        for modifier in modifiers
        if modifier.particle_system.settings.type == "HAIR" and modifier.particle_system.settings.render_type == "PATH"
    ]


def _profile(settings: Any, shares: Doubles) -> Floats:
    """Radius along the strand, from 0 to 1 of its length: Blender's Hair Shape panel."""
    shape = settings.shape
    power = 1.0 + shape if shape < 0.0 else 1.0 / max(1.0 - shape, 1e-6)
    falling = (1.0 - shares) ** power
    root, tip = (0.5 * settings.radius_scale * value for value in (settings.root_radius, settings.tip_radius))
    radii = tip + (root - tip) * falling
    if settings.use_close_tip:
        radii[:, -1] = 0.0
    return np.ascontiguousarray(radii.ravel(), np.float32)


def _steps(settings: Any) -> int:
    """Points of a strand when rendered."""
    extra = settings.kink_extra_steps if settings.kink == "SPIRAL" else 0
    return (1 << settings.render_step) + 1 + extra


def _end_where_cut(points: Doubles) -> None:
    """Strands (n, steps, 3) that are shorter than others, as children may be cut, have fewer points: Blender gives the world's
    origin for those that are missing. They become the last one that is there."""
    missing = np.logical_and.accumulate((points == 0.0).all(axis=2)[:, ::-1], axis=1)[:, ::-1]
    if missing.any():
        steps = np.arange(points.shape[1])
        there = np.minimum(steps, np.maximum(steps[-1] - missing.sum(axis=1), 0)[:, None])
        points[:] = np.take_along_axis(points, there[:, :, None], axis=1)


def particle_strands(
    owner: Any, system: Any, modifier: Any, wanted: frozenset[str], check_cancel: Callable[[], None]
) -> StrandArrays | None:
    """The strands of a particle system of an evaluated object, children instead of parents where there are; None if it
    has none. Blender gives their points one by one: a second for half a million."""
    settings = system.settings
    parents, children = len(system.particles), len(system.child_particles)
    has_children = settings.child_type != "NONE" and children > 0
    first = parents if has_children and not settings.use_parent_particles else 0
    last = parents + (children if has_children else 0)
    steps = _steps(settings)
    if last == first:
        return None
    place = system.co_hair
    points = np.empty((last - first, steps, 3))
    for start in range(first, last, 4096):
        check_cancel()
        end = min(start + 4096, last)
        rows = [place(object=owner, particle_no=i, step=step) for i in range(start, end) for step in range(steps)]
        flat = np.fromiter(chain.from_iterable(rows), np.float64, 3 * len(rows))
        points[start - first : end - first] = flat.reshape(-1, steps, 3)
    _end_where_cut(points)
    to_object = np.array(owner.matrix_world.inverted_safe(), np.float64)
    points = (points.reshape(-1, 3) @ to_object[:3, :3].T + to_object[:3, 3]).reshape(points.shape)
    pieces = np.linalg.norm(np.diff(points, axis=1), axis=2)
    along = np.concatenate([np.zeros((len(points), 1)), np.cumsum(pieces, axis=1)], axis=1)
    whole = along[:, -1:]
    shares = np.divide(along, whole, out=np.zeros_like(along), where=whole > 0.0)
    arrays = StrandArrays(
        np.ascontiguousarray(points.reshape(-1, 3)),
        _profile(settings, shares),
        np.arange(0, (len(points) + 1) * steps, steps, dtype=np.int32),
        material_slot=max(settings.material - 1, 0),
    )
    for name in wanted:
        values = _emitter_values(owner.data, system, modifier, name, range(first, last))
        if values is not None:
            arrays.attributes[name] = values
    return arrays


def _emitter_values(mesh: Any, system: Any, modifier: Any, name: str, strands: range) -> Floats | None:
    """(strands, channels): a UV map or colour attribute of the surface at the roots; None if it has none of that name."""
    layer = active_uv(mesh) if name == ACTIVE_UV else find(mesh.uv_layers, name)
    particles = system.particles
    if layer is not None:
        read, place, channels = system.uv_on_emitter, "uv_no", 2
        number = list(mesh.uv_layers).index(layer)
    else:
        layer = active_color(mesh) if name == ACTIVE_COLOR else find(mesh.vertex_colors, name)
        colors = [name_of(item) for item in mesh.vertex_colors]
        if layer is None or name_of(layer) not in colors:
            return None
        read, place, channels = system.mcol_on_emitter, "vcol_no", 3
        number = colors.index(name_of(layer))
    parents = len(particles)
    anyone = particles[0]
    rows = [
        read(modifier=modifier, particle=particles[i] if i < parents else anyone, particle_no=i, **{place: number})
        for i in strands
    ]
    values = np.fromiter(chain.from_iterable(rows), np.float32, channels * len(rows))
    return values.reshape(-1, channels)


# --- Hair curves ---


def curves_strands(core: ModuleType, data: Any, wanted: frozenset[str]) -> StrandArrays | None:
    """The strands of a Curves data block; None if it has none."""
    count, points = len(data.curves), len(data.points)
    if count == 0 or points == 0:
        return None
    offsets = np.empty(count + 1, np.int32)
    firsts = np.empty(count, np.int32)
    data.curves.foreach_get("first_point_index", firsts)
    offsets[:-1], offsets[-1] = firsts, points
    positions = np.empty(points * 3, np.float32)
    data.points.foreach_get("position", positions)
    radii = flat_values(data.attributes, "radius", "POINT")
    arrays = StrandArrays(
        positions.reshape(-1, 3).astype(np.float64),
        np.full(points, _DEFAULT_RADIUS, np.float32) if radii is None else radii[:, 0],
        offsets,
    )
    cyclic = flat_values(data.attributes, "cyclic", "CURVE")
    if cyclic is not None and cyclic.any():
        arrays.cyclic = cyclic[:, 0].astype(np.uint8)
    for name in wanted:
        _take_attribute(arrays, data, name)
    types = flat_values(data.attributes, "curve_type", "CURVE")
    kinds = np.zeros(count, np.int32) if types is None else types[:, 0].astype(np.int32)
    if (kinds == CURVE_TYPES["POLY"]).all():
        arrays.basis = "LINEAR"
    elif (kinds != CURVE_TYPES["CATMULL_ROM"]).any():
        handles = tuple(flat_values(data.attributes, name, "POINT") for name in ("handle_left", "handle_right"))
        orders, modes = (flat_values(data.attributes, name, "CURVE") for name in ("nurbs_order", "knots_mode"))
        hair_as_bezier(core, arrays, kinds, handles, orders, modes)
    return arrays


def _take_attribute(arrays: StrandArrays, data: Any, name: str) -> None:
    """The first pair of numbers per curve stands for the UV map at the root, as in Blender's own engine."""
    if name == STRAND_NORMAL:
        normals = np.empty(len(data.points) * 3, np.float32)
        data.normals.foreach_get("vector", normals)
        arrays.point_attributes[name] = normals.reshape(-1, 3)
        return
    if name == ACTIVE_UV:
        pairs = [name_of(item) for item in data.attributes if item.data_type == "FLOAT2" and item.domain == "CURVE"]
        values = flat_values(data.attributes, pairs[0], "CURVE") if pairs else None
    else:
        values = for_shading(flat_values(data.attributes, name, "CURVE"))
    if values is not None:
        arrays.attributes[name] = values
        return
    values = for_shading(flat_values(data.attributes, name, "POINT"))
    if values is not None:
        arrays.point_attributes[name] = values
