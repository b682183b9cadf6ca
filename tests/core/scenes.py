"""Small scenes for tests, described from plain Python."""

import numpy as np

CUBE_VERTICES = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], np.float32)
CUBE_TRIANGLES = np.array(
    [
        [0, 1, 3],
        [0, 3, 2],
        [4, 6, 7],
        [4, 7, 5],
        [0, 4, 5],
        [0, 5, 1],
        [2, 3, 7],
        [2, 7, 6],
        [0, 2, 6],
        [0, 6, 4],
        [1, 5, 7],
        [1, 7, 3],
    ],
    np.int32,
)


def matrix(translation=(0, 0, 0), scale=1.0):
    m = np.eye(4)
    m[:3, :3] *= scale
    m[:3, 3] = translation
    return m


def quad(core_scene, name, size=1.0, height=0.0):
    """A square in the xy-plane that faces up."""
    vertices = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32) * size + [0, 0, height]
    return core_scene.add_mesh(name, vertices.astype(np.float32), np.array([[0, 1, 2], [0, 2, 3]], np.int32))


def diffuse(core, name="diffuse", color=(0.8, 0.8, 0.8)):
    program = core.Program(name)
    program.operation("diffuse", [program.constant(1, 1, 1, 1), program.constant(*color, 1)])
    return program


def emission(core, name="emission", color=(1, 1, 1), strength=1.0):
    program = core.Program(name)
    program.operation(
        "emission", [program.constant(1, 1, 1, 1), program.constant(*color, 1), program.constant(*[strength] * 4)]
    )
    return program


def background(core, color=(1, 1, 1), strength=1.0):
    program = core.Program("world")
    program.operation(
        "background", [program.constant(1, 1, 1, 1), program.constant(*color, 1), program.constant(*[strength] * 4)]
    )
    return program


def look_down(core_scene, height=5.0, half=1.0, **more):
    """A perspective camera on the z axis that looks down and sees +-half * height at the origin's plane."""
    core_scene.set_camera("PERSPECTIVE", matrix((0, 0, height)), (-half, -half), (half, half), 0.01, 1000.0, **more)


def sphere_points(radius=1.0):
    """The control points of Blender's NURBS sphere: (5, 8, 4)."""
    # Clockwise from above: the outside of a surface is the side of dP/dv x dP/du, as in Blender.
    ring = [(1, 0), (1, -1), (0, -1), (-1, -1), (-1, 0), (-1, 1), (0, 1), (1, 1)]
    profile = [(0, -1), (1, -1), (1, 0), (1, 1), (0, 1)]
    points = np.zeros((5, 8, 4))
    for v, (distance, z) in enumerate(profile):
        for u, (x, y) in enumerate(ring):
            weight = (np.sqrt(0.5) if u % 2 else 1.0) * (np.sqrt(0.5) if v % 2 else 1.0)
            points[v, u] = (radius * distance * x, radius * distance * y, radius * z, weight)
    return points


def sphere_spline(core, slot=0, smooth=True, radius=1.0, points=None):
    """Blender's NURBS sphere: 8 x 5 points, order 3, Bezier knots, cyclic in u here. `points`: other ones."""
    return core.NurbsSpline(
        sphere_points(radius) if points is None else points,
        3,
        3,
        cyclic_u=True,
        cyclic_v=False,
        endpoint_u=True,
        endpoint_v=True,
        bezier_u=True,
        bezier_v=True,
        material_slot=slot,
        smooth=smooth,
    )


def small_scene(core):
    """A spline sphere and a cube on a floor, a lamp and a grey world: every kind of ray in a few pixels."""
    scene = core.SceneDescription()
    materials = scene.add_material_list([scene.add_material("clay", diffuse(core), 3)])
    scene.add_instance("floor", quad(scene, "floor", 4.0, -1.0), matrix(), materials, 1)
    scene.add_instance("ball", scene.add_surface("ball", [sphere_spline(core)]), matrix((-1.2, 0, 0)), materials, 2)
    scene.add_instance(
        "cube", scene.add_mesh("cube", CUBE_VERTICES, CUBE_TRIANGLES), matrix((1.5, 0, 0), 0.7), materials, 5
    )
    scene.add_lamp("key", "POINT", matrix((2, -3, 4)), (300, 280, 250), radius=0.3)
    scene.set_world(background(core, (0.2, 0.3, 0.4)))
    look_down(scene, 6.0, 0.6)
    return scene


def render(core, scene, **settings):
    """Passes of a render as a dictionary of arrays."""
    values = {"width": 24, "height": 16, "samples": 4, **settings}
    session = core.Session(scene, core.Settings(**values))
    assert session.render()
    return {name: session.pass_pixels(name) for name in values.get("passes", ["combined"])}
