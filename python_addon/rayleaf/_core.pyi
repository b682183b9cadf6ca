"""Rayleaf's core: splines and meshes in, pixels out. Usable from plain Python.

Arrays are NumPy arrays; the shapes and types given here are checked and a wrong one raises InputError or TypeError that
names the argument. Matrices are 4x4, float64, Blender's convention (columns are the images of the axes). Lengths are in
world or object units, angles in radians, colours linear Rec. 709.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float32]
Doubles = NDArray[np.float64]
Ints = NDArray[np.int32]

# The version of Rayleaf, and the versions of the parts that the module was built with, by name.
__version__: str
built_with: dict[str, str]

# Programs, closures and textures on arrays, for tests alone: a submodule.
shading: Any

class InputError(ValueError):
    """Input that cannot be rendered; the message names the object, the argument, what came and what was wanted."""

class Program:
    """A flat shader program. The operations are those of core/shading/operations.def."""

    def __init__(self, name: str, bump_shadow: str = "CUBIC", clearing: str = "ALL") -> None:
        """bump_shadow: how the smooth surface's own shadow darkens bumps of diffuse closures: NONE, CUBIC (Chiang et al.
        2019, Cycles up to 4.4) or FACETS (Conty Estevez et al. 2019, Cycles since 4.5).
        clearing: whose normals are turned until what they mirror clears the facet: those of ALL lobes and of bumps (Cycles up
        to 3.5), of MIRRORS, which are all lobes but matte ones (since 3.6), or of NONE."""
    def constant(self, x: float, y: float, z: float, w: float) -> int:
        """A register that holds four finite numbers."""
    def operation(
        self,
        identifier: str,
        operands: Sequence[int] = (),
        ints: Sequence[int] = (),
        floats: Sequence[float] | Floats = (),
        text: str = "",
    ) -> int:
        """Appends an operation; the register of its result, -1 for closures."""
    name: str
    bump_width: float
    """The distance over which bumps compare heights, in pixels; positive."""
    emits: bool
    may_be_transparent: bool
    is_constant: bool
    even_emission: tuple[float, float, float] | None
    """What it emits at all points and in all directions; None where that depends on them."""

class NurbsSpline:
    """One spline of a Blender SURFACE object. `points` is (count_v, count_u, 4): x, y, z, weight, object space."""

    def __init__(
        self,
        points: Doubles,
        order_u: int,
        order_v: int,
        cyclic_u: bool = False,
        cyclic_v: bool = False,
        endpoint_u: bool = False,
        endpoint_v: bool = False,
        bezier_u: bool = False,
        bezier_v: bool = False,
        material_slot: int = 0,
        smooth: bool = True,
    ) -> None: ...
    @property
    def material_slot(self) -> int: ...
    @property
    def smooth(self) -> bool: ...
    def problem(self) -> tuple[str, str, str, str] | None:
        """Why there is no surface: BAD_DATA or DRAWS_NOTHING, the argument, what it is, what was wanted."""
    def to_bezier(self) -> BezierNet: ...

class BezierCurve:
    """A rational Bezier curve of any degree. `points` is given as (degree + 1, 4): x, y, z, weight > 0."""

    def __init__(self, points: Doubles) -> None: ...
    @property
    def degree(self) -> int: ...
    @property
    def rational(self) -> bool: ...
    @property
    def points(self) -> Doubles:
        """(degree + 1, 4), homogeneous: wx, wy, wz, w."""
    def evaluate(self, t: Doubles) -> Doubles:
        """(n, 3, 3): position, first and second derivative for each parameter."""
    def de_casteljau(self, t: Doubles) -> Doubles:
        """(n, 3): positions by repeated interpolation of the control points instead of the Bernstein form."""
    def split(self, t: float) -> tuple[BezierCurve, BezierCurve]: ...
    def restricted(self, begin: float, end: float) -> BezierCurve: ...
    def elevated(self) -> BezierCurve: ...
    def bounds(self) -> Doubles:
        """(2, 3): a box that contains the curve."""

class BezierPatch:
    """A rational Bezier patch. `points` is given as (degree_v + 1, degree_u + 1, 4): x, y, z, weight > 0."""

    def __init__(self, points: Doubles) -> None: ...
    @property
    def degree_u(self) -> int: ...
    @property
    def degree_v(self) -> int: ...
    @property
    def rational(self) -> bool: ...
    @property
    def points(self) -> Doubles:
        """(degree_v + 1, degree_u + 1, 4), homogeneous: wx, wy, wz, w."""
    def evaluate(self, u: Doubles, v: Doubles) -> Doubles:
        """(n, 6, 3): P, P_u, P_v, P_uu, P_uv, P_vv for each pair of parameters."""
    def normals(
        self,
        u: Doubles,
        v: Doubles,
        neighbour: Sequence[float] | None = None,
        geometric: Sequence[float] = (0, 0, 1),
    ) -> tuple[Doubles, list[str]]:
        """(n, 3, 3): unit normal and its derivatives by u and v; and which stage gave each: REGULAR, SECOND_ORDER, INSET,
        NEIGHBOUR, GEOMETRIC (see core/splines/limit_normal.h)."""
    def split(self, direction: str, t: float) -> tuple[BezierPatch, BezierPatch]:
        """direction: U or V."""
    def restricted(self, u_begin: float, u_end: float, v_begin: float, v_end: float) -> BezierPatch: ...
    def elevated(self, direction: str) -> BezierPatch: ...
    def bounds(self) -> Doubles:
        """(2, 3): a box that contains the patch."""
    def float_bounds(self) -> Floats:
        """(2, 3): the same in floats; contains the points rounded to float too."""
    def facet_distance_bound(self, cells_u: int, cells_v: int) -> float:
        """No point is further than this from the facets of a uniform grid of that many cells, and the other way round."""
    def closest_point(self, target: Sequence[float]) -> tuple[float, float, float]:
        """u, v and distance."""

class BezierChain:
    """A curve as Bezier segments."""

    @property
    def rational(self) -> bool: ...
    @property
    def closed(self) -> bool: ...
    @property
    def ranges(self) -> Doubles:
        """(segments, 2): the part of [0, 1] that each takes, proportional to the knots."""
    @property
    def continuity(self) -> list[int]:
        """k after each segment, where the knots make the next one join C^k; -1 where none follows."""
    @property
    def points(self) -> Doubles:
        """(n, 4), homogeneous; neighbours share a point."""
    def positions(self, t: Doubles) -> Doubles:
        """(n, 3): points at parameters in [0, 1] of the whole curve."""
    def segment(self, index: int) -> BezierCurve: ...

class BezierNet:
    """A surface as Bezier patches."""

    @property
    def rational(self) -> bool: ...
    @property
    def closed_u(self) -> bool: ...
    @property
    def closed_v(self) -> bool: ...
    @property
    def ranges_u(self) -> Doubles:
        """(spans, 2): the part of [0, 1] that each span takes, proportional to the knots."""
    @property
    def ranges_v(self) -> Doubles: ...
    @property
    def continuity_u(self) -> list[int]:
        """k after each span, where the knots make the next one join C^k; -1 where none follows."""
    @property
    def continuity_v(self) -> list[int]: ...
    @property
    def points(self) -> Doubles:
        """(rows, columns, 4), homogeneous; neighbours share a row or column."""
    def positions(self, u: Doubles, v: Doubles) -> Doubles:
        """(n, 3): points at parameters in [0, 1] of the whole surface."""
    def patch(self, span_u: int, span_v: int) -> BezierPatch: ...

class NurbsCurve:
    """One NURBS spline of a Blender CURVE object. `points` is (count, 4): x, y, z, weight, object space."""

    def __init__(
        self, points: Doubles, order: int, cyclic: bool = False, endpoint: bool = False, bezier: bool = False
    ) -> None: ...
    def problem(self) -> tuple[str, str, str, str] | None:
        """Why there is no curve: BAD_DATA or DRAWS_CONTROL_POLYGON, the argument, what it is, what was wanted."""
    def to_bezier(self) -> BezierChain: ...

class BezierSpline:
    """One Bezier spline of a Blender CURVE object. `knots` is (count, 3, 3): left handle, point, right handle."""

    def __init__(self, knots: Doubles, cyclic: bool = False) -> None: ...
    def problem(self) -> tuple[str, str, str, str] | None: ...
    def to_bezier(self) -> BezierChain: ...

def implied_knots(
    count: int, order: int, cyclic: bool = False, endpoint: bool = False, bezier: bool = False
) -> Doubles:
    """The knots that Blender implies for a direction of a NURBS spline."""

class CurveSplines:
    """Splines of equal settings, one after the other: `counts` control points each (core/splines/curve_splines.h).

    type: BEZIER, NURBS or POLY; points (n, 4): x, y, z, weight; handles (n, 2, 3), Bezier only: left, right; radii,
    tilts, straight (n,); radius_interpolation, tilt_interpolation: LINEAR, CARDINAL, BSPLINE or EASE.
    """

    def __init__(
        self,
        type: str,
        counts: Ints,
        points: Doubles,
        handles: Doubles | None = None,
        radii: Doubles | None = None,
        tilts: Doubles | None = None,
        straight: NDArray[np.bool_] | None = None,
        order: int = 4,
        cyclic: bool = False,
        endpoint: bool = False,
        bezier: bool = False,
        radius_interpolation: str = "LINEAR",
        tilt_interpolation: str = "LINEAR",
        resolution: int = 12,
        material_slot: int = 0,
        smooth: bool = True,
        fill_group: int = 0,
        ends_at_seam: bool = False,
    ) -> None: ...
    def __len__(self) -> int: ...

class SweptCurve:
    """A bevelled curve; what each value means, and its names, stand in core/geometry/swept_curve.h.

    dimensions: 2D or 3D; twist: Z_UP, MINIMUM or TANGENT; closed_twist: SPREAD or JUMP; fill: FULL, BACK,
    FRONT or HALF; taper_radius: OVERRIDE, MULTIPLY or ADD; the mappings: RESOLUTION, SEGMENTS or SPLINE.
    """

    name: str
    def __init__(
        self,
        name: str,
        splines: Sequence[CurveSplines],
        *,
        dimensions: str = "3D",
        twist: str = "MINIMUM",
        closed_twist: str = "SPREAD",
        bevel_depth: float = 0.0,
        extrude: float = 0.0,
        offset: float = 0.0,
        fill: str = "FULL",
        bevel_resolution: int = 4,
        profile: Sequence[CurveSplines] | None = None,
        taper: CurveSplines | None = None,
        taper_radius: str = "OVERRIDE",
        taper_fits_bevel: bool = False,
        bevel_start: float = 0.0,
        bevel_end: float = 1.0,
        start_mapping: str = "RESOLUTION",
        end_mapping: str = "RESOLUTION",
        fill_caps: bool = False,
        fill_materials: Sequence[int] = (),
    ) -> None: ...
    def begin(self) -> None:
        """Have another thread make its surface, which a scene that it is added to then need not."""
    def borders_cross(self) -> bool:
        """Whether borders of filled areas cross each other or themselves."""

class RayInterpolation:
    """How rays against an object are interpolated. `error` sets the thresholds together; those given replace them."""

    def __init__(
        self,
        mode: str = "OFF",
        error: float = 0.005,
        distance_threshold: float | None = None,
        angle_threshold: float | None = None,
        depth_limit: int | None = None,
        cache_bytes: int | None = None,
        rays_per_cell: float | None = None,
    ) -> None:
        """mode: OFF, AUTO, ON. error: a share of the object's half extent. Angles in radians, bytes an object. Rays per cell:
        so many of a frame's rays must cross a cell of rays for it to be sampled."""
    @property
    def mode(self) -> str: ...
    @property
    def distance_threshold(self) -> float: ...
    @property
    def angle_threshold(self) -> float: ...
    @property
    def depth_limit(self) -> int: ...
    @property
    def cache_bytes(self) -> int: ...
    @property
    def rays_per_cell(self) -> float: ...

