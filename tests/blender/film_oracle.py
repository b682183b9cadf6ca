"""What a world, its film and shadows hide from rays, in both engines. Inside Blender."""

import sys
from pathlib import Path

import both_engines
import bpy
import scenes

SIZE, SAMPLES = 48, 64


def hide_world(**hidden):
    """The world without the light that some rays look for."""

    def change(scene):
        for kind in hidden:
            setattr(scene.world.cycles_visibility, kind, False)

    return change


def clear_film(threshold):
    """A transparent film that glass up to a roughness belongs to; none at all for None."""

    def change(scene):
        scene.render.film_transparent = True
        scene.cycles.film_transparent_glass = threshold is not None
        scene.cycles.film_transparent_roughness = threshold or 0.0

    return change


def opaque_shadows(scene):
    """See-through surfaces whose shadow is that of a wall: for a lamp without a size, which no other ray finds."""
    bpy.data.lights["sun"].angle = 0.0
    for ball in [item for item in scene.objects if item.name.startswith("Sphere")]:
        bpy.data.objects.remove(ball)  # they would throw small bright specks of its light
    scenes.cast_solid_shadows(bpy.data.materials["screen"])
    bpy.data.materials["screen"].update_tag()


CASES = {
    "plain": lambda scene: None,
    "no camera": hide_world(camera=False),
    "no diffuse": hide_world(diffuse=False),
    "no glossy": hide_world(glossy=False),
    "no transmission": hide_world(transmission=False),
    "camera alone": hide_world(diffuse=False, glossy=False, transmission=False, scatter=False),
    "film": clear_film(None),
    "film and glass": clear_film(0.1),
    "film and rough glass": clear_film(0.5),
    "opaque shadows": opaque_shadows,
}


def add_ball(place, shader, **inputs):
    """A smooth ball of one shader."""
    bpy.ops.mesh.primitive_uv_sphere_add(segments=48, ring_count=24, radius=0.55, location=place)
    bpy.ops.object.shade_smooth()
    material, tree, output = scenes.material(shader)
    node = tree.nodes.new(f"ShaderNode{shader}")
    for name, value in inputs.items():
        node.inputs[name].default_value = value
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    bpy.context.object.data.materials.append(material)


def add_screen():
    """A pane that half of the light goes through, between the lamp and the floor."""
    bpy.ops.mesh.primitive_plane_add(size=1.0, location=(0.0, -1.2, 0.3))
    material, tree, output = scenes.material("screen")
    material.name = "screen"
    node = tree.nodes.new("ShaderNodeBsdfTransparent")
    node.inputs[0].default_value = (0.5, 0.5, 0.5, 1)
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    bpy.context.object.data.materials.append(material)
    bpy.context.object.visible_camera = False


def shade_sky(world):
    """Brighter above, by nodes: a world that directions are sampled of."""
    world.use_nodes = True
    tree = world.node_tree
    geometry, split = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeSeparateXYZ")
    scaled = tree.nodes.new("ShaderNodeMath")
    scaled.operation, scaled.inputs[1].default_value, scaled.inputs[2].default_value = "MULTIPLY_ADD", 0.4, 0.6
    tree.links.new(geometry.outputs["Generated"], split.inputs[0])
    tree.links.new(split.outputs["Z"], scaled.inputs[0])
    background = next(node for node in tree.nodes if node.type == "BACKGROUND")
    tree.links.new(scaled.outputs[0], background.inputs["Color"])


def build():
    """A matte, a glossy and two glass balls above a small floor, in front of the sky."""
    scenes.empty_file()
    scenes.plain_world((0.6, 0.6, 0.6))
    scene = bpy.context.scene
    shade_sky(scene.world)
    bpy.ops.mesh.primitive_plane_add(size=3.0)
    add_ball((-0.8, -0.6, 0.7), "BsdfDiffuse")
    add_ball((0.6, -0.6, 0.7), "BsdfGlossy", Roughness=0.2)
    add_ball((-0.8, 0.7, 1.3), "BsdfGlass", Roughness=0.0)
    add_ball((0.2, 0.9, 1.9), "BsdfRefraction", Roughness=0.3)
    add_screen()
    lamp = bpy.data.lights.new("sun", "SUN")
    lamp.energy, lamp.angle = 1.0, 0.3
    scenes.add(lamp)
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale = "ORTHO", 4.0
    scene.camera = scenes.add(camera)
    scene.camera.location, scene.camera.rotation_euler = (0, -8, 3), (1.3, 0, 0)
    both_engines.show_direct_light(scene, SIZE, SAMPLES)
    both_engines.set_alike(scene, max_bounces=4)
    both_engines.without_blur(scene)
    return scene


if __name__ == "__main__":
    folder, found = Path(sys.argv[1]), {}
    for case, change in CASES.items():
        shown = build()
        change(shown)
        found[case] = {}
        for engine in ("CYCLES", "RAYLEAF"):
            path = folder / f"{engine} {case}.exr"
            found[case][engine] = both_engines.means(both_engines.picture(shown, engine, path), 8)
    report(found=found)
