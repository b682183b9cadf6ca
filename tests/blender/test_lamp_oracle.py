"""Lamp strengths against Cycles: a white diffuse plane below each kind of lamp as the add-on describes it, rendered by both."""

import numpy as np
import pytest

# Lamps above the plane.
SCRIPT = """
import both_engines
import bpy
import numpy as np
from rayleaf import _core as core
from rayleaf.export import lights
from rayleaf.messages import Messages

SIZE, VIEW, SAMPLES = 9, 4.0, 1024
CASES = {
    "point": dict(type="POINT", energy=100, shadow_soft_size=0.0),
    "small disk": dict(type="POINT", energy=100, shadow_soft_size=0.1),
    "large disk": dict(type="POINT", energy=100, shadow_soft_size=1.2),
    "sun": dict(type="SUN", energy=3, angle=0.0),
    "wide sun": dict(type="SUN", energy=3, angle=0.5),
    "sharp spot": dict(type="SPOT", energy=100, shadow_soft_size=0.0, spot_size=1.2, spot_blend=0.0),
    "spot": dict(type="SPOT", energy=100, shadow_soft_size=0.0, spot_size=1.2, spot_blend=0.5),
    "soft spot": dict(type="SPOT", energy=100, shadow_soft_size=0.05, spot_size=1.8, spot_blend=1.0),
    "softer spot": dict(type="SPOT", energy=100, shadow_soft_size=0.8, spot_size=1.8, spot_blend=1.0),
    "square": dict(type="AREA", energy=100, shape="SQUARE", size=1.0),
    "rectangle": dict(type="AREA", energy=100, shape="RECTANGLE", size=1.5, size_y=0.7),
    "disk": dict(type="AREA", energy=100, shape="DISK", size=1.5),
    "ellipse": dict(type="AREA", energy=100, shape="ELLIPSE", size=1.5, size_y=0.7),
    "spread": dict(type="AREA", energy=100, shape="SQUARE", size=1.0, spread=1.0),
    "wide spread": dict(type="AREA", energy=100, shape="SQUARE", size=1.0, spread=2.0),
    "scaled": dict(type="AREA", energy=100, shape="SQUARE", size=0.5, scale=(2, 3, 1)),
}
if "use_soft_falloff" in bpy.types.PointLight.bl_rna.properties:
    CASES["sphere"] = dict(type="POINT", energy=100, shadow_soft_size=1.2, use_soft_falloff=False)
    CASES["spot with a sphere"] = {**CASES["softer spot"], "use_soft_falloff": False}


def cycles_scene():
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples, scene.cycles.use_adaptive_sampling, scene.cycles.use_denoising = SAMPLES, False, False
    scene.cycles.pixel_filter_type = "BOX"  # one pixel wide
    scene.render.resolution_x = scene.render.resolution_y = SIZE
    scene.render.image_settings.file_format, scene.render.image_settings.color_depth = "OPEN_EXR", "32"
    both_engines.white_floor(VIEW)
    return scene


def by_cycles(scene, case, path):
    lamp = bpy.data.lights.new("lamp", case["type"])
    for key, value in case.items():
        if key not in ("type", "scale"):
            setattr(lamp, key, value)
    placed = bpy.data.objects.new("lamp", lamp)
    placed.location, placed.rotation_euler, placed.scale = (0.3, 0.2, 2), (0.2, 0.1, 0), case.get("scale", (1, 1, 1))
    scene.collection.objects.link(placed)
    scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
    arguments = lights.describe(core, placed, np.array(placed.matrix_world), 63, None, Messages())
    bpy.data.objects.remove(placed)
    image = bpy.data.images.load(path)
    pixels = np.array(image.pixels[:]).reshape(SIZE, SIZE, 4)[..., 0]
    bpy.data.images.remove(image)
    return pixels, arguments


def by_rayleaf(lamp):
    scene = core.SceneDescription()
    vertices = np.array([[-50, -50, 0], [50, -50, 0], [50, 50, 0], [-50, 50, 0]], np.float32)
    plane = scene.add_mesh("plane", vertices, np.array([[0, 1, 2], [0, 2, 3]], np.int32))
    program = core.Program("white")
    one = program.constant(1, 1, 1, 1)
    program.operation("diffuse", [one, one])
    materials = scene.add_material_list([scene.add_material("white", program)])
    scene.add_instance("plane", plane, np.eye(4), materials)
    scene.add_lamp(**lamp)
    camera = np.eye(4)
    camera[2, 3] = 20
    scene.set_camera("ORTHOGRAPHIC", camera, (-VIEW / 2, -VIEW / 2), (VIEW / 2, VIEW / 2), 0.1, 100)
    settings = core.Settings(
        width=SIZE, height=SIZE, samples=SAMPLES, max_bounces=0, filter="BOX", filter_width=1.0
    )
    session = core.Session(scene, settings)
    session.render()
    return session.pass_pixels("combined")[..., 0]


import os, tempfile
scene = cycles_scene()
path = os.path.join(tempfile.mkdtemp(), "cycles.exr")
pictures = {}
for name, case in CASES.items():
    cycles, lamp = by_cycles(scene, case, path)
    pictures[name] = (cycles.tolist(), by_rayleaf(lamp).tolist())
# A lamp in front of the camera: Cycles does not show it.
scene.camera.rotation_euler = (np.pi, 0, 0)
lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "AREA"))
lamp.data.energy, lamp.data.size, lamp.location = 1000, 10, (0, 0, 30)
scene.collection.objects.link(lamp)
bpy.ops.render.render(write_still=True)
image = bpy.data.images.load(path)
report(pictures=pictures, seen_by_camera=max(image.pixels[:][0::4]))
"""


@pytest.fixture
def pictures(run_blender):
    return run_blender(SCRIPT).report


def test_lamps_are_as_strong_as_in_cycles_and_unseen_by_the_camera(pictures):
    for name, (cycles, rayleaf) in pictures["pictures"].items():
        expected, got = np.array(cycles), np.array(rayleaf)
        brightest = expected.max()
        # Noise of 1024 samples of each: below 1 % in a pixel, 2 % below the narrow spread, a tenth of that in the mean.
        assert np.abs(got - expected).max() < 0.05 * brightest, f"{name}\n{expected}\n{got}"
        assert got.mean() == pytest.approx(expected.mean(), rel=0.003), name
    assert pictures["seen_by_camera"] == 0.0
