"""Walks below surfaces: whatever leads them, they bring the light that they have to."""

import numpy as np
import pytest
from path_scenes import picture
from scenes import CUBE_TRIANGLES, CUBE_VERTICES, background, look_down, matrix, sphere_spline

MEAN_FREE_PATH = 2
WHITE = (1.0, 1.0, 1.0)
SETTINGS = dict(max_bounces=60, diffuse_bounces=60, roulette_start=60)


def skin(core, color, paths, anisotropy):
    program = core.Program("skin")
    values = [1.0, color, 1.0, paths, 1.4, anisotropy]
    operands = [program.constant(*(v if isinstance(v, tuple) else (v,) * 3), 1) for v in values]
    program.operation("subsurface", operands, ints=[MEAN_FREE_PATH])
    return program


def body_in_even_light(core, form, program):
    scene = core.SceneDescription()
    materials = scene.add_material_list([scene.add_material("skin", program)])
    if form == "ball":
        scene.add_instance("body", scene.add_surface("ball", [sphere_spline(core)]), matrix(), materials)
    else:
        vertices = CUBE_VERTICES * ((3, 3, 0.1) if form == "plate" else (3, 3, 1))
        scene.add_instance("body", scene.add_mesh("body", vertices, CUBE_TRIANGLES), matrix(), materials)
    scene.set_world(background(core, WHITE), 0)
    look_down(scene, half=0.1)
    return scene


@pytest.mark.slow
@pytest.mark.parametrize("integrator", ["PATH", "DISTRIBUTION"])
@pytest.mark.parametrize("anisotropy", [0.0, 0.1, 0.7])
@pytest.mark.parametrize("paths", [(0.5, 0.3, 0.2), (4.0, 2.0, 0.3)], ids=["dense", "thin"])
@pytest.mark.parametrize("form", ["ball", "plate"])
def test_a_body_that_loses_nothing_is_invisible_in_even_light(core, form, paths, anisotropy, integrator):
    """Light leaves where it can, be it on the other side."""
    scene = body_in_even_light(core, form, skin(core, WHITE, paths, anisotropy))
    image = picture(core, scene, samples=1024, size=4, integrator=integrator, **SETTINGS)
    np.testing.assert_allclose(image.mean((0, 1)), 1.0, atol=0.02)


@pytest.mark.parametrize("anisotropy", [0.0, 0.5])
def test_a_dense_body_has_the_colour_that_it_is_given(core, anisotropy):
    """To within the fit that finds the albedo of one scattering."""
    color = (0.8, 0.5, 0.2)
    scene = body_in_even_light(core, "block", skin(core, color, (0.01, 0.01, 0.01), anisotropy))
    image = picture(core, scene, samples=1024, size=4, **SETTINGS)
    np.testing.assert_allclose(image.mean((0, 1)), color, atol=0.015)
