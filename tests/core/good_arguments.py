"""Arguments that every bound function accepts, and how calls are made of them: for core/good_calls.py."""

import functools
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import rayleaf_rivals as rivals
from core import scenes, shapes, subdivision_cages
from rayleaf import _core

Call = Callable[[], tuple[Callable[..., Any], dict[str, Any]]]

trace, ri_tree, shading, distribution = _core.trace, _core.ri_tree, _core.shading, _core.distribution
RAYS = {"origins": np.array([[0.1, 0.2, 5.0], [3, 0, 0]]), "directions": np.array([[0.0, 0, -1], [-1, 0.1, 0]])}
PATCH = np.array([[[0.0, 0, 0, 1], [1, 0, 0, 1]], [[0, 1, 0, 1], [1, 1, 1, 1]]])
PATCH_SPLINE = (PATCH, (2, False, False, False), (2, False, False, False), True, 0)
CURVE = np.array([[0.0, 0, 0, 1], [1, 0, 0, 1], [1, 1, 0, 2], [2, 1, 0, 1]])
T = np.array([0.25, 0.5])
NUMBERS = np.array([[0.25, 0.5], [0.75, 0.125]], np.float32)
PAIRS = np.array([[0.25, 0.5], [0.75, 0.125]], np.float32)
TRIPLES = np.array([[0.25, 0.5, 0.5], [0.75, 0.125, 0.5]], np.float32)
UP, ROWS = (0.0, 0.0, 1.0), [(1.0, 0.0, 0.0)] * 4
SURFACE_ROWS = [(0.0, 0.0, 1.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)]
CUBE = subdivision_cages.cube()
TRIANGLE = {"vertices": np.eye(3, dtype=np.float32), "triangles": np.array([[0, 1, 2]], np.int32)}
CELL = (4, 2, (0, 0, 0, 0))


def program() -> Any:
    """A diffuse material."""
    made = _core.Program("diffuse")
    made.operation("diffuse", [made.constant(1, 1, 1, 1), made.constant(0.8, 0.8, 0.8, 1)])
    return made


def scene() -> Any:
    """Something of each kind that others refer to, and a camera."""
    made = _core.SceneDescription()
    made.add_shape(shapes.nurbs_sphere())
    made.add_material("diffuse", program())
    made.add_material_list([0])
    made.add_ray_interpolation("sphere", _core.RayInterpolation())
    made.add_instance("sphere", 0, np.eye(4), 0)
    made.add_lamp("lamp", "POINT", scenes.matrix((0, 0, 4)), (10, 10, 10), radius=0.1)
    made.set_camera("PERSPECTIVE", scenes.matrix((0, 0, 5)), (-0.5, -0.5), (0.5, 0.5), 0.1, 100.0)
    return made


def settings(**more: Any) -> Any:
    """A picture of a few pixels."""
    return _core.Settings(width=4, height=3, crop_width=4, crop_height=3, samples=1, threads=1, **more)


def session(rendered: bool = False) -> Any:
    """A session."""
    made = _core.Session(scene(), settings())
    if rendered:
        assert made.render()
    return made


def splines() -> Any:
    """One spline of a curve."""
    return _core.CurveSplines("POLY", np.array([3], np.int32), np.array([[0.0, 0, 0, 1], [1, 0, 0, 1], [1, 1, 0, 1]]))


def swept(**options: Any) -> Any:
    """A bevelled curve."""
    return _core.SweptCurve("curve", [splines()], bevel_depth=0.1, **options)


def strands() -> Any:
    """One hair."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]])
    return _core.Strands("hair", points, np.full(3, 0.1, np.float32), np.array([0, 3], np.int32))


@functools.cache
def net() -> Any:
    """The Bezier form of a surface."""
    return _core.NurbsSpline(PATCH, 2, 2).to_bezier()


@functools.cache
def chain() -> Any:
    """The Bezier form of a curve."""
    return _core.NurbsCurve(CURVE, 3).to_bezier()


def store() -> Any:
    """Textures, one of them."""
    made = shading.TextureStore(1 << 24)
    made.add_pixels("image", np.ones((2, 3, 4), np.float32), shading.ColorSpace.LINEAR)
    return made


@functools.cache
def points() -> Any:
    """Points to shade."""
    return shading.surface_points(TRIPLES, TRIPLES, TRIPLES)


@functools.cache
def closures() -> Any:
    """The closures of one of them."""
    return points().closures(program(), 0)


@functools.cache
def tracer() -> Any:
    """A tracer of one sphere."""
    return trace.Tracer([(shapes.nurbs_sphere(), np.eye(4), shapes.EVERYTHING)])


@functools.cache
def tree(kind: str = "MIRROR", make: Any = ri_tree.FastTree) -> Any:
    """A ray cache over a sphere."""
    return make(shapes.nurbs_sphere(), kind, cache_bytes=1 << 20)


@functools.cache
def flat() -> Any:
    """A surface that rivals can trace."""
    return trace.PatchSurface("surface", [PATCH_SPLINE])


@functools.cache
def rival(method: str = "TRIANGLES") -> Any:
    """A rival."""
    return rivals.RivalTracer([(flat(), "MIRROR", 1.0)], method)


@functools.cache
def baseline() -> Any:
    """Embree's own grids over a sphere."""
    return rivals.EmbreeBaseline(shapes.nurbs_sphere(), "GRID", pixel_angle=0.1)


