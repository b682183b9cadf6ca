"""Volume objects: the length of rays inside, by tracing and by interpolation."""

import numpy as np
import pytest
from cached_scenes import INTERPOLATED, MIDDLE, MISSED, SIZE, STILL, STRIP, TWO_CLASS, render, share_of, world
from path_scenes import material
from scenes import CUBE_TRIANGLES, CUBE_VERTICES, background, look_down, matrix, quad, sphere_spline

PASSES = ["combined", "path_length", "mask"]


def scene_of(core, *volumes, floor=None):
    """Spheres of (place, radius, VolumeVisualisation)."""
    scene = core.SceneDescription()
    for i, (place, radius, volume) in enumerate(volumes):
        materials = scene.add_material_list([scene.add_material(f"volume {i}", None, volume=volume)])
        shape = scene.add_surface(f"ball {i}", [sphere_spline(core)])
        scene.add_instance(f"ball {i}", shape, matrix(place, radius), materials)
    if floor is not None:
        scene.add_instance(
            "floor", quad(scene, "floor", 6.0, floor), matrix(), material(core, scene, ("diffuse", 1, 0.8))
        )
    scene.set_world(world(core), 32)
    look_down(scene, 6.0, 0.3)
    return scene


def chords(height=6.0, half=0.3, radius=1.0):
    """The length inside a sphere at the origin of the rays through pixel centres."""
    x = STRIP["crop_x"] + np.arange(STRIP["crop_width"])
    y = STRIP["crop_y"] + np.arange(STRIP["crop_height"])
    dx, dy = ((place + 0.5) / SIZE * 2 * half - half for place in np.meshgrid(x, y))
    direction = np.stack([dx, dy, -np.ones_like(dx)], -1)
    direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
    along = direction[..., 2] * -height
    distance2 = height**2 - along**2
    return 2 * np.sqrt(np.maximum(radius**2 - distance2, 0.0))


@pytest.mark.parametrize("mode", ["OFF", "ON"])
def test_the_path_length_of_a_sphere_is_that_of_its_chords(core, mode):
    scene = scene_of(core, ((0, 0, 0), 1.0, core.VolumeVisualisation()))
    session = render(core, scene, mode, **STILL, passes=PASSES)
    lengths = session.pass_pixels("path_length")[..., 0]
    # The error of interpolated lengths is within the threshold, a share of half the object's size; more at the rim.
    apart = np.abs(lengths - chords())
    # Traced: facets lie within 1e-3 of the sphere, which shortens a chord of length l by 4e-3 / l.
    assert (apart * chords() < 4e-3).all() if mode == "OFF" else np.median(apart) < 0.005
    if mode == "ON":
        assert share_of(session, INTERPOLATED, TWO_CLASS) > 0.1 and share_of(session, MISSED) > 0


def test_emission_adds_and_absorption_takes_density_times_length(core):
    still = dict(**STILL, passes=PASSES)
    glowing = core.VolumeVisualisation("EMISSION", 0.5, (1.0, 0.5, 0.0))
    dark = core.VolumeVisualisation("ABSORPTION", 0.5, (1.0, 0.5, 0.1))
    empty = render(core, scene_of(core), "OFF", **still).pass_pixels("combined")[..., :3]
    length = chords()[..., None]
    lit = render(core, scene_of(core, ((0, 0, 0), 1.0, glowing)), "OFF", **still).pass_pixels("combined")[..., :3]
    error = 4e-3 / np.maximum(length, 0.1)  # of a length, as above
    assert (np.abs(lit - (empty + 0.5 * length * [1.0, 0.5, 0.0])) <= 0.5 * error + 1e-5).all()
    shaded = render(core, scene_of(core, ((0, 0, 0), 1.0, dark)), "OFF", **still).pass_pixels("combined")[..., :3]
    # The logarithm of the darkest component, times its density.
    assert (np.abs(shaded - empty * np.array([1.0, 0.5, 0.1]) ** (0.5 * length)) <= 0.5 * 2.303 * error + 1e-5).all()


