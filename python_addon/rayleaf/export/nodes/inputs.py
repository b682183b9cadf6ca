"""Nodes that bring values in: coordinates, geometry, attributes, constants."""

import numpy as np
from numpy.typing import NDArray

from ... import cycles_versions
from ...names import text_of
from ..attributes import STRAND_INFO, STRAND_RANDOM
from ..instance_values import (
    INSTANCER_ATTRIBUTE,
    INSTANCER_GENERATED,
    INSTANCER_UV,
    OBJECT_COLOR,
    PARTICLE,
    PROPERTY_OF,
)
from ..mesh_derived import ISLAND_RANDOM, POINTINESS, REST_PLACE, TANGENT_OF
from ..points import IS_POINT, POSITION, RADIUS, RANDOM
from .compiler import NodeView, value_node
from .emitter import UNCONNECTED, Register

_WORLD, _OBJECT = 0, 1  # spaces of the operation `transform`


def _one_of(view: NodeView, output: str, operations: dict[str, str], neutral: float) -> Register:
    """The operation that stands for an output, or a message and a neutral value."""
    if output in operations:
        return view.emitter.operation(operations[output])
    view.warn(f"its output {output} is not supported; a neutral value is used")
    return view.emitter.scalar(neutral)


def _of_instancer(view: NodeView, name: str) -> Register:
    return view.emitter.operation("attribute", ints=[view.resources.attribute(name)])


@value_node("ShaderNodeTexCoord")
def texture_coordinate(view: NodeView, output: str) -> Register:
    """Texture Coordinate."""
    emitter = view.emitter
    if view.node.from_instancer and output in ("Generated", "UV"):
        return _of_instancer(view, INSTANCER_UV if output == "UV" else INSTANCER_GENERATED)
    if view.compiler.is_lamp and output == "UV" and cycles_versions.lamps_have_uv():
        view.warn("UV coordinates of lamps are not supported; they are 0")
    if output == "UV":
        return emitter.operation("uv", ints=[view.resources.active_uv()])
    if output == "Generated" and not view.compiler.is_lamp:
        return view.compiler.generated()
    if output == "Object" and view.node.object is not None:
        return _in_space_of(view, np.array(view.node.object.matrix_world.inverted_safe(), np.float64))
    if output == "Normal" and view.compiler.bent_normal != UNCONNECTED:
        return emitter.operation("transform", [view.compiler.bent_normal], [_WORLD, _OBJECT], text="NORMAL")
    if view.compiler.is_lamp and (
        output == "Generated" or output == "Object" and not cycles_versions.lamps_have_a_space()
    ):
        return emitter.operation("position")  # in Cycles a lamp is no object
    operations = {
        "Normal": "object_normal",
        "Object": "object_coordinates",
        "Camera": "camera_coordinates",
        "Window": "window",
        "Reflection": "reflection",
    }
    return _one_of(view, output, operations, 0.0)


def _in_space_of(view: NodeView, matrix: NDArray[np.float64]) -> Register:
    """The world position in another object's space; `matrix` takes world to it."""
    emitter = view.emitter
    position = emitter.operation("position")
    components = []
    for row in matrix[:3]:
        turned = emitter.operation("vector_math", [position, emitter.constant(*row[:3])], text="DOT_PRODUCT")
        components.append(emitter.add(turned, emitter.scalar(float(row[3]))))
    return emitter.operation("combine", components)


@value_node("ShaderNodeUVMap")
def uv_map(view: NodeView, output: str) -> Register:
    """UV Map."""
    if view.node.from_instancer:
        return _of_instancer(view, INSTANCER_UV)
    name = text_of(view.node, "uv_map")
    identifier = view.resources.attribute(name) if name else view.resources.active_uv()
    return view.emitter.operation("uv", ints=[identifier])


@value_node("ShaderNodeNewGeometry")
def geometry(view: NodeView, output: str) -> Register:
    """Geometry."""
    if output == "Tangent":  # whatever the UV maps are
        return _radial_tangent(view, "Z")
    if output == "Normal" and view.compiler.bent_normal != UNCONNECTED:
        return view.compiler.bent_normal
    derived = {"Pointiness": POINTINESS, "Random Per Island": ISLAND_RANDOM}
    if output in derived:
        value = view.emitter.operation("attribute", ints=[view.resources.attribute(derived[output])])
        return view.emitter.component(value, 0)
    operations = {
        "Position": "position",
        "Normal": "normal",
        "True Normal": "true_normal",
        "Incoming": "incoming",
        "Parametric": "parametric",
        "Backfacing": "backfacing",
    }
    return _one_of(view, output, operations, 0.5)