class VolumeVisualisation:
    """A material that shows the length of rays inside an object; such objects should not intersect others."""

    def __init__(self, kind: str = "EMISSION", density: float = 1.0, color: Sequence[float] = (1, 1, 1)) -> None:
        """kind: EMISSION adds color * density * length, ABSORPTION multiplies by color ** (density * length)."""

class RayCacheStore:
    """Ray caches that the caller keeps between renders, as one scene sees them. From frame to frame they interpolate more."""

    def __init__(self) -> None: ...
    def of_scene(self, name: str) -> RayCacheStore:
        """The same caches for the scene of that name, which has its own frames."""
    def next_frame(self) -> None:
        """Drops what no render of this scene asked for since the last call, and no other scene holds; what rays crossed
        until now counts from here on."""
    def count(self) -> int: ...
    def bytes(self) -> int: ...

class Strands:
    """Hair and other thin curves. Strand i has the points offsets[i] to offsets[i + 1]; see core/geometry/strands.h.

    points (n, 3), radii (n,), offsets (strands + 1,), cyclic and material_slots (strands,). basis: LINEAR, CATMULL_ROM,
    BSPLINE, BEZIER (3 points a segment and 1 more). form: ROUND, RIBBON, SPHERES, EMBREE_ROUND. attributes: id ->
    (strands, channels); point_attributes: id -> (n, channels); `uv` is the id of the active UV map. info: IS_STRAND,
    INTERCEPT, LENGTH, THICKNESS -> id of the attribute by which shading reads it. moved_points (steps, n, 4): points and
    radii at even times of the shutter, of strands that deform. has_inside: whether rays that start in a strand meet it where they
    leave; hair has none.
    """

    def __init__(
        self,
        name: str,
        points: Doubles,
        radii: Floats,
        offsets: Ints,
        basis: str = "CATMULL_ROM",
        form: str = "ROUND",
        cyclic: Any = None,
        material_slots: Ints | None = None,
        spheres_per_segment: int = 16,
        uv: int = -1,
        attributes: dict[int, Floats] = {},
        point_attributes: dict[int, Floats] = {},
        info: dict[str, int] = {},
        moved_points: Doubles | None = None,
        has_inside: bool = True,
    ) -> None: ...

