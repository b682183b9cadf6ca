"""The nodes that test_nodes_oracle.py compares with Cycles, each with settings that show its differences."""

import itertools
from typing import Any, Callable

import bpy

from nodes_oracle_curves import curve_cases
from nodes_oracle_patterns import pattern_cases
from oracle_case import choices

# What a version of Blender does not have is left out.
_MATH = {
    1: "SQRT INVERSE_SQRT ABSOLUTE EXPONENT SIGN ROUND FLOOR CEIL TRUNC FRACT SINE COSINE TANGENT ARCSINE ARCCOSINE"
    " ARCTANGENT SINH COSH TANH RADIANS DEGREES",
    2: "ADD SUBTRACT MULTIPLY DIVIDE POWER LOGARITHM MINIMUM MAXIMUM LESS_THAN GREATER_THAN MODULO"
    " FLOORED_MODULO SNAP PINGPONG ARCTAN2",
    3: "MULTIPLY_ADD COMPARE SMOOTH_MIN SMOOTH_MAX WRAP",
}
_VECTOR_MATH = (
    "ADD SUBTRACT MULTIPLY DIVIDE MULTIPLY_ADD CROSS_PRODUCT PROJECT REFLECT REFRACT FACEFORWARD SCALE NORMALIZE ABSOLUTE"
    " MINIMUM MAXIMUM FLOOR CEIL FRACTION MODULO WRAP SNAP SINE COSINE TANGENT SIGN POWER ROUND"
)
_BLENDS = (
    "MIX DARKEN MULTIPLY BURN LIGHTEN SCREEN DODGE ADD OVERLAY SOFT_LIGHT LINEAR_LIGHT DIFFERENCE SUBTRACT DIVIDE HUE"
    " SATURATION COLOR VALUE EXCLUSION"
)


def _arithmetic(case: Callable[..., Any]) -> list[Any]:
    found = []
    for count, names in _MATH.items():
        for name in names.split():
            inputs = dict(zip(("Value", "Value_001", "Value_002"), ("x", "y", 0.7)[:count]))
            if name not in choices("ShaderNodeMath", "operation"):
                continue
            found.append(case("ShaderNodeMath", {"operation": name}, inputs))
    found.append(case("ShaderNodeMath", {"operation": "ADD", "use_clamp": True}, {"Value": "x", "Value_001": "y"}))
    for name in [name for name in _VECTOR_MATH.split() if name in choices("ShaderNodeVectorMath", "operation")]:
        inputs = {"Vector": "p", "Vector_001": (0.6, -0.7, 0.9), "Vector_002": (0.2, 0.4, -0.3), "Scale": 0.8}
        found.append(case("ShaderNodeVectorMath", {"operation": name}, inputs, "Vector"))
    for name in ("DOT_PRODUCT", "DISTANCE", "LENGTH"):
        inputs = {"Vector": "p", "Vector_001": (0.6, -0.7, 0.9)}
        found.append(case("ShaderNodeVectorMath", {"operation": name}, inputs, "Value"))
    for name in ("AXIS_ANGLE", "X_AXIS", "Y_AXIS", "Z_AXIS", "EULER_XYZ"):
        for invert in (False, True):
            inputs = {"Vector": "p", "Center": (0.3, -0.2, 0.5)}
            inputs |= {"Rotation": (0.3, -0.8, 1.9)} if name == "EULER_XYZ" else {"Angle": 0.7}
            inputs |= {"Axis": (0.3, 0.9, -0.4)} if name == "AXIS_ANGLE" else {}
            found.append(case("ShaderNodeVectorRotate", {"rotation_type": name, "invert": invert}, inputs))
    for name in ("MINMAX", "RANGE"):
        found.append(case("ShaderNodeClamp", {"clamp_type": name}, {"Value": "x", "Min": 0.5, "Max": -0.5}))
        found.append(case("ShaderNodeClamp", {"clamp_type": name}, {"Value": "x", "Min": -0.6, "Max": 0.9}))
    for name in ("LINEAR", "STEPPED", "SMOOTHSTEP", "SMOOTHERSTEP"):
        for clamp in (False, True):
            inputs = {"Value": "x", "From Min": -1.0, "From Max": 1.2, "To Min": 0.8, "To Max": -0.4}
            found.append(case("ShaderNodeMapRange", {"interpolation_type": name, "clamp": clamp}, inputs, "Result"))
            inputs = {"Vector": "p", "From_Min_FLOAT3": (-1.0, 0.2, -0.5), "From_Max_FLOAT3": (1.2, 1.5, 1.0)}
            inputs |= {
                "To_Min_FLOAT3": (0.8, -0.3, 0.0),
                "To_Max_FLOAT3": (-0.4, 0.9, 2.0),
                "Steps_FLOAT3": (3.0, 2.0, 5.0),
            }
            settings = {"data_type": "FLOAT_VECTOR", "interpolation_type": name, "clamp": clamp}
            found.append(case("ShaderNodeMapRange", settings, inputs, "Vector"))
    inputs = {"Value": "x", "From Min": -1.0, "From Max": 1.2, "Steps": 2.7}
    found.append(case("ShaderNodeMapRange", {"interpolation_type": "STEPPED"}, inputs, "Result"))
    for name in ("POINT", "TEXTURE", "VECTOR", "NORMAL"):
        inputs = {"Vector": "p", "Rotation": (0.3, -0.8, 1.9), "Scale": (1.3, 0.7, -0.5)}
        if name in ("POINT", "TEXTURE"):
            inputs["Location"] = (0.1, 0.2, -0.4)
        found.append(case("ShaderNodeMapping", {"vector_type": name}, inputs))
    return found


