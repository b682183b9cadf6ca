"""Nodes with curves, ramps and values of their own, and those that take colours and vectors apart, that test_nodes_oracle.py
compares with Cycles."""

from itertools import product
from typing import Any, Callable

Make = Callable[..., Any]
_INTERPOLATIONS = ("LINEAR", "CONSTANT", "EASE", "CARDINAL", "B_SPLINE")
_HUES = ("NEAR", "FAR", "CW", "CCW")


def bent(node: Any) -> None:
    """Curves that are not straight, each another one."""
    for number, curve in enumerate(node.mapping.curves):
        first, last = curve.points[0], curve.points[-1]
        first.location = (first.location[0] + 0.05 + 0.03 * number, first.location[1] + 0.1)
        last.location = (last.location[0], last.location[1] - 0.15)
        curve.points.new(0.35 + 0.1 * number, 0.7 - 0.1 * number)
    node.mapping.update()


def cornered(node: Any) -> None:
    """Curves with a corner."""
    bent(node)
    for curve in node.mapping.curves:
        for point in curve.points:
            point.handle_type = "VECTOR"
    node.mapping.update()


def colored(node: Any) -> None:
    """A ramp of three colours, of which one is half transparent."""
    elements = node.color_ramp.elements
    elements[0].color, elements[0].position = (0.9, 0.2, 0.1, 0.4), 0.1
    elements[1].color, elements[1].position = (0.1, 0.3, 0.8, 1.0), 0.9
    elements.new(0.4).color = (0.2, 0.8, 0.3, 0.9)


def valued(node: Any) -> None:
    """Another value of the output."""
    value = (0.2, 0.7, 0.4, 1.0) if node.outputs[0].type == "RGBA" else 1.75
    node.outputs[0].default_value = value


def directed(node: Any) -> None:
    """Another direction."""
    node.outputs["Normal"].default_value = (0.48, -0.6, 0.64)


def _curves(case: Make) -> list[Any]:
    found = []
    for kind, source in (("RGB", "Color"), ("Vector", "Vector"), ("Float", "Value")):
        node, factor = f"ShaderNode{kind}Curve", "Factor" if kind == "Float" else "Fac"
        linked = {source: "x" if kind == "Float" else "p"}
        for extend, clip in product(("HORIZONTAL", "EXTRAPOLATED"), (False, True)):
            settings = {"mapping.extend": extend, "mapping.use_clip": clip}
            found.append(case(node, settings, linked, shape=bent))
        found.append(case(node, {"mapping.tone": "FILMLIKE"}, linked, shape=bent))
        found.append(case(node, {}, {**linked, factor: 0.6}, shape=cornered))
    return found


def _ramps(case: Make) -> list[Any]:
    node, linked = "ShaderNodeValToRGB", {"Fac": "x"}
    modes = [{"color_ramp.interpolation": name} for name in _INTERPOLATIONS]
    modes += [
        {"color_ramp.color_mode": mode, "color_ramp.hue_interpolation": hue} for mode in ("HSV", "HSL") for hue in _HUES
    ]
    found = [case(node, settings, linked, output, shape=colored) for settings in modes for output in ("Color", "Alpha")]
    return found


def _values(case: Make) -> list[Any]:
    found = [case(f"ShaderNode{kind}", shape=valued) for kind in ("RGB", "Value")]
    return found + [
        case("ShaderNodeNormal", {}, {"Normal": "p"}, output, shape=directed) for output in ("Normal", "Dot")
    ]


def _parts(case: Make) -> list[Any]:
    """Including the nodes of files from before 3.3."""
    found = []
    for kind, source, outputs in (("RGB", "Image", "RGB"), ("HSV", "Color", "HSV"), ("XYZ", "Vector", "XYZ")):
        found += [case(f"ShaderNodeSeparate{kind}", {}, {source: "direction"}, output) for output in outputs]
        found.append(case(f"ShaderNodeCombine{kind}", {}, dict(zip(outputs, ("x", "y", 0.6)))))
    found += [
        case("ShaderNodeSeparateColor", {"mode": "RGB"}, {"Color": "direction"}, o) for o in ("Red", "Green", "Blue")
    ]
    found.append(case("ShaderNodeCombineColor", {"mode": "RGB"}, {"Red": "x", "Green": "y", "Blue": 0.6}))
    return found


def curve_cases(case: Make) -> list[Any]:
    """All of them."""
    return _curves(case) + _ramps(case) + _values(case) + _parts(case)