@value_node("ShaderNodeObjectInfo")
def object_info(view: NodeView, output: str) -> Register:
    """Object Info."""
    owner = view.compiler.lamp_owner
    known = None if owner is None else owner.info(output)
    if known is not None:
        return view.emitter.constant(*known)
    if output in ("Color", "Alpha"):
        color = view.emitter.operation("attribute", ints=[view.resources.attribute(OBJECT_COLOR)])
        return view.emitter.component(color, 3) if output == "Alpha" else color
    operations = {
        "Location": "object_location",
        "Object Index": "object_index",
        "Material Index": "material_index",
        "Random": "object_random",
    }
    return _one_of(view, output, operations, 1.0)


@value_node("ShaderNodeAttribute")
def attribute(view: NodeView, output: str) -> Register:
    """Attribute."""
    name, kind = text_of(view.node, "attribute_name"), view.node.attribute_type
    if kind == "VIEW_LAYER":
        return _parts_of(view, output, view.emitter.constant(*view.resources.scene_property(name)))
    prefix = {"GEOMETRY": "", "OBJECT": PROPERTY_OF, "INSTANCER": INSTANCER_ATTRIBUTE}[kind]
    if prefix and view.compiler.lamp_owner is not None:
        return _parts_of(view, output, view.emitter.constant(*view.compiler.lamp_owner.property(name)))
    return _attribute_output(view, output, view.resources.attribute(prefix + name))


@value_node("ShaderNodeVertexColor")
def color_attribute(view: NodeView, output: str) -> Register:
    """Color Attribute; without a name the active one."""
    name = text_of(view.node, "layer_name")
    return _attribute_output(view, output, view.resources.attribute(name) if name else view.resources.active_color())


def _attribute_output(view: NodeView, output: str, identifier: int) -> Register:
    return _parts_of(view, output, view.emitter.operation("attribute", ints=[identifier]))


def _parts_of(view: NodeView, output: str, value: Register) -> Register:
    if output == "Fac":
        return view.emitter.operation("average", [value])
    return view.emitter.component(value, 3) if output == "Alpha" else value


@value_node("ShaderNodeHairInfo")
def hair_info(view: NodeView, output: str) -> Register:
    """Hair Info, Curves Info in newer versions."""
    emitter = view.emitter
    if output == "Tangent Normal":
        incoming, tangent = emitter.operation("incoming"), emitter.operation("tangent")
        along = emitter.operation("vector_math", [incoming, tangent], text="PROJECT")
        across = emitter.operation("vector_math", [incoming, along], text="SUBTRACT")
        return emitter.operation("vector_math", [across], text="NORMALIZE")
    name = STRAND_RANDOM if output == "Random" else STRAND_INFO[output.upper().replace(" ", "_")]
    value = emitter.operation("attribute", ints=[view.resources.attribute(name)])
    return emitter.component(value, 0)


@value_node("ShaderNodeLightPath")
def light_path(view: NodeView, output: str) -> Register:
    """Light Path: "Is Camera Ray" is the core's is_camera, "Ray Depth" its ray_depth."""
    name = output.lower().replace(" ", "_").removesuffix("_ray").removesuffix("_scatter")
    return view.emitter.operation("light_path", text=name)


@value_node("ShaderNodeCameraData")
def camera_data(view: NodeView, output: str) -> Register:
    """Camera Data."""
    emitter = view.emitter
    point = emitter.operation("camera_coordinates")
    if output == "View Z Depth":
        return emitter.component(point, 2)
    return emitter.operation("vector_math", [point], text="NORMALIZE" if output == "View Vector" else "LENGTH")


@value_node("ShaderNodeWireframe")
def wireframe(view: NodeView, output: str) -> Register:
    """Wireframe, of meshes: the edges of the triangles that they are rendered as."""
    return view.emitter.operation("wireframe", [view.input("Size")], [int(view.node.use_pixel_size)])


# What a distance of 0 stands for: that of the world's own ambient occlusion, which Blender shows nowhere but beside
# Cycles' Fast GI.
WORLD_DISTANCE = 10.0


@value_node("ShaderNodeAmbientOcclusion")
def ambient_occlusion(view: NodeView, output: str) -> Register:
    """Ambient Occlusion, by rays from the point that is shaded."""
    emitter, node = view.emitter, view.node
    ints = [node.samples, int(node.inside), int(node.only_local)]
    distance = view.input("Distance")
    if not node.inputs["Distance"].is_linked and node.inputs["Distance"].default_value == 0.0:
        distance = emitter.scalar(WORLD_DISTANCE)
    share = emitter.operation("ambient_occlusion", [distance, view.normal("Normal")], ints)
    return share if output == "AO" else emitter.operation("vector_math", [view.input("Color"), share], text="MULTIPLY")


