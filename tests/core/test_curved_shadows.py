"""Light that grazes curved surfaces: no acne, no steps at the terminator, no leaks, at any size; the shadow bias."""

import numpy as np
import pytest
import scenes
import shapes
from core import swept_support as swept

SUN = np.array([1.0, 1.0, 1.0])


def facing(direction):
    """A matrix whose z axis points along a direction: a lamp that shines from there."""
    z = direction / np.linalg.norm(direction)
    x = np.cross([0.3, 1.0, 0.2], z)
    x /= np.linalg.norm(x)
    matrix = np.eye(4)
    matrix[:3, :3] = np.stack([x, np.cross(z, x), z], axis=1)
    return matrix


def coarse_sphere(scene, columns=14, rows=9):
    """Triangles that are shaded smooth."""
    longitude, latitude = np.arange(columns) / columns * 2 * np.pi, np.linspace(0, np.pi, rows + 1)[:, None]
    ring = [
        np.sin(latitude) * np.cos(longitude),
        np.sin(latitude) * np.sin(longitude),
        np.cos(latitude + 0 * longitude),
    ]
    vertices = np.stack(ring, axis=-1).reshape(-1, 3).astype(np.float32)
    row, column = np.mgrid[:rows, :columns]
    next_column = (column + 1) % columns
    a, b = row * columns + column, (row + 1) * columns + column
    c, d = (row + 1) * columns + next_column, row * columns + next_column
    triangles = np.concatenate([np.stack([a, b, c], -1), np.stack([a, c, d], -1)]).reshape(-1, 3).astype(np.int32)
    return scene.add_mesh("coarse", vertices, triangles, vertices[triangles])


def solid(core, scene, name, **size):
    if name == "coarse":
        return coarse_sphere(scene)
    if name == "sphere":
        return scene.add_surface("sphere", [scenes.sphere_spline(core)])
    if name == "tube":
        return scene.add_curve(swept.curve("POLY", [[-2, 0, 0], [2, 0.3, 0.1]], bevel_depth=0.8, fill_caps=True))
    ring = np.array([[1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0]], float) * 0.6
    handles = ring[:, None] + 0.5523 * np.stack([-np.roll(ring, -1, axis=0), np.roll(ring, -1, axis=0)], axis=1)
    return scene.add_curve(swept.curve("BEZIER", ring, handles, cyclic=True, bevel_depth=0.25))


def picture(core, name, light, size=1.0, offset=0.0, terminator=0.1, **settings):
    """Passes of one sample a pixel of a white solid under a sun, by name."""
    scene = core.SceneDescription()
    white = scene.add_material_list([scene.add_material("white", scenes.diffuse(core, color=(1, 1, 1)))])
    place = scenes.matrix(np.full(3, offset), size)
    scene.add_instance(name, solid(core, scene, name), place, white, 1, shadow_terminator=terminator)
    scene.add_lamp("sun", "SUN", facing(light), SUN)
    scene.set_camera(
        "PERSPECTIVE", scenes.matrix(np.array([0, 0, 4 * size]) + offset), (-0.3, -0.3), (0.3, 0.3), 1e-3 * size, 1e9
    )
    return scenes.render(
        core,
        scene,
        **{"width": 160, "height": 160, "samples": 1, "filter_width": 0.01, "max_bounces": 0, **settings},
        passes=["combined", "normal", "object_index"],
    )


LIGHTS = {"low": [1, 0.2, 0.05], "behind": [0.3, 1, -0.6], "above": [0.2, 0.1, 1], "grazing": [0, 1, 1e-3]}


@pytest.mark.parametrize("light", LIGHTS)
@pytest.mark.parametrize("name", ["sphere", "tube", "coarse"])
def test_a_convex_solid_is_as_bright_as_its_normal_says_up_to_the_terminator(core, name, light):
    passes = picture(core, name, np.array(LIGHTS[light]))
    towards = np.array(LIGHTS[light]) / np.linalg.norm(LIGHTS[light])
    # At the silhouette a facet may be seen whose exact normal faces away from the camera; shading turns it.
    place = (np.arange(160) + 0.5) / 160 * 0.6 - 0.3
    to_camera = np.stack([*np.meshgrid(-place, -place), np.ones((160, 160))], axis=-1)
    # Facets may lie 1e-3 of the solid's size beside it: then they are turned by up to sqrt(8e-3), those of a coarse mesh
    # by a quarter.
    faces_camera = np.sum(passes["normal"] * to_camera, axis=-1) > (0.3 if name == "coarse" else 0.03)
    hit = (passes["object_index"][..., 0] == 1) & faces_camera
    cosine = np.maximum(0, passes["normal"].astype(float) @ towards)
    bright = passes["combined"][..., 0].astype(float)
    factor = bright[hit].sum() / cosine[hit].sum()
    assert factor > 0
    # The last thousandths of a cosine may be lost where a facet's edge lies on the surface.
    wrong = np.argwhere(hit & (np.abs(bright - factor * cosine) > 3e-3 * factor))
    assert len(wrong) == 0, f"{len(wrong)} of {hit.sum()} pixels, the first {wrong[:3].tolist()}"


