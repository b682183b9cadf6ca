"""Nodes that calculate: Math, Vector Math, Map Range, Clamp, Mapping, and the vector nodes."""

from ...names import text_of
from ...cycles_versions import strength_scales_slopes, transforms_normals
from ..mesh_derived import TANGENT_OF
from .compiler import NodeView, value_node
from .curves import number_curve, vector_curves
from .emitter import UNCONNECTED, Emitter, Register

# Vector Math operations by the inputs they read.
_UNARY = {"NORMALIZE", "LENGTH", "ABSOLUTE", "FLOOR", "CEIL", "FRACTION", "SINE", "COSINE", "TANGENT", "SIGN", "ROUND"}
_TERNARY = {"MULTIPLY_ADD", "FACEFORWARD", "WRAP"}
_SCALED = {"SCALE", "REFRACT"}
_LEAST_FILTER_WIDTH = 1e-3  # of Bump, pixels: below, single precision sees no difference of heights


@value_node("ShaderNodeMath")
def math(view: NodeView, output: str) -> Register:
    """Math; the inputs that the operation hides are left out."""
    used = [socket.identifier for socket in view.node.inputs if socket.enabled]
    operands = [view.input(identifier) for identifier in used]
    return view.emitter.operation("math", operands, [int(view.node.use_clamp)], text=view.node.operation)


@value_node("ShaderNodeVectorMath")
def vector_math(view: NodeView, output: str) -> Register:
    """Vector Math."""
    operation = view.node.operation
    a = view.input("Vector")
    b = UNCONNECTED if operation in _UNARY or operation == "SCALE" else view.input("Vector_001")
    c = view.input("Vector_002") if operation in _TERNARY else UNCONNECTED
    scale = view.input("Scale") if operation in _SCALED else UNCONNECTED
    return view.emitter.operation("vector_math", [a, b, c, scale], text=operation)


@value_node("ShaderNodeClamp")
def clamp(view: NodeView, output: str) -> Register:
    """Clamp."""
    operands = [view.input("Value"), view.input("Min"), view.input("Max")]
    return view.emitter.operation("clamp", operands, text=view.node.clamp_type)


@value_node("ShaderNodeMapRange")
def map_range(view: NodeView, output: str) -> Register:
    """Map Range, of numbers or per component of vectors."""
    node, emitter = view.node, view.emitter
    ints, text = [int(node.clamp)], node.interpolation_type
    stepped = text == "STEPPED"
    if node.data_type == "FLOAT":
        names = ["Value", "From Min", "From Max", "To Min", "To Max"] + (["Steps"] if stepped else [])
        return emitter.operation("map_range", [view.input(name) for name in names], ints, text=text)
    names = ["Vector", "From_Min_FLOAT3", "From_Max_FLOAT3", "To_Min_FLOAT3", "To_Max_FLOAT3"]
    vectors = [view.input(name) for name in names + (["Steps_FLOAT3"] if stepped else [])]
    parts = [
        emitter.operation("map_range", [emitter.component(v, axis) for v in vectors], ints, text=text)
        for axis in range(3)
    ]
    return emitter.operation("combine", parts)


@value_node("ShaderNodeMapping")
def mapping(view: NodeView, output: str) -> Register:
    """Mapping."""
    zero = view.emitter.constant(0, 0, 0)
    # Vectors and normals are not moved: their node has no Location.
    location = zero if view.node.vector_type in ("VECTOR", "NORMAL") else view.input("Location")
    operands = [view.input("Vector"), location, view.input("Rotation"), view.input("Scale")]
    return view.emitter.operation("mapping", operands, text=view.node.vector_type)


@value_node("ShaderNodeVectorRotate")
def vector_rotate(view: NodeView, output: str) -> Register:
    """Vector Rotate; the inputs that its type hides are left out."""
    kind, zero = view.node.rotation_type, view.emitter.scalar(0.0)
    euler = kind == "EULER_XYZ"
    operands = [
        view.input("Vector"),
        view.input("Center"),
        view.input("Axis") if kind == "AXIS_ANGLE" else zero,
        zero if euler else view.input("Angle"),
        view.input("Rotation") if euler else zero,
    ]
    return view.emitter.operation("vector_rotate", operands, [int(view.node.invert)], text=kind)


@value_node("ShaderNodeVectorTransform")
def vector_transform(view: NodeView, output: str) -> Register:
    """Vector Transform."""
    node, spaces = view.node, ("WORLD", "OBJECT", "CAMERA")
    if "LIGHT" in (node.convert_from, node.convert_to):  # 5.3
        view.warn("spaces of lights are not supported; rendered unchanged")
        return view.input("Vector")
    ints = [spaces.index(node.convert_from), spaces.index(node.convert_to), *([1] if transforms_normals() else [])]
    return view.emitter.operation("transform", [view.input("Vector")], ints, text=node.vector_type)


