"""Nodes that turn colours: mixing, separating, adjusting, ramps."""

from .compiler import NodeView, value_node
from .curves import color_curves, ramp_table
from .emitter import Register


@value_node("ShaderNodeMixRGB")
def mix_rgb(view: NodeView, output: str) -> Register:
    """The Mix node of colours before 3.4; files keep it."""
    operands = [view.input("Fac"), view.input("Color1"), view.input("Color2")]
    return view.emitter.operation("mix", operands, [1, int(view.node.use_clamp)], text=view.node.blend_type)


@value_node("ShaderNodeMix")
def mix(view: NodeView, output: str) -> Register:
    """The Mix node of numbers, vectors and colours. Each type has sockets of its own."""
    node = view.node
    suffix = {"FLOAT": "Float", "VECTOR": "Vector", "RGBA": "Color", "ROTATION": "Rotation"}[node.data_type]
    uneven = node.data_type == "VECTOR" and node.factor_mode == "NON_UNIFORM"
    factor = view.input("Factor_Vector" if uneven else "Factor_Float")
    ints = [int(node.clamp_factor), int(node.data_type == "RGBA" and node.clamp_result)]
    blend = node.blend_type if node.data_type == "RGBA" else "MIX"
    return view.emitter.operation(
        "mix", [factor, view.input(f"A_{suffix}"), view.input(f"B_{suffix}")], ints, text=blend
    )


def _separate(view: NodeView, color: Register, mode: str, index: int) -> Register:
    if mode != "RGB":
        color = view.emitter.operation(f"rgb_to_{mode.lower()}", [color])
    return view.emitter.component(color, index)


def _combine(view: NodeView, parts: list[Register], mode: str) -> Register:
    color = view.emitter.operation("combine", parts)
    return color if mode == "RGB" else view.emitter.operation(f"{mode.lower()}_to_rgb", [color])


@value_node("ShaderNodeSeparateColor")
def separate_color(view: NodeView, output: str) -> Register:
    """Separate Color."""
    return _separate(view, view.input("Color"), view.node.mode, ("Red", "Green", "Blue").index(output))


@value_node("ShaderNodeSeparateRGB")
def separate_rgb(view: NodeView, output: str) -> Register:
    """Separate RGB."""
    return _separate(view, view.input("Image"), "RGB", "RGB".index(output))


@value_node("ShaderNodeSeparateHSV")
def separate_hsv(view: NodeView, output: str) -> Register:
    """Separate HSV."""
    return _separate(view, view.input("Color"), "HSV", "HSV".index(output))


@value_node("ShaderNodeCombineColor")
def combine_color(view: NodeView, output: str) -> Register:
    """Combine Color."""
    return _combine(view, [view.input(name) for name in ("Red", "Green", "Blue")], view.node.mode)


@value_node("ShaderNodeCombineRGB")
def combine_rgb(view: NodeView, output: str) -> Register:
    """Combine RGB."""
    return _combine(view, [view.input(name) for name in "RGB"], "RGB")


@value_node("ShaderNodeCombineHSV")
def combine_hsv(view: NodeView, output: str) -> Register:
    """Combine HSV."""
    return _combine(view, [view.input(name) for name in "HSV"], "HSV")


@value_node("ShaderNodeGamma")
def gamma(view: NodeView, output: str) -> Register:
    """Gamma."""
    return view.emitter.operation("gamma", [view.input("Color"), view.input("Gamma")])


@value_node("ShaderNodeInvert")
def invert(view: NodeView, output: str) -> Register:
    """Invert."""
    return view.emitter.operation("invert", [view.input("Fac", "Factor"), view.input("Color")])


@value_node("ShaderNodeBrightContrast")
def bright_contrast(view: NodeView, output: str) -> Register:
    """Brightness and Contrast."""
    operands = [view.input("Color"), view.input("Bright", "Brightness"), view.input("Contrast")]
    return view.emitter.operation("bright_contrast", operands)


@value_node("ShaderNodeHueSaturation")
def hue_saturation(view: NodeView, output: str) -> Register:
    """Hue, Saturation, Value."""
    operands = [view.input(name) for name in ("Hue", "Saturation", "Value", "Fac", "Color")]
    return view.emitter.operation("hue_saturation", operands)


@value_node("ShaderNodeRGBToBW")
def rgb_to_bw(view: NodeView, output: str) -> Register:
    """RGB to BW."""
    return view.emitter.operation("luminance", [view.input("Color")])


@value_node("ShaderNodeBlackbody")
def blackbody(view: NodeView, output: str) -> Register:
    """Blackbody."""
    return view.emitter.operation("blackbody", [view.input("Temperature")])


@value_node("ShaderNodeWavelength")
def wavelength(view: NodeView, output: str) -> Register:
    """Wavelength."""
    return view.emitter.operation("wavelength", [view.input("Wavelength")])


@value_node("ShaderNodeRGBCurve")
def rgb_curves(view: NodeView, output: str) -> Register:
    """RGB Curves."""
    color = view.input("Color")
    result = color_curves(view, color)
    return view.emitter.operation("mix", [view.input("Fac", "Factor"), color, result], [1, 0], text="MIX")


@value_node("ShaderNodeValToRGB")
def color_ramp(view: NodeView, output: str) -> Register:
    """Color Ramp."""
    floats, interpolate = ramp_table(view.node.color_ramp)
    result = view.emitter.operation("table", [view.input("Fac", "Factor")], [interpolate], floats)
    return view.emitter.component(result, 3) if output == "Alpha" else result
