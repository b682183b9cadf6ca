"""Runs inside Blender: every node that a shader tree may hold, its modes and sockets, and what Rayleaf does with it; and all
comparisons of nodes that the oracles make."""

import importlib
from dataclasses import dataclass

import bpy
import compiled_nodes
import scenes
from oracle_case import modes, put
from property_walk import accepts
from rayleaf import _core

ORACLES = (
    "nodes",
    "surface",
    "spread",
    "surroundings",
    "portals",
    "lamp_nodes",
    "light_path",
    "sky",
    "volume",
    "grids",
    "smoke",
)
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
    shown = {each.identifier for each in sockets if each.enabled and not each.is_unavailable}
    return shown - {"__extend__"}  # of nodes that a user may give more of them


@dataclass
class State:
    """A node with one of its choices made."""

    told: list
    inputs: set
    outputs: set

    @classmethod
    def of(cls, kind, path="", value=None):
        """What a fresh node is then."""
        node = compiled_nodes.node(kind)
        if path:
            put(node, path, value)
        return cls(told(node), enabled(node.inputs), enabled(node.outputs))


def walk_modes(row, node):
    """Each choice in turn: what is told of it alone, and the sockets it has if nothing is."""
    inputs, outputs = set(), set()
    for path in modes(node):
        values = choices(compiled_nodes.node(row["node"]), path)
        row["modes"][path] = values
        states = {str(value): State.of(row["node"], path, value) for value in values}
        always = set.intersection(*(set(state.told) for state in states.values()))
        for value, state in states.items():
            if named := [text for text in state.told if text not in always]:
                row["told_of"][f"{path}={value}"] = named
            else:
                inputs |= state.inputs
                outputs |= state.outputs
    return inputs, outputs


def described(kind):
    """One node."""
    node, state = compiled_nodes.node(kind), State.of(kind)
    is_supported = kind in compiled_nodes.supported_kinds()
    use = "supported" if is_supported else "organises" if kind in _ORGANISE else "left out"
    row = {"node": kind, "label": node.bl_label, "use": use, "told": state.told, "modes": {}, "told_of": {}}
    inputs, outputs = walk_modes(row, node) if is_supported else (set(), set())
    if not row["modes"]:
        inputs, outputs = state.inputs, state.outputs
    return {**row, "inputs": sorted(inputs), "outputs": sorted(outputs)}


if __name__ == "__main__":
    scenes.empty_scene()
    nodes = [described(kind) for kind in kinds()]
    compared = {name: importlib.import_module(f"{name}_oracle").compared_nodes() for name in ORACLES}
    globals()["report"](nodes=nodes, compared=compared)