@value_node("ShaderNodeBump")
def bump(view: NodeView, output: str) -> Register:
    """Bump."""
    _set_filter_width(view)
    height = view.linked("Height")
    if height == UNCONNECTED:  # as high everywhere
        normal = view.normal("Normal")
        return view.emitter.operation("normal") if normal == UNCONNECTED else normal
    operands = [height, view.input("Strength"), view.input("Distance"), view.normal("Normal")]
    return view.emitter.operation("bump", operands, [int(view.node.invert)])


def _set_filter_width(view: NodeView) -> None:
    """Since 4.5. Cycles reads the socket's own value, whatever is linked to it."""
    socket = view.socket("Filter Width")
    if socket is None:
        return
    taken = view.emitter.take_bump_width(max(float(socket.default_value), _LEAST_FILTER_WIDTH))
    if abs(taken - socket.default_value) > _LEAST_FILTER_WIDTH:
        view.warn(f"all bumps of a material share one Filter Width; {taken:.3g} is used")


@value_node("ShaderNodeBevel")
def bevel(view: NodeView, output: str) -> Register:
    """Bevel: the mean of the normals within the radius, by rays."""
    return view.emitter.operation("bevel", [view.input("Radius"), view.normal("Normal")], [view.node.samples])


@value_node("ShaderNodeNormalMap")
def normal_map(view: NodeView, output: str) -> Register:
    """Normal Map. In Blender's own spaces, those of its former renderer's baked maps, Y and Z point the other way."""
    emitter, color = view.emitter, view.input("Color")
    space = view.node.space.removeprefix("BLENDER_")
    if getattr(view.node, "base", "DISPLACED") != "DISPLACED":  # 5.1
        view.warn(
            "a normal map that is relative to the surface before its displacement is taken as relative to what it is then"
        )
    of_blender = space != view.node.space
    is_downward = getattr(view.node, "convention", "OPENGL") == "DIRECTX"  # 5.1
    if of_blender or is_downward:
        red, green, blue = (emitter.component(color, index) for index in range(3))
        green = green if of_blender and is_downward else emitter.complement(green)
        color = emitter.operation("combine", [red, green, emitter.complement(blue) if of_blender else blue])
    ints, strength = [-1], view.input("Strength")
    if space == "TANGENT":
        name = text_of(view.node, "uv_map")
        identifier = view.resources.attribute(name) if name else view.resources.active_uv()
        ints = [identifier, view.resources.attribute(TANGENT_OF + name)]
        if strength_scales_slopes() and emitter.value_of(strength) != (1.0,) * 4:
            color, strength = _with_slopes_scaled(emitter, color, strength), emitter.scalar(1.0)
    return emitter.operation("normal_map", [strength, color], ints, text=space)


def _with_slopes_scaled(emitter: Emitter, color: Register, strength: Register) -> Register:
    """The colour of a normal whose X and Y are `strength` times those of `color`. Of a strength below 1, Z nears 1."""
    share = emitter.saturate(strength)
    middle = emitter.multiply(emitter.scalar(0.5), emitter.complement(strength))  # where no slope stays
    scale = emitter.operation("combine", [strength, strength, share])
    offset = emitter.operation("combine", [middle, middle, emitter.complement(share)])
    return emitter.operation("vector_math", [color, scale, offset], text="MULTIPLY_ADD")


@value_node("ShaderNodeNormal")
def normal(view: NodeView, output: str) -> Register:
    """Normal: a fixed direction, and its cosine with the input."""
    emitter = view.emitter
    direction = emitter.constant(*view.node.outputs["Normal"].default_value)
    if output == "Normal":
        return direction
    unit = emitter.operation("vector_math", [view.input("Normal")], text="NORMALIZE")
    return emitter.operation("vector_math", [direction, unit], text="DOT_PRODUCT")


@value_node("ShaderNodeVectorCurve")
def vector_curve(view: NodeView, output: str) -> Register:
    """Vector Curves, one per component."""
    vector = view.input("Vector")
    result = vector_curves(view, vector)
    return view.emitter.operation("mix", [view.input("Fac", "Factor"), vector, result], [1, 0], text="MIX")


@value_node("ShaderNodeFloatCurve")
def float_curve(view: NodeView, output: str) -> Register:
    """Float Curve."""
    value = view.input("Value")
    result = number_curve(view, value)
    return view.emitter.operation("mix", [view.input("Factor", "Fac"), value, result], [1, 0], text="MIX")


@value_node("ShaderNodeSeparateXYZ")
def separate_xyz(view: NodeView, output: str) -> Register:
    """Separate XYZ."""
    return view.emitter.component(view.input("Vector"), "XYZ".index(output))


@value_node("ShaderNodeCombineXYZ")
def combine_xyz(view: NodeView, output: str) -> Register:
    """Combine XYZ."""
    return view.emitter.operation("combine", [view.input("X"), view.input("Y"), view.input("Z")])
