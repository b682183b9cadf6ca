"""Filter Glossy and the caustics switches, in both engines. Inside Blender."""

import sys
from pathlib import Path

import both_engines
import bpy
import scenes

SIZE, SAMPLES = 48, 256


def caustics(reflective, refractive):
    """Light over mirrors, and through glass, or none. Blurred, so that few samples show what is left."""

    def change(scene):
        scene.cycles.caustics_reflective = scene.rayleaf.use_reflective_caustics = reflective
        scene.cycles.caustics_refractive = scene.rayleaf.use_refractive_caustics = refractive
        both_engines.blur(scene, 10.0)

    return change


CASES = {
    "sharp": lambda scene: both_engines.blur(scene, 0.0),
    "a little": lambda scene: both_engines.blur(scene, 0.3),
    "usual": lambda scene: both_engines.blur(scene, 1.0),
    "wide": lambda scene: both_engines.blur(scene, 10.0),
    "none reflected": caustics(False, True),
    "none refracted": caustics(True, False),
    "none": caustics(False, False),
}


def add_ball(place, shader, distribution=None, **inputs):
    """A smooth ball of one shader."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.5, location=place)
    bpy.ops.object.shade_smooth()
    material, tree, output = scenes.material(shader)
    node = tree.nodes.new(f"ShaderNode{shader}")
    if distribution:
        node.distribution = distribution
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    bpy.context.object.data.materials.append(material)


def build():
    """Mirrors, glass and a coat on a matte floor, under a broad lamp and a sky: light comes to the floor by way of them."""
    scenes.empty_file()
    scenes.plain_world((0.2, 0.2, 0.2))
    scene = bpy.context.scene
    floor = scenes.quad("floor")
    floor.location, floor.scale = (-2, -2, 0), (4, 4, 1)
    material, tree, _ = scenes.material("white")
    scenes.diffuse_alone(tree).inputs[0].default_value = (0.8, 0.8, 0.8, 1)
    floor.data.materials.append(material)
    add_ball((-1.1, 0.6, 0.5), "BsdfGlossy", "GGX", Roughness=0.0)
    add_ball((0.0, 0.6, 0.5), "BsdfGlass", "GGX", Roughness=0.0)
    add_ball((1.1, 0.6, 0.5), "BsdfGlossy", "BECKMANN", Roughness=0.1)
    add_ball((-1.1, -0.6, 0.5), "BsdfRefraction", "BECKMANN", Roughness=0.1)
    add_ball((0.0, -0.6, 0.5), "BsdfPrincipled", Roughness=0.05, **{scenes.TRANSMISSION: 0.6})
    add_ball((1.1, -0.6, 0.5), "BsdfPrincipled", Metallic=0.5, Roughness=0.3, **{scenes.COAT: 1.0})
    lamp = bpy.data.lights.new("area", "AREA")
    lamp.energy, lamp.size = 150, 2.0
    scenes.add(lamp).location = (0, 0, 3)
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", 3.6
    scene.camera = scenes.add(camera)
    scene.camera.location, scene.camera.rotation_euler = (0, -6, 6), (0.785, 0, 0)
    both_engines.show_direct_light(scene, SIZE, SAMPLES)
    both_engines.set_alike(scene, max_bounces=4, diffuse_bounces=2, glossy_bounces=4, transmission_bounces=4)
    return scene


if __name__ == "__main__":
    folder, found = Path(sys.argv[1]), {}
    for case, change in CASES.items():
        shown = build()
        change(shown)
        found[case] = {}
        for engine in ("CYCLES", "RAYLEAF"):
            path = folder / f"{engine} {case}.exr"
            found[case][engine] = both_engines.means(both_engines.picture(shown, engine, path)[..., :3], 8)
    report(found=found)