def _colors(case: Callable[..., Any]) -> list[Any]:
    found = []
    for name in [name for name in _BLENDS.split() if name in choices("ShaderNodeMixRGB", "blend_type")]:
        for fixed in ({"Color2": (0.2, 0.7, 0.4, 1)}, {"Color1": (0.9, 0.3, 0.1, 1)}):
            inputs = {"Fac": 0.6, "Color1": "p", "Color2": "p", **fixed}
            found.append(case("ShaderNodeMixRGB", {"blend_type": name}, inputs))
    found.append(case("ShaderNodeMixRGB", {"use_clamp": True}, {"Fac": "x", "Color1": "p"}))
    for mode in ("HSV", "HSL"):
        found += [case("ShaderNodeSeparateColor", {"mode": mode}, {"Color": "p"}, o) for o in ("Red", "Green", "Blue")]
        inputs = {"Red": "x", "Green": "y", "Blue": 0.6}
        found.append(case("ShaderNodeCombineColor", {"mode": mode}, inputs))
    found.append(case("ShaderNodeBlackbody", {}, {"Temperature": "kelvins"}))
    found.append(case("ShaderNodeWavelength", {}, {"Wavelength": "nanometres"}))
    found.append(case("ShaderNodeGamma", {}, {"Color": "p", "Gamma": 1.7}))
    found.append(case("ShaderNodeInvert", {}, {"Color": "p", "Fac": 0.8}))
    found.append(case("ShaderNodeBrightContrast", {}, {"Color": "p", "Bright": 0.3, "Contrast": 0.4}))
    inputs = {"Color": "p", "Hue": 0.3, "Saturation": 1.4, "Value": 0.8, "Fac": 0.9}
    found.append(case("ShaderNodeHueSaturation", {}, inputs))
    found.append(case("ShaderNodeRGBToBW", {}, {"Color": "p"}))
    return found


def _mixes(case: Callable[..., Any]) -> list[Any]:
    found, node = [], "ShaderNodeMix"
    for name in [name for name in _BLENDS.split() if name in choices(node, "blend_type")]:
        for fixed in ({"B_Color": (0.2, 0.7, 0.4, 1)}, {"A_Color": (0.9, 0.3, 0.1, 1)}):
            inputs = {"Factor_Float": 0.6, "A_Color": "p", "B_Color": "p", **fixed}
            found.append(case(node, {"data_type": "RGBA", "blend_type": name}, inputs, "Result_Color"))
    for clamp_factor in (False, True):
        clamped = {"clamp_factor": clamp_factor}
        for clamp_result in (False, True):
            settings = {"data_type": "RGBA", **clamped, "clamp_result": clamp_result}
            found.append(case(node, settings, {"Factor_Float": "x", "A_Color": "p"}, "Result_Color"))
        numbers = {"Factor_Float": "x", "A_Float": "y", "B_Float": 0.7}
        found.append(case(node, {"data_type": "FLOAT", **clamped}, numbers, "Result_Float"))
        settings = {"data_type": "VECTOR", **clamped}
        vectors = {"A_Vector": "p", "B_Vector": (0.2, 0.7, -0.4)}
        found.append(case(node, settings, {**vectors, "Factor_Float": "x"}, "Result_Vector"))
        uneven = {**settings, "factor_mode": "NON_UNIFORM"}
        found.append(case(node, uneven, {**vectors, "Factor_Vector": (0.3, 1.4, -0.5)}, "Result_Vector"))
    return found