def strand_tubes(strands: Strands, rings: int, sides: int, facets: str = "TRIANGLES") -> Any:
    """A tube of TRIANGLES or QUADS along every strand: rings a segment, sides a ring."""

def strands_along(curve: SweptCurve, form: str = "ROUND", spheres_per_segment: int = 16) -> Strands | None:
    """The strands along a bevelled curve's axes; None unless its profile is one full circle."""

class VoxelGrid:
    """Numbers, vectors or colours at the points of a lattice, sparse; see core/geometry/voxel_grid.h.

    values (z, y, x, channels): 1 channel, 3 of a vector, or 4 of a colour that its alpha has multiplied. to_object (4, 4): from
    whole coordinates, 0 for the first, to object space. A voxel counts as there if its largest number is not below `least`, nor 0.
    mixing: TRILINEAR, or STOCHASTIC, one of the eight values about a place, chosen by its bits, with that mean.
    """

    bad_numbers: int  # that were not finite, and are 0
    bytes: int

    def __init__(
        self,
        object: str,
        name: str,
        values: Floats,
        to_object: Doubles,
        least: float = 0.0,
        mixing: str = "TRILINEAR",
    ) -> None: ...
    def values(self, points: Doubles) -> Floats:
        """(n, 4) at points of object space (n, 3), interpolated."""
    def bounds(self) -> tuple[list[float], list[float]]:
        """Of the blocks of 8³ voxels where something is, in object space."""