def test_lengths_of_several_objects_add_up_and_scale_with_the_object(core):
    volume = core.VolumeVisualisation()
    scene = scene_of(core, ((0, 0, 1.0), 0.5, volume), ((0, 0, -1.0), 0.25, volume))
    for mode in ("OFF", "ON"):
        session = render(core, scene, mode, **STILL, passes=PASSES)
        assert session.pass_pixels("path_length")[MIDDLE][0] == pytest.approx(1.5, abs=0.02), mode


def test_only_what_lies_in_front_of_a_surface_counts(core):
    volume = core.VolumeVisualisation()
    for floor, expected in ((0.0, 1.0), (-2.0, 2.0), (2.0, 0.0)):
        scene = scene_of(core, ((0, 0, 0), 1.0, volume), floor=floor)
        for mode in ("OFF", "ON"):
            session = render(core, scene, mode, **STILL, passes=PASSES)
            # On, lengths at centres of cells may be off by 0.05 of half the object's size, which is 1.
            near = pytest.approx(expected, abs=0.01 if mode == "OFF" else 0.05)
            assert session.pass_pixels("path_length")[MIDDLE][0] == near, (floor, mode)


def test_a_camera_inside_a_volume_counts_from_there(core):
    scene = scene_of(core, ((0, 0, 6.0), 1.0, core.VolumeVisualisation()))
    for mode in ("OFF", "ON"):
        session = render(core, scene, mode, **STILL, passes=PASSES)
        assert session.pass_pixels("path_length")[MIDDLE][0] == pytest.approx(1.0, abs=0.02), mode


def test_absorbing_objects_cast_shadows_and_glowing_ones_do_not(core):
    def lit(volume):
        scene = scene_of(core, ((1.2, 0, 0), 0.5, volume), floor=-1.0)
        scene.set_world(background(core, strength=0.0))
        scene.add_lamp("sun", "SUN", matrix(), (3, 3, 3))
        return render(core, scene, "OFF", samples=1, passes=PASSES).pass_pixels("combined")[..., :3]

    clear = lit(core.VolumeVisualisation("ABSORPTION", 0.0))
    shadowed = lit(core.VolumeVisualisation("ABSORPTION", 2.0, (0.2, 0.2, 0.2)))
    assert shadowed.min() < 0.3 * clear.min()
    glowing = lit(core.VolumeVisualisation("EMISSION", 2.0))
    assert (glowing >= clear - 1e-6).all()


def test_a_volume_object_is_no_surface(core):
    volume = core.VolumeVisualisation("EMISSION", 0.0)
    scene = scene_of(core, ((0, 0, 0), 1.0, volume), floor=-2.0)
    session = render(core, scene, "OFF", passes=["combined", "depth"], **STILL)
    assert session.pass_pixels("depth")[MIDDLE][0] == pytest.approx(8.0, abs=1e-4)


@pytest.mark.parametrize("wrong", [dict(density=-1.0), dict(density=float("nan")), dict(color=(1, -1, 1))])
def test_volumes_without_meaning_are_rejected_by_name(core, wrong):
    scene = core.SceneDescription()
    with pytest.raises(core.InputError, match="smoke.*volume"):
        scene.add_material("smoke", None, volume=core.VolumeVisualisation(**wrong))


def test_a_kind_that_is_unknown_is_named(core):
    with pytest.raises(core.InputError, match="SCATTERING"):
        core.VolumeVisualisation("SCATTERING")


def test_boxes_of_facets_are_volumes_too(core):
    scene = core.SceneDescription()
    box = scene.add_mesh("box", CUBE_VERTICES, CUBE_TRIANGLES)
    fog = scene.add_material_list([scene.add_material("fog", None, volume=core.VolumeVisualisation())])
    scene.add_instance("box", box, matrix(), fog)
    scene.set_world(world(core), 32)
    look_down(scene, 6.0, 0.1)
    for mode in ("OFF", "ON"):
        session = render(core, scene, mode, **STILL, passes=PASSES)
        assert session.pass_pixels("path_length")[MIDDLE][0] == pytest.approx(2.0, abs=0.01), mode
