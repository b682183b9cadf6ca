"""Materials and worlds with volumes that test_volume_oracle.py compares with Cycles."""

from dataclasses import dataclass, field
from typing import Any

import bpy


@dataclass
class Volume:
    """A case: nodes of the body's surface and volume, and of the world's volume. A shader is a tuple of the node's name
    without ShaderNode, and its inputs; an input is a value, the name of a texture, or another such tuple."""

    surface: Any = None
    volume: Any = None
    world: Any = None
    inner: Any = None  # a volume in a smaller body inside
    settings: dict[str, Any] = field(default_factory=dict)  # of the scene's light paths, for both engines
    camera_inside: bool = False
    shape: str = "cube"


GLASS = ("BsdfGlass", {"Roughness": 0.0, "IOR": 1.4})
TINT = ("VolumeAbsorption", {"Color": (0.2, 0.6, 0.9, 1), "Density": 1.2})
FOG = ("VolumeScatter", {"Color": (0.9, 0.6, 0.3, 1), "Density": 0.8, "Anisotropy": 0.0})
PRINCIPLED = {"Color": (0.7, 0.5, 0.3, 1), "Density": 1.1, "Anisotropy": 0.3, "Absorption Color": (0.4, 0.1, 0.6, 1)}
GLOW = {"Emission Strength": 0.4, "Emission Color": (0.2, 0.5, 0.9, 1)}
FIRE = {"Blackbody Intensity": 0.9, "Blackbody Tint": (1, 0.8, 0.7, 1), "Temperature": 1900.0, "Density": 0.3}

# Of a surface's node the glow alone fills a body.
GLOW_OF_SURFACE = {"Emission": GLOW["Emission Color"], "Emission Strength": 0.5, "Alpha": 0.8}
UP_TO_3 = (
    {"a surface's principled": Volume(None, ("BsdfPrincipled", GLOW_OF_SURFACE))} if bpy.app.version < (4, 0, 0) else {}
)

# Since 4.3. Mie's goes by other formulas for smaller droplets. Its peak is noisy, so that there is little of it.
PHASES = {
    "FOURNIER_FORAND": {"IOR": 1.5, "Backscatter": 0.2},
    "DRAINE": {"Anisotropy": 0.5, "Alpha": 3.0},
    "RAYLEIGH": {},
    "MIE": {"Diameter": 8.0},
}
DROPLETS = (0.08, 1.0, 3.0)


def scattering_by(phase, **inputs):
    return Volume(None, ("VolumeScatter", {"phase": phase, **inputs, "Color": FOG[1]["Color"]}))


SINCE_4_3 = (
    {
        **{f"phase {name}": scattering_by(name, **inputs, Density=0.3) for name, inputs in PHASES.items()},
        **{f"droplets of {size}": scattering_by("MIE", Diameter=size, Density=0.3) for size in DROPLETS},
    }
    if "phase" in bpy.types.ShaderNodeVolumeScatter.bl_rna.properties
    else {}
)
COEFFICIENTS = {
    **{"Absorption Coefficients": (0.3, 0.6, 0.1), "Scatter Coefficients": (0.4, 0.5, 0.8), "Anisotropy": 0.3},
    "Emission Coefficients": (0.05, 0.02, 0.1),
}
SINCE_4_5 = (
    {
        "coefficients": Volume(None, ("VolumeCoefficients", COEFFICIENTS)),
        **{
            f"coefficients, {name}": Volume(
                None, ("VolumeCoefficients", {"phase": name, **inputs, "Scatter Coefficients": (0.2, 0.3, 0.4)})
            )
            for name, inputs in PHASES.items()
        },
    }
    if hasattr(bpy.types, "ShaderNodeVolumeCoefficients")
    else {}
)

CASES = {
    "tinted glass": Volume(GLASS, TINT),
    "a ball of tinted glass": Volume(GLASS, TINT, shape="ball"),
    "tinted translucent skin": Volume(("BsdfTranslucent", {"Color": (0.8, 0.8, 0.8, 1)}), TINT),
    "absorption": Volume(None, TINT),
    "scattering": Volume(None, FOG),
    "scattering forwards": Volume(None, ("VolumeScatter", {**FOG[1], "Anisotropy": 0.7})),
    "scattering backwards": Volume(None, ("VolumeScatter", {**FOG[1], "Anisotropy": -0.6, "Density": 2.0})),
    "milky glass": Volume(GLASS, FOG),
    "several bounces": Volume(None, ("VolumeScatter", {**FOG[1], "Density": 4.0}), settings={"volume_bounces": 5}),
    "emission": Volume(None, ("Emission", {"Color": (0.2, 0.5, 0.9, 1), "Strength": 0.4})),
    "principled": Volume(None, ("VolumePrincipled", PRINCIPLED)),
    "principled, glowing": Volume(None, ("VolumePrincipled", {**PRINCIPLED, **GLOW})),
    "principled, burning": Volume(None, ("VolumePrincipled", FIRE)),
    **UP_TO_3,
    **SINCE_4_3,
    **SINCE_4_5,
    "a mixture": Volume(None, ("MixShader", {0: 0.3, 1: TINT, 2: FOG})),
    "a glowing mixture": Volume(
        None, ("MixShader", {0: 0.3, 1: ("VolumePrincipled", {**PRINCIPLED, **GLOW}), 2: TINT})
    ),
    "a sum": Volume(None, ("AddShader", {0: TINT, 1: FOG})),
    "uneven absorption": Volume(None, ("VolumeAbsorption", {**TINT[1], "Density": "noise"})),
    "uneven tint in glass": Volume(GLASS, ("VolumeAbsorption", {"Density": 1.0, "Color": "colors"})),
    "uneven scattering": Volume(None, ("VolumeScatter", {**FOG[1], "Density": "noise"})),
    "uneven glow": Volume(None, ("VolumePrincipled", {**PRINCIPLED, **GLOW, "Density": "gradient"})),
    "one in another": Volume(GLASS, TINT, inner=FOG),
    "a world of mist": Volume(("BsdfDiffuse", {}), None, ("VolumeScatter", {**FOG[1], "Density": 0.05})),
    "a dark world": Volume(("BsdfDiffuse", {}), None, ("VolumeAbsorption", {**TINT[1], "Density": 0.1})),
    "a world of uneven mist": Volume(("BsdfDiffuse", {}), None, ("VolumeScatter", {**FOG[1], "Density": "faint"})),
    "seen from inside": Volume(None, ("VolumeScatter", {**FOG[1], "Density": 0.15}), camera_inside=True),
}