def densities_along(densities: Floats, begin: Doubles, step: Doubles) -> Floats | None:
    """What tracking takes a medium to be in a cell of its bounds, by its extinction at 4³ points (64,), x fastest: (8, 4) for
    pieces of a ray that begins at `begin` (3,) and goes on by `step` (3,), in steps between points from the cell's corner: mean,
    majorant, certain part and residual. None where that says little more than the bounds of the whole cell. Within half of what
    one of 255 equal shares of the range is from the trilinear value in the middle of each piece."""

def read_vdb(
    object: str,
    path: str,
    names: Sequence[str],
    value_place: str = "MIDDLE",
    mixing: str = "TRILINEAR",
    least: float = 0.0,
) -> dict[str, VoxelGrid]:
    """Those grids of an OpenVDB file that it has; `object` is named in messages. value_place: where in its voxel a value
    stands, MIDDLE or CORNER. mixing: as of VoxelGrid. Active voxels whose largest number is below `least` count as inactive.
    """

def volume(name: str, grids: dict[int, VoxelGrid], density_unit: str = "WORLD", body: str = "BLOCKS") -> Any:
    """The shape of a volume: a box around what grids hold, which a program reads by their ids. density_unit: WORLD, or
    OBJECT, by which densities are per unit of object space. body: what it fills, BLOCKS of 8³ voxels about active ones,
    a BOX around all of these and a voxel, or a NARROW_BOX, without that voxel behind the last."""

class SubdivisionSurface:
    """The limit of a polygon mesh; see core/geometry/subdivision_cage.h. A corner is a vertex of a face.

    vertices (n, 3), face_sizes (m,), corners (sum of sizes,): vertex indices, counter-clockwise. Sharpness: 0 is smooth,
    10 and more sharp for ever; crease_edges (k, 2). border_corners: SMOOTH, SHARP. uv_smoothing: NONE, PRESERVE_CORNERS,
    PRESERVE_CORNERS_AND_JUNCTIONS, PRESERVE_CORNERS_JUNCTIONS_AND_CONCAVE, PRESERVE_BOUNDARIES, SMOOTH_ALL. uv_maps: id
    -> (corners, 2), smoothed; `uv` is the id of the active one; attributes: id -> (corners, channels), linear.
    corner_normals (corners, 3) count as the normals. scheme: CATMULL_CLARK, BILINEAR (the mesh as it is). moved_vertices
    (steps, n, 3): at even times of the shutter, of a surface that deforms.
    """

    def __init__(
        self,
        name: str,
        vertices: Floats,
        face_sizes: Ints,
        corners: Ints,
        crease_edges: Ints | None = None,
        crease_sharpness: Floats | None = None,
        crease_vertices: Ints | None = None,
        vertex_sharpness: Floats | None = None,
        material_slots: Ints | None = None,
        border_corners: str = "SMOOTH",
        uv_smoothing: str = "PRESERVE_BOUNDARIES",
        uv_maps: dict[int, Floats] = {},
        uv: int = -1,
        attributes: dict[int, Floats] = {},
        corner_normals: Floats | None = None,
        scheme: str = "CATMULL_CLARK",
        moved_vertices: Floats | None = None,
    ) -> None: ...
    def points(self, elements: Ints, parameters: Doubles) -> Doubles:
        """Position and derivatives by u, v, uu, uv, vv, (n, 6, 3) in local space, at parameters (n, 2) of elements."""
    def values(self, attribute: int, elements: Ints, parameters: Doubles) -> Floats:
        """(n, 4) of an attribute."""

