"""Nodes that few trees have: muted ones, and inputs that nothing is linked to behind others. Inside Blender."""

import bpy
import scenes
from oddity_scenes import CASES, case, link_image


def number_as_attribute(kind, value, output):
    """A case: an attribute of single numbers as a colour. Output 2 is Fac."""

    def change(scene, item, tree, shader):
        item.data.attributes.new("number", kind, "FACE").data[0].value = value
        node = tree.nodes.new("ShaderNodeAttribute")
        node.attribute_name = "number"
        tree.links.new(node.outputs[output], shader.inputs["Color"])

    return change


CASES["whole number"] = number_as_attribute("INT", 3, 0)
CASES["flag"] = number_as_attribute("BOOLEAN", True, 0)
CASES["number"] = number_as_attribute("FLOAT", 0.4, 0)
CASES["number as factor"] = number_as_attribute("FLOAT", 0.4, 2)


def _muted(tree, kind, output=0):
    node = tree.nodes.new(kind)
    node.mute = True
    return node.outputs[output]


def muted(kind, output, name):
    """A case: a muted node feeds the shader, whose own value is another."""

    def change(scene, item, tree, shader):
        shader.inputs["Color"].default_value, shader.inputs["Strength"].default_value = (0.2, 0.3, 0.7, 1), 0.4
        tree.links.new(_muted(tree, kind, output), shader.inputs[name])

    return change


CASES["muted colour"] = muted("ShaderNodeRGB", 0, "Color")
CASES["muted value"] = muted("ShaderNodeValue", 0, "Strength")
CASES["muted image"] = muted("ShaderNodeTexImage", 0, "Color")
CASES["muted noise"] = muted("ShaderNodeTexNoise", 0, "Strength")
CASES["muted Fresnel"] = muted("ShaderNodeFresnel", 0, "Strength")
CASES["muted mix"] = muted("ShaderNodeMixRGB", 0, "Color")
CASES["reroute"] = muted("NodeReroute", 0, "Color")


def shader_as(name, past=None):
    """A case: another shader is linked to a value of the shader, which is its own then; past a node that passes it on."""

    def change(scene, item, tree, shader):
        shader.inputs["Color"].default_value, shader.inputs["Strength"].default_value = (0.2, 0.3, 0.7, 1), 0.4
        output = tree.nodes.new("ShaderNodeBsdfDiffuse").outputs[0]
        if past is not None:
            node = tree.nodes.new(past)
            tree.links.new(output, node.inputs[0])
            output = node.outputs[0]
        tree.links.new(output, shader.inputs[name])

    return change


CASES["shader as a colour"] = shader_as("Color")
CASES["shader as a number"] = shader_as("Strength")
CASES["shader as a colour past a reroute"] = shader_as("Color", "NodeReroute")


def vector_from(make):
    """A case: a node whose input nothing is linked to feeds a texture's vector."""

    def change(scene, item, tree, shader):
        gradient = tree.nodes.new("ShaderNodeTexGradient")
        tree.links.new(make(tree), gradient.inputs["Vector"])
        tree.links.new(gradient.outputs["Color"], shader.inputs["Color"])

    return change


CASES["muted coordinates"] = vector_from(lambda tree: _muted(tree, "ShaderNodeTexCoord", "UV"))
CASES["muted mapping"] = vector_from(lambda tree: _muted(tree, "ShaderNodeMapping"))
CASES["reroute of a vector"] = vector_from(lambda tree: tree.nodes.new("NodeReroute").outputs[0])


def normal_from(make):
    """A case: the same for a shader's normal."""

    def change(scene, item, tree, shader):
        diffuse = scenes.diffuse_alone(tree)
        tree.links.new(make(tree), diffuse.inputs["Normal"])

    return change


CASES["muted normal map"] = normal_from(lambda tree: _muted(tree, "ShaderNodeNormalMap"))
CASES["muted bump"] = normal_from(lambda tree: _muted(tree, "ShaderNodeBump"))
CASES["reroute of a normal"] = normal_from(lambda tree: tree.nodes.new("NodeReroute").outputs[0])


def _group_of_gradient(tree, shader):
    inner = scenes.group("Inner", "NodeSocketVector", "NodeSocketColor")
    begin, end = inner.nodes.new("NodeGroupInput"), inner.nodes.new("NodeGroupOutput")
    gradient = inner.nodes.new("ShaderNodeTexGradient")
    inner.links.new(begin.outputs[0], gradient.inputs["Vector"])
    inner.links.new(gradient.outputs["Color"], end.inputs[0])
    node = tree.nodes.new("ShaderNodeGroup")
    node.node_tree = inner
    tree.links.new(node.outputs[0], shader.inputs["Color"])
    return node


@case
def group_without_its_vector(scene, item, tree, shader):
    _group_of_gradient(tree, shader)


@case
def group_with_a_vector_of_its_own(scene, item, tree, shader):
    _group_of_gradient(tree, shader).inputs[0].default_value = (0.3, 0.1, 0.1)


@case
def group_that_is_gone(scene, item, tree, shader):
    bpy.data.node_groups.remove(_group_of_gradient(tree, shader).node_tree)


@case
def group_of_an_add_on(scene, item, tree, shader):
    class Own(bpy.types.ShaderNodeCustomGroup):
        bl_idname, bl_label = "RAYLEAF_Test_Group", "Own"

    bpy.utils.register_class(Own)
    inner = scenes.group("Inner", "NodeSocketFloat", "NodeSocketColor")
    color, end = inner.nodes.new("ShaderNodeRGB"), inner.nodes.new("NodeGroupOutput")
    color.outputs[0].default_value = (0.1, 0.7, 0.3, 1)
    inner.links.new(color.outputs[0], end.inputs[0])
    node = tree.nodes.new(Own.bl_idname)
    node.node_tree = inner
    tree.links.new(node.outputs[0], shader.inputs["Color"])


@case
def muted_output(scene, item, tree, shader):
    item.location.x = 1
    next(node for node in tree.nodes if node.bl_idname == "ShaderNodeOutputMaterial").mute = True


@case
def texture_without_an_image(scene, item, tree, shader):
    shader.inputs["Color"].default_value = (0.2, 0.2, 0.2, 1)
    node = link_image(tree, shader, None)
    scale = tree.nodes.new("ShaderNodeMath")
    scale.operation, scale.inputs[1].default_value = "MULTIPLY", 0.5
    tree.links.new(node.outputs["Alpha"], scale.inputs[0])
    tree.links.new(scale.outputs[0], shader.inputs["Strength"])
