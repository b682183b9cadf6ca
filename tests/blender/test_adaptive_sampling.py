"""Noise threshold, time limit and target error from Blender's settings to the picture."""

SCENE = """
import bpy
import plain_exr
import scenes
scene = bpy.context.scene
scene.render.engine = "RAYLEAF"
scene.render.resolution_x, scene.render.resolution_y, scene.render.resolution_percentage = 64, 48, 100
own, layer = scene.rayleaf, bpy.context.view_layer
layer.rayleaf.use_pass_sample_count = True

scenes.write_layers()

def counts():
    scene.render.filepath = bpy.app.tempdir + "counts.exr"
    bpy.ops.render.render(write_still=True)
    found = plain_exr.read(scene.render.filepath)
    return next(values for name, values in found.items() if "Debug Sample Count" in name)
"""


def test_a_render_of_the_default_cube_takes_samples_where_the_noise_is(run_blender):
    run = run_blender(
        SCENE
        + """
own.samples, own.use_noise_threshold, own.noise_threshold = 256, True, 0.02
few = counts()
own.use_noise_threshold = False
own.samples = 3
all_of_them = counts()
own.samples, own.time_limit = 1 << 20, 0.2
limited = counts()
own.time_limit, own.target_error = 0.0, 0.002
aimed = counts()
report(few=[int(few.min()), int(few.max())], all=[int(all_of_them.min()), int(all_of_them.max())],
       limited=[int(limited.min()), int(limited.max())], aimed=[int(aimed.min()), int(aimed.max())])
"""
    ).report
    least, most = run["few"]
    assert least < most <= 256 and least == 52
    assert run["all"] == [3, 3]
    assert run["limited"][0] == run["limited"][1] < 1 << 20
    assert 4 == run["aimed"][0] < run["aimed"][1] < 1000