def test_without_an_offset_the_facets_of_a_coarse_mesh_shade_themselves(core):
    light = np.array(LIGHTS["behind"])
    lifted, plain = (picture(core, "coarse", light, terminator=share)["combined"][..., 0] for share in (0.1, 0.0))
    assert np.count_nonzero((lifted > 0) & (plain == 0)) > 300
    assert np.all(lifted >= plain)


@pytest.mark.parametrize("share", [-0.1, 1.1, float("nan")])
def test_an_offset_beyond_its_range_is_refused(core, share):
    with pytest.raises(core.InputError, match="'sphere': shadow terminator"):
        picture(core, "sphere", SUN, terminator=share)


@pytest.mark.parametrize("size, offset", [(1e-4, 0.0), (1e4, 0.0), (1.0, 1e5), (1e-2, 1e4)])
def test_a_bent_tube_looks_the_same_at_any_size_and_place(core, size, offset):
    light = np.array(LIGHTS["low"])
    near, other = picture(core, "ring", light), picture(core, "ring", light, size, offset)
    same = np.isclose(near["combined"], other["combined"], atol=2e-3).all(axis=-1)
    # Silhouettes of the tube and of its shadow may fall to either side of a pixel's sample.
    assert np.mean(~same) < 0.01


HOLLOW = {
    "ring": lambda core, scene: solid(core, scene, "ring"),
    "torus": lambda core, scene: scene.add_shape(shapes.nurbs_torus()),
    "torus with dents": lambda core, scene: scene.add_shape(shapes.lumpy_torus()),
}


@pytest.mark.slow
@pytest.mark.parametrize("integrator", ["PATH", "DISTRIBUTION"])
@pytest.mark.parametrize("name", HOLLOW)
def test_no_light_leaves_a_closed_tube(core, name, integrator):
    """Where a surface is hollow, light from inside the body may lie above the surface and below its facet."""
    scene = core.SceneDescription()
    white = scene.add_material_list([scene.add_material("white", scenes.diffuse(core))])
    scene.add_instance(name, HOLLOW[name](core, scene), np.eye(4), white, 1)
    scene.add_instance("floor", scenes.quad(scene, "floor", 3.0, -0.5), np.eye(4), white, 2)
    scene.add_lamp("lamp", "POINT", scenes.matrix((0.68, 0, 0)), np.full(3, 1e6), radius=0.05)
    scenes.look_down(scene, 5.0, 0.4)
    passes = scenes.render(core, scene, width=64, height=64, samples=256, integrator=integrator, passes=["combined"])
    assert passes["combined"][..., :3].max() == 0


def test_the_shadow_bias_ignores_what_is_nearer_and_nothing_else(core):
    bright = {}
    for bias in (0.0, 0.05, 0.2):
        scene = core.SceneDescription()
        white = scene.add_material_list([scene.add_material("white", scenes.diffuse(core))])
        scene.add_instance("floor", scenes.quad(scene, "floor", 2.0), np.eye(4), white, 1)
        roof = scene.add_instance("roof", scenes.quad(scene, "roof", 2.0, 0.1), np.eye(4), white, 2, visibility=16)
        assert roof == 1
        scene.add_lamp("sun", "SUN", facing(np.array([0.0, 0, 1])), SUN)
        scenes.look_down(scene, 5.0, 0.2)
        passes = scenes.render(core, scene, width=8, height=8, samples=1, max_bounces=0, shadow_bias=bias)
        bright[bias] = passes["combined"][..., 0].mean()
    assert bright[0.0] == bright[0.05] == 0
    assert bright[0.2] > 0


def test_a_negative_shadow_bias_is_refused(core):
    with pytest.raises(core.InputError, match="shadow bias"):
        picture(core, "tube", SUN, shadow_bias=-1.0)