def plane() -> Any:
    """A sphere in the image plane."""
    return rivals.ImagePlane(shapes.nurbs_sphere(), "MIRROR")


def in_temporary(name: str) -> str:
    """A path that can be written."""
    return str(Path(tempfile.gettempdir()) / name)


HEMISPHERE = int(np.prod(distribution.hemisphere_shape(8)))
MOTION = np.stack([np.eye(4), scenes.matrix((1, 0, 0))])
INSTANCES = {
    "names": ["a", "b"],
    "shapes": np.zeros(2, np.int32),
    "matrices": np.stack([np.eye(4)] * 2),
    "material_lists": np.zeros(2, np.int32),
    "object_indices": np.zeros(2, np.int32),
    "randoms": np.zeros(2, np.float32),
    "visibilities": np.full(2, 31, np.int32),
    "ray_interpolations": np.zeros(2, np.int32),
    "light_groups": np.zeros(2, np.int32),
    "assets": ["a", ""],
    "motions": {1: MOTION},
    "shadow_terminators": np.zeros(2, np.float32),
}
CAMERA = {
    "kind": "PERSPECTIVE",
    "matrix": np.eye(4),
    "window_min": (-0.5, -0.5),
    "window_max": (0.5, 0.5),
    "clip_start": 0.1,
    "clip_end": 100.0,
    "aperture_radius": 0.1,
    "motion": MOTION,
    "windows": np.array([[-0.5, -0.5, 0.5, 0.5], [-0.6, -0.5, 0.5, 0.5]]),
    "shutter_curve": np.ones(3, np.float32),
    "rolling_shutter": 0.5,
}
CAGE = {
    "name": "cube",
    "vertices": CUBE.vertices.astype(np.float32),
    "face_sizes": np.full(6, 4, np.int32),
    "corners": np.ravel(CUBE.faces).astype(np.int32),
    "crease_edges": np.array([[0, 1]], np.int32),
    "crease_sharpness": np.ones(1, np.float32),
    "crease_vertices": np.array([2], np.int32),
    "vertex_sharpness": np.ones(1, np.float32),
    "material_slots": np.zeros(6, np.int32),
    "uv_maps": {0: np.zeros((24, 2), np.float32)},
    "attributes": {1: np.zeros((24, 3), np.float32)},
    "corner_normals": np.tile(np.array([0, 0, 1], np.float32), (24, 1)),
    "moved_vertices": np.stack([CUBE.vertices, 2 * CUBE.vertices]).astype(np.float32),
}
HAIR = {
    "name": "hair",
    "points": np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0]]),
    "radii": np.full(3, 0.1, np.float32),
    "offsets": np.array([0, 3], np.int32),
    "cyclic": np.zeros(1, np.uint8),
    "material_slots": np.zeros(1, np.int32),
    "attributes": {0: np.zeros((1, 2), np.float32)},
    "point_attributes": {1: np.zeros((3, 2), np.float32)},
    "info": {"LENGTH": 2},
}
SPLINES = {
    "type": "BEZIER",
    "counts": np.array([2], np.int32),
    "points": CURVE[:2],
    "handles": np.zeros((2, 2, 3)),
    "radii": np.ones(2),
    "tilts": np.zeros(2),
    "straight": np.zeros(2, bool),
}


def ctor(function: Any, /, **arguments: Any) -> Call:
    """A call of what needs nothing before it."""
    return lambda: (function, arguments)


def method(make: Callable[[], Any], name: str, /, **arguments: Any) -> Call:
    """A call of a method of something new."""
    return lambda: (getattr(make(), name), arguments)


def later(function: Any, /, **arguments: Callable[[], Any]) -> Call:
    """The same with arguments that are made for each call."""
    return lambda: (function, {name: make() for name, make in arguments.items()})
