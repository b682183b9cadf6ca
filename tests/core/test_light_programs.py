"""What programs of lights may ask of who sees them: the same whether a light is sampled or met by chance."""

import numpy as np
import pytest

from path_scenes import material, picture
from rayleaf import _core as core
from scenes import look_down, matrix, quad

INTEGRATORS = ("PATH", "DISTRIBUTION")
UNSEEN = 62  # by the camera


def glowing(strength):
    """A program that emits a value of the Light Path, or 1."""
    program = core.Program("glow")
    white = program.constant(1, 1, 1, 1)
    if strength == "length²":
        length = program.operation("light_path", text="ray_length")
        value = program.operation("math", [length, length], [0], text="MULTIPLY")
    else:
        value = program.operation("light_path", text=strength) if strength else white
    program.operation("emission", [white, white, value])
    return program


def floor():
    scene = core.SceneDescription()
    scene.add_instance("floor", quad(scene, "floor", 20), matrix(), material(core, scene, ("diffuse", 1.0, 0.5)))
    look_down(scene, half=0.02)
    return scene


def lit_by_mesh(strength, integrator, half=0.5):
    scene = floor()
    glow = scene.add_material_list([scene.add_material("glow", glowing(strength))])
    scene.add_instance("light", quad(scene, "light", half, 2.0), matrix(), glow, visibility=UNSEEN)
    return picture(core, scene, samples=1024, max_bounces=0, integrator=integrator).mean()


def lit_by_lamp(strength, integrator):
    scene = floor()
    lamp = dict(strength=(100,) * 3, radius=0.2, emission=glowing(strength), visibility=UNSEEN)
    scene.add_lamp("lamp", "POINT", matrix((0, 0, 2)), **lamp)
    return picture(core, scene, samples=256, max_bounces=0, integrator=integrator).mean()


def lit_through_pane(strength, integrator):
    scene = floor()
    pane = core.Program("pane")
    white = pane.constant(1, 1, 1, 1)
    pane.operation("transparent", [white, pane.operation("light_path", text=strength) if strength else white])
    scene.add_instance(
        "pane", quad(scene, "pane", 20, 1.0), matrix(), scene.add_material_list([scene.add_material("pane", pane)]),
        visibility=UNSEEN,
    )  # fmt: skip
    scene.add_lamp("lamp", "POINT", matrix((0, 0, 2)), strength=(100,) * 3, radius=0.2, visibility=UNSEEN)
    return picture(core, scene, samples=256, max_bounces=0, integrator=integrator).mean()


@pytest.mark.slow
@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("lit", [lit_by_mesh, lit_by_lamp, lit_through_pane])
def test_light_for_what_the_camera_sees_is_one_bounce_deep(lit, integrator):
    """As in Cycles, where light sampling and shadow rays count as a bounce."""
    assert lit("ray_depth", integrator) == pytest.approx(lit("", integrator), rel=1e-5)


@pytest.mark.parametrize("integrator", INTEGRATORS)
@pytest.mark.parametrize("half", [0.3, 2.0])
def test_a_sampled_surface_knows_how_far_away_it_is(half, integrator):
    """Emission by the squared length: what a square of light at height 2 brings, by quadrature."""
    places = (np.arange(400) + 0.5) / 400 * 2 * half - half
    x, y = np.meshgrid(places, places)
    squared = x**2 + y**2 + 4.0
    # Radiance d², times both cosines 2 / d, over d²: 4 / d² in all, times the albedo over pi.
    expected = (4.0 / squared).mean() * (2 * half) ** 2 * 0.5 / np.pi
    assert lit_by_mesh("length²", integrator, half) == pytest.approx(expected, rel=5e-3)


@pytest.mark.slow
@pytest.mark.parametrize("integrator", INTEGRATORS)
def test_a_clear_pane_does_not_change_how_far_away_a_lamp_is(integrator):
    def brightness(has_pane):
        scene = core.SceneDescription()
        scene.add_instance("floor", quad(scene, "floor", 20), matrix(), material(core, scene, ("diffuse", 1.0, 0.5)))
        look_down(scene, half=0.02)
        if has_pane:
            clear = material(core, scene, ("transparent", 1.0, 1.0), name="clear")
            scene.add_instance("pane", quad(scene, "pane", 20, 1.0), matrix(), clear)
        lamp = dict(strength=(10,) * 3, size_x=4.0, size_y=4.0, emission=glowing("length²"), visibility=UNSEEN)
        scene.add_lamp("lamp", "RECTANGLE", matrix((0, 0, 2)), **lamp)
        return picture(core, scene, samples=1024, max_bounces=1, integrator=integrator).mean()

    assert brightness(True) == pytest.approx(brightness(False), rel=0.02)
