"""Single nodes, compiled as the add-on compiles trees. Inside Blender."""

from dataclasses import dataclass

import bpy
import property_walk as walk
from rayleaf.export.nodes import compiler, load_nodes
from rayleaf.export.nodes.displacement import compile_displacement
from rayleaf.export.nodes.emitter import Emitter
from rayleaf.messages import Messages, Subject

load_nodes()
DISPLACING = {"ShaderNodeDisplacement", "ShaderNodeVectorDisplacement"}
MIXING = {"ShaderNodeMixShader", "ShaderNodeAddShader"}
_IES = "TILT=NONE\n1 1 1 2 1 1 2 0 0 0 1 1 1 0 90 0 100 50"


def supported_kinds():
    """Nodes that the add-on compiles and that this Blender has: old ones leave it."""
    every = {*compiler.VALUE_NODES, *compiler.CLOSURE_NODES, *compiler.VOLUME_NODES, *MIXING, *DISPLACING}
    return sorted(kind for kind in every if hasattr(bpy.types, kind))


def node(kind):
    """A node in a tree of its own, with an image and a distribution where it wants one."""
    walk.keep_two(bpy.data.node_groups, bpy.data.node_groups.new("Tree", "ShaderNodeTree"))
    made = walk.KEPT[-1].nodes.new(kind)
    if hasattr(made, "image"):
        made.image = bpy.data.images.get("A") or bpy.data.images.new("A", 4, 4)
    if hasattr(made, "ies"):
        made.ies = bpy.data.texts.get("C") or bpy.data.texts.new("C")
        if not made.ies.as_string().strip():
            made.ies.write(_IES)
    return made


class Images:
    """Stands for the library of images: numbers."""

    def texture(self, image, user, frame):
        """By the file."""
        return list(bpy.data.images).index(image)


@dataclass
class Compiled:
    """What became of one output of a node."""

    emitter: Emitter
    registers: object
    names: list  # of the attributes that were asked for
    wanted: list  # of those that must be there
    texts: list  # messages


def compiled(core, made):
    """Each output in use of a node, as a material's."""
    tree, found = made.id_data, []
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    for socket in [each for each in made.outputs if each.enabled]:
        displaces = made.bl_idname in DISPLACING
        fills = made.bl_idname in compiler.VOLUME_NODES and made.bl_idname not in compiler.CLOSURE_NODES
        tree.links.new(socket, output.inputs["Displacement" if displaces else "Volume" if fills else "Surface"])
        messages, emitter, names = Messages(), Emitter(core, "Material"), []
        resources = compiler.Resources(lambda name, kept=names: kept.append(name) or 3, Images(), 1)
        of_tree = compiler.Compiler(emitter, Subject("Material", "Material"), resources, messages)
        compile_closures = of_tree.compile_volume if fills else of_tree.compile_tree
        registers = compile_displacement(of_tree, tree) if displaces else compile_closures(tree)
        found.append(Compiled(emitter, registers, names, sorted(resources.wanted_attributes), messages.texts))
    return found
