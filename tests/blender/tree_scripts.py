"""Scripts that compile a node tree inside Blender, and tell what becomes of it."""

START = """
import bpy, scenes, recording_core
scene = scenes.empty_scene()
item = scenes.quad()

def emission(tree, output):
    shader = tree.nodes.new("ShaderNodeEmission")
    tree.links.new(shader.outputs[0], output.inputs["Surface"])
    return shader

def compiled():
    sent, _, texts = recording_core.export()
    return sent.materials[0]["surface"], texts

def told(value):
    "A register in words: a constant's numbers, or the operation with its operands."
    if not isinstance(value, dict):
        return value if value is None else [round(x, 5) for x in value]
    return [value["op"], value["text"], value["ints"]] + [told(each) for each in program.operands(value)]

def forget(*kinds):
    "Nodes of these kinds are from now on like those of a later Blender."
    from rayleaf.export.nodes import compiler, load_nodes
    load_nodes()
    for kind in kinds:
        compiler.VALUE_NODES.pop(kind, None)
        compiler.CLOSURE_NODES.pop(kind, None)

material, tree, output = scenes.material()
item.data.materials.append(material)
nodes, links = tree.nodes, tree.links
"""


def run_tree(run_blender, lines):
    """The operands of the tree's only emission in words, and the messages."""
    run = run_blender(
        START
        + "shader = emission(tree, output)\n"
        + lines
        + """
program, texts = compiled()
_, color, strength = program.operands(program.line("emission"))
report(color=told(color), strength=told(strength), texts=texts)
"""
    )
    return run.report