def vertex_normals(vertices: Floats, face_sizes: Ints, corners: Ints) -> Floats:
    """(n, 3): unit normals of a polygon mesh's vertices (n, 3), as Blender has them: means of the faces around by the angles of
    their corners. face_sizes (m,): corners of each face; corners: their vertices, face after face. The same bits for any number
    of threads."""

def displaced(shape: Any, program: Program, object: int = -1, world: int = -1) -> Any:
    """A spline or subdivision surface whose points are moved by the vectors in a program's registers (-1: none)."""

class SceneParts:
    """What renders of like scenes share: shapes built for tracing, converted textures, the world's table."""

    def __init__(self) -> None: ...

class Panorama:
    """What a panoramic camera shows; angles in radians, lengths in millimetres."""

    def __init__(
        self,
        kind: str,
        longitudes: tuple[float, float] = ...,
        latitudes: tuple[float, float] = ...,
        field_of_view: float = 3.141592653589793,
        lens: float = 10.5,
        sensor: tuple[float, float] = ...,
        eye_offset: float = 0.0,
        convergence: float | None = None,
        pole_merge: tuple[float, float] | None = None,
    ) -> None:
        """kind: EQUIRECTANGULAR, FISHEYE_EQUIDISTANT, FISHEYE_EQUISOLID or MIRRORBALL. The lens and the sensor (width and
        height) are the equisolid fisheye's.

        Of spherical stereo, world units: eye_offset, to the right of where the eye looks; convergence, how far away both
        eyes look at the same place, None: nowhere; pole_merge: from which angle to which above and below the horizon
        they become one."""