def _textures(case: Callable[..., Any], make_image: Callable[[str], Any]) -> list[Any]:
    found = []
    # Cycles interpolates sRGB numbers and decodes the result; the core decodes first. So sRGB is compared at pixels only.
    for space, interpolations in (("sRGB", ("Closest",)), ("Non-Color", ("Linear", "Closest", "Cubic", "Smart"))):
        image = make_image(space)
        for interpolation in interpolations:
            for extension in choices("ShaderNodeTexImage", "extension"):
                settings = {"image": image, "interpolation": interpolation, "extension": extension}
                found.append(case("ShaderNodeTexImage", settings, {"Vector": "p"}, "Color"))
    for projection in ("EQUIRECTANGULAR", "MIRROR_BALL"):
        for interpolation in ("Linear", "Closest", "Cubic", "Smart"):
            settings = {"projection": projection, "interpolation": interpolation, "image": make_image("Non-Color")}
            found.append(case("ShaderNodeTexEnvironment", settings, {"Vector": "p"}))
    for space in ("OBJECT", "WORLD", "BLENDER_OBJECT", "BLENDER_WORLD"):
        inputs = {"Color": (0.3, 0.8, 0.9, 1), "Strength": 0.7}
        found.append(case("ShaderNodeNormalMap", {"space": space}, inputs))
    found.append(case("ShaderNodeFresnel", {}, {"IOR": "x"}))
    found += [case("ShaderNodeLayerWeight", {}, {"Blend": "x"}, output) for output in ("Fresnel", "Facing")]
    settings = {"image": make_image("Non-Color", alpha=True), "interpolation": "Linear"}
    found += [case("ShaderNodeTexImage", settings, {"Vector": "p"}, output) for output in ("Color", "Alpha")]
    return found


def _skies(case: Callable[..., Any]) -> list[Any]:
    """All models, the sun high, low, below the horizon and behind the zenith; its disc: test_sky_oracle.py."""
    looked, found = {"Vector": "direction"}, []
    for sun, turbidity in (((0.3, 0.2, 0.9), 2.2), ((0.9, 0.1, 0.2), 5.0)):
        settings = {"sky_type": "PREETHAM", "sun_direction": sun, "turbidity": turbidity}
        found.append(case("ShaderNodeTexSky", settings, looked))
    for turbidity, albedo, sun in (
        (3.0, 1.0, (0.3, 0.2, 0.9)),
        (6.0, 0.0, (-0.6, 0.5, 0.1)),
        (2.2, 0.3, (0.1, 0.7, 0.6)),
        (7.5, 0.8, (0.1, -0.7, -0.1)),
    ):
        settings = {"sky_type": "HOSEK_WILKIE", "turbidity": turbidity, "ground_albedo": albedo, "sun_direction": sun}
        found.append(case("ShaderNodeTexSky", settings, looked))
    # Names of 3 and of 5.
    kinds, dust = (
        (["NISHITA"], "dust_density")
        if bpy.app.version < (5, 0, 0)
        else (["SINGLE_SCATTERING", "MULTIPLE_SCATTERING"], "aerosol_density")
    )
    for kind, more in itertools.product(
        kinds,
        (
            {"sun_elevation": 0.26, "sun_rotation": 1.9},
            {"sun_elevation": 1.2, "sun_rotation": -0.7, "air_density": 2.0, dust: 4.0, "ozone_density": 3.0},
            {"sun_elevation": 0.02, "altitude": 3000.0},
            {"sun_elevation": -0.05},
            {"sun_elevation": 2.6, "sun_rotation": 0.4},
        ),
    ):
        found.append(case("ShaderNodeTexSky", {"sky_type": kind, "sun_disc": False, **more}, looked))
    return found


def all_cases(case: Callable[..., Any], make_image: Callable[[str], Any]) -> list[Any]:
    """Every case; `case` makes one, `make_image` a small picture of a colour space."""
    own = _arithmetic(case) + _colors(case) + _mixes(case) + _textures(case, make_image) + _skies(case)
    return own + pattern_cases(case) + curve_cases(case)