@value_node("ShaderNodeRaycast")
def raycast(view: NodeView, output: str) -> Register:
    """Raycast, since 5.1: what a ray from anywhere meets."""
    emitter, node = view.emitter, view.node
    position, direction = view.place("Position"), view.normal("Direction")
    if direction == UNCONNECTED:
        direction = emitter.operation("normal")
    operands, hit, normal = [position, direction, view.input("Length")], 0, 1
    if output == "Hit Normal":
        return emitter.operation("raycast", operands, [normal, int(node.only_local)])
    result = emitter.operation("raycast", operands, [hit, int(node.only_local)])
    if output in ("Is Hit", "Self Hit"):
        return emitter.component(result, ("Is Hit", "Self Hit").index(output))
    distance = emitter.component(result, 2)
    if output == "Hit Distance":
        return distance
    if output != "Hit Position":
        raise LookupError(f"the attribute {output} where the ray ends")
    way = emitter.operation("vector_math", [direction, distance, position], text="MULTIPLY_ADD")
    return emitter.operation("vector_math", [way, emitter.component(result, 0)], text="MULTIPLY")


@value_node("ShaderNodeLightFalloff")
def light_falloff(view: NodeView, output: str) -> Register:
    """Light Falloff, by the length of the ray; smoothed where it is short."""
    emitter = view.emitter
    length = emitter.operation("light_path", text="ray_length")
    strength, smooth = view.input("Strength"), view.input("Smooth")
    for _ in range(("Quadratic", "Linear", "Constant").index(output)):
        strength = emitter.math("MULTIPLY", strength, length)
    squared = emitter.math("MULTIPLY", length, length)
    limited = emitter.math("MAXIMUM", smooth, emitter.scalar(0.0))
    share = emitter.math("DIVIDE", squared, emitter.math("ADD", squared, limited))
    return emitter.math("MULTIPLY", strength, share)


@value_node("ShaderNodeParticleInfo")
def particle_info(view: NodeView, output: str) -> Register:
    """Particle Info, of instances that stand for particles."""
    return view.emitter.operation("attribute", ints=[view.resources.attribute(PARTICLE + output)])


@value_node("ShaderNodePointInfo")
def point_info(view: NodeView, output: str) -> Register:
    """Point Info: zero on what is no point cloud."""
    emitter, name = view.emitter, {"Position": POSITION, "Radius": RADIUS}.get(output, RANDOM)
    value = emitter.operation("attribute", ints=[view.resources.attribute(name)])
    if output == "Random":
        return emitter.component(value, 0)
    if output == "Radius":  # in the world, as Cycles measures it: along the object's diagonal
        across = emitter.operation("transform", [value], [_OBJECT, _WORLD], text="VECTOR")
        length = emitter.operation("vector_math", [across], text="LENGTH")
        return emitter.multiply(length, emitter.scalar(3.0**-0.5))
    is_point = emitter.operation("attribute", ints=[view.resources.attribute(IS_POINT)])
    place = emitter.operation("transform", [value], [_OBJECT, _WORLD], text="POINT")
    return emitter.operation("vector_math", [place, emitter.component(is_point, 0)], text="MULTIPLY")


@value_node("ShaderNodeFresnel")
def fresnel(view: NodeView, output: str) -> Register:
    """Fresnel."""
    return view.emitter.operation("fresnel", [view.input("IOR"), view.normal("Normal")])


@value_node("ShaderNodeLayerWeight")
def layer_weight(view: NodeView, output: str) -> Register:
    """Layer Weight."""
    return view.emitter.operation("layer_weight", [view.input("Blend"), view.normal("Normal")], text=output.upper())


def _radial_tangent(view: NodeView, axis: str) -> Register:
    view.resources.attribute(REST_PLACE)  # around the middle of the texture space
    return view.emitter.operation("radial_tangent", ints=["XYZ".index(axis)])


@value_node("ShaderNodeTangent")
def tangent(view: NodeView, output: str) -> Register:
    """Tangent: around an axis of the object, or along a UV map, on the surface."""
    node, emitter = view.node, view.emitter
    if node.direction_type == "RADIAL":
        return _radial_tangent(view, node.axis)
    name = text_of(node, "uv_map")
    identifier = view.resources.attribute(name) if name else view.resources.active_uv()
    known = view.resources.attribute(TANGENT_OF + name)
    along, normal = emitter.operation("tangent", ints=[identifier, known]), emitter.operation("normal")
    above = emitter.operation("vector_math", [along, normal], text="PROJECT")
    flat = emitter.operation("vector_math", [along, above], text="SUBTRACT")
    return emitter.operation("vector_math", [flat], text="NORMALIZE")


@value_node("ShaderNodeRGB")
def rgb(view: NodeView, output: str) -> Register:
    """RGB."""
    return view.emitter.constant(*view.node.outputs[0].default_value)


@value_node("ShaderNodeValue")
def value(view: NodeView, output: str) -> Register:
    """Value."""
    return view.emitter.scalar(view.node.outputs[0].default_value)