class SceneDescription:
    """A scene. Each `add_…` returns an index for later calls, or raises and leaves the scene as it was."""

    def __init__(self, parts: SceneParts | None = None) -> None: ...
    def attribute(self, name: str) -> int:
        """The id of an attribute name (UV map, colour attribute), for operations and shapes."""
    def add_mesh(
        self,
        name: str,
        vertices: Floats,
        triangles: Ints,
        corner_normals: Floats | None = None,
        material_slots: Ints | None = None,
        uv: int = -1,
        attributes: dict[int, Floats] | None = None,
        moved_vertices: Floats | None = None,
        moved_normals: Floats | None = None,
    ) -> int:
        """vertices (n, 3), triangles (m, 3), corner_normals (m, 3, 3) or None for flat, material_slots (m,).

        attributes: id -> (m, 3, channels), channels 1..4; `uv` is the id of the active UV map, -1 if there is none.
        moved_vertices (steps, n, 3), moved_normals (steps, m, 3, 3): of a mesh that deforms, at even times of the shutter.
        """
    def add_shape(self, shape: Any) -> int: ...
    def add_surface(
        self, name: str, splines: Sequence[NurbsSpline], moved_splines: Sequence[Sequence[NurbsSpline]] = []
    ) -> int:
        """moved_splines: those at even times of the shutter, of a surface that deforms."""
    def add_curve(self, curve: SweptCurve) -> int: ...
    def add_material(
        self,
        name: str,
        surface: Program | None,
        pass_index: int = 0,
        volume: VolumeVisualisation | None = None,
        displacement: tuple[Program, int, int] | None = None,
        medium: Program | None = None,
        transparent_shadow: bool = True,
    ) -> int:
        """`volume` replaces the surface: the object shows the length of rays inside it.

        `medium` is the program of a volume that fills the space behind the surface; without `surface` there is none.

        `displacement` moves the points of spline and subdivision surfaces: a program, and the registers that hold the
        vector in object space and the one in world space, -1 for none.

        Without `transparent_shadow` its shadow is that of an opaque surface.
        """
    def copy(self) -> SceneDescription:
        """Another of the same, to be changed by what follows: the two share what is not."""
    def emptied(self) -> SceneDescription:
        """One with nothing in it, where attributes and textures keep their ids."""
    def shows_same_as(self, other: SceneDescription) -> bool:
        """Whether both are known to look alike, cameras aside: the same shapes, equal values of all else."""
    def shape(self, index: int) -> Any:
        """What `add_…` made, to be given to other scenes."""
    def set_texture_space(self, shape: int, low: Sequence[float], high: Sequence[float]) -> None:
        """Corners in object space between which Generated coordinates run from 0 to 1; else the shape's bounds. Before
        anything is rendered."""
    def replace_shape(self, index: int, shape: Any) -> None: ...
    def replace_material(
        self,
        index: int,
        name: str,
        surface: Program | None,
        pass_index: int = 0,
        volume: VolumeVisualisation | None = None,
        displacement: tuple[Program, int, int] | None = None,
        medium: Program | None = None,
        transparent_shadow: bool = True,
    ) -> None:
        """As `add_material`."""
    def place_instances(self, indices: Ints, matrices: Doubles) -> None:
        """Move instances: indices (n,), matrices (n, 4, 4). Raises, and moves none, if one cannot be."""
    def clear_lamps(self) -> None: ...
    def add_material_list(self, materials: Sequence[int]) -> int:
        """Materials by slot; -1 in a slot is the neutral material."""
    def add_instance(
        self,
        name: str,
        shape: int,
        matrix: Doubles,
        material_list: int = -1,
        object_index: int = 0,
        random: float = 0.0,
        visibility: int = 63,
        ray_interpolation: int = -1,
        light_group: int = -1,
        asset: str = "",
        motion: Doubles | None = None,
        shadow_terminator: float = 0.1,
        linking: Sequence[int] | None = None,
    ) -> int:
        """visibility: sum of 1 camera, 2 diffuse, 4 glossy, 8 transmission, 16 shadow, 32 volume. light_group: the slot of
        the light that it emits (-1: none). asset: to which it belongs for Cryptomatte; itself if empty. motion: matrices
        (n, 4, 4) at even times while the shutter is open. shadow_terminator: sine of the angle between light and surface
        below which shadow rays start above facets that are shaded smooth (Cycles' Geometry Offset), 0 to 1. linking: what
        it has to do with lights that are linked: the sets of receivers and of blockers that it is in, a bit for each (63 and
        24); and, if it emits, the numbers of the sets on which it shines, and which cast shadows in its light (-1: all).
        """
    def add_ray_interpolation(self, object: str, interpolation: RayInterpolation) -> int:
        """An index for add_instance, for objects that have settings of their own."""
    def add_instances(
        self,
        names: Sequence[str],
        shapes: Ints,
        matrices: Doubles,
        material_lists: Ints,
        object_indices: Ints,
        randoms: Floats,
        visibilities: Ints,
        ray_interpolations: Ints | None = None,
        attributes: Mapping[int, Floats] | None = None,
        light_groups: Ints | None = None,
        assets: Sequence[str] | None = None,
        motions: Mapping[int, Doubles] | None = None,
        shadow_terminators: Floats | None = None,
        linkings: Ints | None = None,
    ) -> list[str]:
        """Many at once; matrices (n, 4, 4), attributes of whole instances by id (n, 4), slots of light groups (-1: none),
        motions of some (by place in the list), linkings (n, 4).
        Instances that cannot be rendered are left out, one message for each."""
    def add_lamp(
        self,
        name: str,
        kind: str,
        matrix: Doubles,
        strength: Sequence[float],
        radius: float = 0.0,
        soft_falloff: bool = False,
        angle: float = 0.0,
        spot_size: float = 0.0,
        spot_blend: float = 0.0,
        spot_profile: str = "COSINE",
        size_x: float = 1.0,
        size_y: float = 1.0,
        spread: float = 3.141592653589793,
        casts_shadow: bool = True,
        visibility: int = 63,
        emission: Program | None = None,
        light_group: int = -1,
        link: tuple[int, int] = (-1, -1),
    ) -> int:
        """`emission` is a factor on the strength, by place and direction. `link`: the set of receivers on which it shines,
        and the set of blockers that cast shadows in its light; -1: all.

        kind: POINT, SUN, SPOT, RECTANGLE, DISK. strength: colour times watts (SUN: W/m²). spot_profile: COSINE, EVEN.
        soft_falloff: a disk that faces whoever looks takes the place of the sphere of a POINT or a SPOT.
        """
    def set_world(
        self,
        world: Program | None,
        sampling_resolution: int = 1024,
        medium: Program | None = None,
        light_group: int = -1,
        visibility: int = 63,
        lit_by: int = 0x7FFFFFFFFFFFFFFF,
    ) -> None:
        """lit_by: the sets of lights that shine on its medium. visibility: of which rays it lights, as add_instance's; 16,
        shadow, has no meaning here."""
    def matte_attributes(self, kind: str, layer: str) -> dict[str, str]:
        """What headers of files say of Cryptomatte's passes of a kind (OBJECT, MATERIAL, ASSET): the names behind the ids.
        layer: the passes' name without their numbers."""
    def set_camera(
        self,
        kind: str,
        matrix: Doubles,
        window_min: tuple[float, float],
        window_max: tuple[float, float],
        clip_start: float,
        clip_end: float,
        aperture_radius: float = 0.0,
        focus_distance: float = 10.0,
        blades: int = 0,
        blade_rotation: float = 0.0,
        aperture_ratio: float = 1.0,
        dicing: bool = False,
        panorama: Panorama | None = None,
        motion: Doubles | None = None,
        windows: Doubles | None = None,
        shutter_curve: Floats | None = None,
        rolling_shutter: float | None = None,
    ) -> None:
        """kind: PERSPECTIVE (window on the plane at distance 1), ORTHOGRAPHIC (world units), whole picture; or PANORAMIC,
        which has no window.

        While the shutter is open, at even times: motion, matrices (n, 4, 4); windows (n, 4), lower left and upper right
        corners of a perspective camera; shutter_curve, how far it is open. rolling_shutter: the share of the time for
        which a row is exposed, from the upper border to the lower."""
    def add_image_file(
        self,
        name: str,
        path: str | bytes,
        color_space: str,
        config: str | bytes = "",
        picture: int = 0,
        alpha: str = "OPACITY",
    ) -> int:
        """color_space: SRGB, LINEAR or NON_COLOR; or, by a configuration of OpenColorIO at the path `config`, one of its
        spaces. picture: of a movie, from 0 on. alpha: OPACITY of the colours, which a file says to come multiplied by it
        or not; MULTIPLIED, the same whatever the file says; SEPARATE from them; or IGNORED. Returns a texture id for the
        operations image and environment. The header is read at once, the rest in the background; a session refuses a
        scene with images that cannot be read, unless they are left out."""
    def leave_out_unreadable_images(self) -> list[tuple[str, str]]:
        """Waits until all images are read. Those that cannot be are pink from now on; returns their names and reasons."""
    def add_packed_image(
        self, name: str, content: bytes, color_space: str, config: str | bytes = "", alpha: str = "OPACITY"
    ) -> int:
        """content: of a PNG, JPEG, OpenEXR, TIFF, Radiance, WebP or BMP file."""
    def add_image_pixels(
        self, name: str, pixels: Floats, color_space: str, config: str | bytes = "", alpha: str = "OPACITY"
    ) -> int:
        """pixels (height, width, channels), rows bottom to top."""
    texture_memory: int

