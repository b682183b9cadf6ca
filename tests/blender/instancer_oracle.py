"""Runs inside Blender: cubes that vertices, faces and particles of a grid make, in the colours of the place on it that makes
them (From Instancer), in both engines."""

import sys
from pathlib import Path

import both_engines
import bpy
import scenes

PIXELS = 120


def shining():
    """A material of texture coordinates, moved up: there is no negative light."""
    material, tree, output = scenes.material("coordinates")
    tree.nodes.clear()
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    emission, shifted = tree.nodes.new("ShaderNodeEmission"), tree.nodes.new("ShaderNodeVectorMath")
    coordinates, uv_map = tree.nodes.new("ShaderNodeTexCoord"), tree.nodes.new("ShaderNodeUVMap")
    coordinates.from_instancer = uv_map.from_instancer = True
    shifted.inputs[1].default_value = (1.0, 1.0, 1.0)
    tree.links.new(shifted.outputs[0], emission.inputs["Color"])
    tree.links.new(emission.outputs[0], output.inputs["Surface"])
    sockets = {
        "Generated": coordinates.outputs["Generated"],
        "UV": coordinates.outputs["UV"],
        "UV Map": uv_map.outputs[0],
    }
    return material, tree, sockets, shifted.inputs[0]


def made_by(kind, cube):
    """A grid that makes cubes of a kind."""
    bpy.ops.mesh.primitive_grid_add(x_subdivisions=6, y_subdivisions=6, size=2)
    grid = bpy.context.object
    grid.show_instancer_for_render = grid.show_instancer_for_viewport = False
    if kind != "PARTICLES":
        cube.parent, grid.instance_type = grid, kind
        return
    bpy.ops.object.particle_system_add()
    settings = grid.particle_systems[0].settings
    settings.type, settings.count, settings.emit_from, settings.hair_length = "HAIR", 40, "FACE", 1.0
    settings.render_type, settings.instance_object, settings.particle_size = "OBJECT", cube, 1.0


if __name__ == "__main__":
    report = globals()["report"]  # given by the test
    pictures = {}
    for kind in ("VERTS", "FACES", "PARTICLES"):
        scenes.empty_file()
        scene = bpy.context.scene
        scenes.plain_world((0, 0, 0))
        material, tree, sockets, target = shining()
        bpy.ops.mesh.primitive_cube_add(size=0.2, location=(0 if kind != "PARTICLES" else 9, 0, 0))
        bpy.context.object.data.materials.append(material)
        made_by(kind, bpy.context.object)
        both_engines.look_straight_down(scene, 2.4, PIXELS)
        for name, socket in sockets.items():
            tree.links.new(socket, target)
            pictures[f"{kind}, {name}"] = [
                both_engines.picture(scene, engine, Path(sys.argv[1]) / "picture.exr").tolist()
                for engine in ("CYCLES", "RAYLEAF")
            ]
    report(pictures=pictures)
