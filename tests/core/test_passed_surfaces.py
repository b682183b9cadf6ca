"""Surfaces that let light through, found on the way of a shadow ray all at once, or one after the other."""

import numpy as np
import pytest
from path_scenes import lit_plane, material, render
from scenes import look_down, matrix, quad, sphere_spline

TINT = (0.95, 0.8, 0.6)


def grid_mesh(scene, steps, bent=0.0):
    """A square of `steps` times `steps` quads, 1 wide; a wave if it is bent."""
    x, y = np.meshgrid(*[np.linspace(-0.5, 0.5, steps + 1)] * 2, indexing="ij")
    vertices = np.stack([x, y, bent * np.sin(5 * x)], -1).reshape(-1, 3).astype(np.float32)
    first = (np.arange(steps)[:, None] * (steps + 1) + np.arange(steps)).ravel()
    corners = np.stack([first, first + steps + 1, first + steps + 2, first + 1], -1)
    triangles = np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]]).astype(np.int32)
    return scene.add_mesh("pane", vertices, triangles)


PANES = {
    "a few triangles": lambda core, scene: quad(scene, "pane", 0.5),
    "many triangles": lambda core, scene: grid_mesh(scene, 6),
    "waves": lambda core, scene: grid_mesh(scene, 8, 0.2),
    "spline spheres": lambda core, scene: scene.add_surface("ball", [sphere_spline(core, radius=0.3)]),
}


def turned(random):
    q, _ = np.linalg.qr(random.normal(size=(3, 3)))
    placed = np.eye(4)
    placed[:3, :3], placed[:3, 3] = q * random.uniform(0.3, 1.0), [*random.uniform(-1, 1, 2), random.uniform(0.8, 1.8)]
    return placed


def behind_panes(core, panes, count, followed, opaque=0):
    """A plane that a lamp lights past `count` tinted panes and opaque ones; shadow rays alone see them."""
    random = np.random.default_rng(7)
    scene = lit_plane(core)
    look_down(scene, half=1.0)
    pane = PANES[panes](core, scene)
    program = core.Program("tint")
    program.operation("transparent", [program.constant(1, 1, 1, 1), program.constant(*TINT, 1)])
    slots = [scene.add_material("tint", program)]
    if followed:  # at what may border a medium
        fog = core.Program("fog")
        fog.operation("volume_scatter", [fog.constant(*[0.1] * 4)] * 4)
        slots.append(scene.add_material("fog", None, medium=fog))
    tint = scene.add_material_list(slots)
    wall = material(core, scene, ("diffuse", 1.0, 0.5), name="wall")
    for i in range(count + opaque):
        scene.add_instance(f"pane {i}", pane, turned(random), tint if i < count else wall, visibility=16)
    scene.add_lamp("lamp", "POINT", matrix((0, 0, 3)), (300,) * 3, visibility=30)
    return scene


def lit(core, *arguments, transparent_bounces, **settings):
    scene = behind_panes(core, *arguments)
    session = render(
        core, scene, size=32, samples=4, max_bounces=0, transparent_bounces=transparent_bounces, **settings
    )
    return session.pass_pixels("combined")[..., :3]


@pytest.mark.parametrize("panes", PANES)
@pytest.mark.parametrize("count,limit", [(1, 8), (12, 8), (12, 2), (40, 5), (40, 8), (40, 64), (150, 8), (150, 64)])
def test_what_is_found_at_once_takes_the_light_that_it_takes_one_by_one(core, panes, count, limit):
    """More than eight surfaces on a way are not kept: such a way is followed."""
    at_once = lit(core, panes, count, False, transparent_bounces=limit)
    one_by_one = lit(core, panes, count, True, transparent_bounces=limit)
    assert np.ptp(one_by_one) > 0.1 * one_by_one.max()
    np.testing.assert_allclose(at_once, one_by_one, rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("panes", PANES)
def test_opaque_surfaces_among_them_let_nothing_through(core, panes):
    at_once = lit(core, panes, 20, False, 6, transparent_bounces=8)
    np.testing.assert_allclose(at_once, lit(core, panes, 20, True, 6, transparent_bounces=8), rtol=1e-5, atol=1e-6)
    dark = (at_once == 0.0).all(-1)
    assert 0.02 < dark.mean() < 0.98


def test_packets_streams_and_threads_do_not_show(core):
    scene = [behind_panes(core, "waves", 30, False, 3) for _ in range(4)]
    settings = [dict(stream_paths=0), dict(stream_paths=7), dict(stream_paths=4096), dict(threads=1, tile_size=8)]
    pictures = [
        render(core, each, size=32, samples=4, max_bounces=1, **setting).pass_pixels("combined")
        for each, setting in zip(scene, settings, strict=True)
    ]
    for other in pictures[1:]:
        np.testing.assert_array_equal(other, pictures[0])