class Settings:
    """What an artist sets; see core/scene/settings.h for meaning and units. All are keyword arguments."""

    def __init__(self, **values: Any) -> None: ...
    width: int
    height: int
    crop_x: int
    crop_y: int
    crop_width: int
    crop_height: int
    samples: int
    part_x: int
    part_y: int
    part_width: int
    part_height: int
    first_sample: int
    sample_count: int
    noise_threshold: float
    target_error: float
    least_samples: int
    time_limit: float
    keep_sums: bool
    draft: bool  # coarse facets, nothing displaced: for a first look
    seed: int
    threads: int
    tile_size: int
    stream_paths: int
    max_bounces: int
    diffuse_bounces: int
    glossy_bounces: int
    transmission_bounces: int
    transparent_bounces: int
    volume_bounces: int
    roulette_start: int
    shadow_bias: float
    clamp_direct: float
    clamp_indirect: float
    filter_glossy: float  # density per solid angle below which scattering blurs what comes next; 0: never
    reflective_caustics: bool
    refractive_caustics: bool
    film_transparent: bool
    film_glass_roughness: float  # with a transparent film, glass up to this roughness shows no world; -1: none
    mist_start: float
    mist_depth: float
    mist_falloff: float
    filter: str
    filter_width: float
    exposure: float
    integrator: str
    occlusion_distance: float
    glossy_rays: int
    light_rays: int
    hemisphere_rays: int
    indirect: str
    irradiance_cache: bool
    irradiance_error: float
    resident_megabytes: float
    geometry_cache_megabytes: float
    tessellation_factor: float
    geometry_cache_mode: str
    stochastic_levels: bool
    importance_levels: bool
    least_mirrored_spread: float
    ray_interpolation: RayInterpolation
    passes: list[str]

