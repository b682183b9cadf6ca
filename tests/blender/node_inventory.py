"""Runs inside Blender: every node that a shader tree may hold, its modes and sockets, and what Rayleaf does with it; and all
comparisons of nodes that the oracles make."""

import importlib

import bpy
import compiled_nodes
import scenes
from oracle_case import modes, put
from property_walk import accepts
from rayleaf import _core

ORACLES = ("nodes", "surface", "spread", "surroundings", "lamp_nodes", "light_path", "sky", "volume", "grids", "smoke")
# What belongs to trees and computes nothing; a renderer reads what it connects.
_ORGANISE = {
    *("NodeFrame", "NodeReroute", "NodeGroupInput", "NodeGroupOutput", "ShaderNodeGroup"),
    *("ShaderNodeOutputMaterial", "ShaderNodeOutputWorld", "ShaderNodeOutputLight", "ShaderNodeOutputLineStyle"),
    "ShaderNodeOutputAOV",
}


def kinds():
    """Every node that this Blender has for shaders."""
    tree, found = bpy.data.node_groups.new("Tree", "ShaderNodeTree"), []
    for name in sorted(dir(bpy.types)):
        if name.startswith("ShaderNode") or name in _ORGANISE:
            try:
                tree.nodes.new(name)
            except RuntimeError:  # a base class
                continue
            found.append(name)
    return found


def told(node):
    """The messages of all outputs, without what they are about."""
    texts = [text for each in compiled_nodes.compiled(_core, node) for text in each.texts]
    return list(dict.fromkeys(text.partition(": ")[2] for text in texts))


def choices(node, path):
    """The values that a choice or switch can have."""
    *way, name = path.split(".")
    for step in way:
        node = getattr(node, step)
    prop = node.bl_rna.properties[name]
    if prop.type == "BOOLEAN":
        return [False, True]
    return [item.identifier for item in prop.enum_items if accepts(node, name, item.identifier)]


def enabled(sockets):
    """By identifier."""
    return {each.identifier for each in sockets if each.enabled and not each.is_unavailable}


def described(kind):
    """One node."""
    node = compiled_nodes.node(kind)
    is_supported = kind in compiled_nodes.supported_kinds()
    use = "supported" if is_supported else "organises" if kind in _ORGANISE else "left out"
    row = {"node": kind, "label": node.bl_label, "use": use, "told": told(node), "modes": {}, "told_of": {}}
    inputs, outputs = enabled(node.inputs), enabled(node.outputs)
    if is_supported:
        for path in modes(node):
            row["modes"][path] = values = choices(node, path)
            for value in values:
                node = compiled_nodes.node(kind)
                put(node, path, value)
                more = [text for text in told(node) if text not in row["told"]]
                if more:
                    row["told_of"][f"{path}={value}"] = more
                else:
                    inputs |= enabled(node.inputs)
                    outputs |= enabled(node.outputs)
    return {**row, "inputs": sorted(inputs), "outputs": sorted(outputs)}


if __name__ == "__main__":
    scenes.empty_scene()
    nodes = [described(kind) for kind in kinds()]
    compared = {name: importlib.import_module(f"{name}_oracle").compared_nodes() for name in ORACLES}
    globals()["report"](nodes=nodes, compared=compared)