class Session:
    """One render of one scene. Commits the scene in `render`, not before."""

    def __init__(
        self, scene: SceneDescription, settings: Settings, ray_caches: RayCacheStore | None = None
    ) -> None: ...
    def render(self) -> bool:
        """Blocks, without the GIL, until done (True) or cancelled (False). Once; what is added to the scene meanwhile is
        not in the picture."""
    def build(self) -> bool:
        """Commit the scene, to render it step by step; False if it was cancelled."""
    def render_blocks(self, size: int) -> bool:
        """One sample for each block of `size` x `size` pixels; False if it was cancelled."""
    def render_more(self, count: int) -> bool:
        """The next `count` samples of each pixel; False if it was cancelled."""
    def cancel(self) -> None:
        """From any thread; `render` returns soon after."""
    def progress(self) -> tuple[str, float]:
        """What is being done ("building", "rendering", "done") and the share of pixels done, 0..1."""
    def pass_pixels(self, name: str) -> Floats:
        """(height, width, channels) of the cropped part, rows bottom to top; a copy of what is there now."""
    def statistics(self) -> dict[str, Any]: ...
    def sums(self) -> dict[str, Doubles]:
        """Of each pass that was computed, what `FilmSums.add` takes. For settings with `keep_sums`, after `render`."""
    def write_exr(self, path: str) -> None:
        """All passes as one multilayer EXR."""
    def write_ppm(self, path: str) -> None:
        """The combined pass as a binary PPM: 8 bits, sRGB, no alpha."""

class Denoiser:
    """Open Image Denoise 1 or 2: the library that the process has, or else of one of the paths, or of the system. Raises
    InputError where there is none."""

    def __init__(self, paths: Sequence[str] = ..., threads: int = 0) -> None: ...
    @property
    def version(self) -> str: ...
    def denoised(
        self,
        color: Floats,
        albedo: Floats | None = None,
        normal: Floats | None = None,
        prefilter: str = "ACCURATE",
    ) -> NDArray[np.float32]:
        """All (height, width, 3). prefilter, of the guides: NONE (they have no noise), FAST, ACCURATE."""

class FilmSums:
    """Puts together what was rendered in parts: other pixels, other samples. The same bits as rendered at once."""

    def __init__(self, width: int, height: int, passes: list[str]) -> None: ...
    def add(self, x: int, y: int, samples: int, sums: dict[str, Doubles]) -> None:
        """Samples of a rectangle from (x, y) on: of each pass (height, width, channels, terms), doubles that add up to the sum."""
    def samples(self) -> tuple[int, int]:
        """The fewest and the most that a pixel has."""
    def pass_pixels(self, name: str) -> Floats:
        """(height, width, channels), rows bottom to top, of the samples that there are."""

class PixelFilterKind:
    """Shapes of the pixel filter."""

    BOX: PixelFilterKind
    GAUSSIAN: PixelFilterKind
    BLACKMAN_HARRIS: PixelFilterKind

def sampler_pairs(pixel: int, samples: int, dimension: int, seed: int = 0, together: int = 1) -> Floats:
    """The renderer's random numbers for samples 0..n-1 of a pixel in one dimension: (n, 2) in [0, 1); so many are
    computed together, they are the same."""

def filter_offsets(kind: PixelFilterKind, width: float, random: Floats) -> Doubles:
    """Where the pixel filter puts samples: offsets (n, 2) from the pixel's centre for random numbers (n, 2)."""

def transferred_differential(incoming: Any, direction: Any, t: float, normal: Any) -> list[list[float]]:
    """A ray differential (dp_dx, dp_dy, dd_dx, dd_dy) moved along its ray to a plane."""

def reflected_differential(incoming: Any, direction: Any, normal: Any, dn_dx: Any, dn_dy: Any) -> list[list[float]]:
    """The differential after a mirror."""

def refracted_differential(
    incoming: Any, direction: Any, normal: Any, dn_dx: Any, dn_dy: Any, eta: float
) -> list[list[float]]:
    """The differential after a refraction."""

distribution: Any
"""Parts of distribution ray tracing on arrays, for tests (core/python/distribution.cpp)."""
trace: Any
"""Shapes and rays against them without a scene, for tests and benchmarks (core/python/trace.cpp)."""
ri_tree: Any
"""Ray caches over one shape, for tests and benchmarks (core/python/ri_tree.cpp)."""

class LightProbe:
    """The lights of a scene, asked from a position."""

    def __init__(self, scene: SceneDescription) -> None: ...
    def sample(
        self, position: Doubles, random: Floats, lit_by: int = 0x7FFFFFFFFFFFFFFF, normal: Doubles | None = None
    ) -> dict[str, Any]:
        """Light sampling for random numbers (n, 2): a dictionary of direction, distance, radiance, density, delta.

        A sample that carries nothing has density 0. `normal` (3,): of a surface there that is lit from that side.
        """
    def look(
        self, position: Doubles, directions: Doubles, lit_by: int = 0x7FFFFFFFFFFFFFFF, normal: Doubles | None = None
    ) -> tuple[Floats, Floats]:
        """What shines from directions (n, 3): radiance, and the density with which light sampling chooses them."""
    def count(self) -> int:
        """How many lights there are: each lamp, emitting element, and the world if it is sampled."""
