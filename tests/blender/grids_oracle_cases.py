"""Volumes of grids that test_grids_oracle.py compares with Cycles."""

from dataclasses import dataclass, field
from typing import Any


@dataclass
class Cloud:
    """A case: the inputs of a Principled Volume, or another shader, on a Volume object, and where that is. A value that is a
    tuple of texts is a node and its output; nodes' own names are in grids_oracle.py."""

    inputs: dict[str, Any]
    shader: str = "VolumePrincipled"
    space: str = "OBJECT"
    scale: float = 1.0
    made: bool = False  # by a modifier, of a mesh
    material: bool = True
    camera_inside: bool = False
    clip_start: float = 0.001
    frame: int = 1  # of a sequence
    settings: dict[str, Any] = field(default_factory=dict)


SMOKE = {"Density": 4.0, "Color": (0.6, 0.5, 0.4, 1), "Absorption Color": (0.2, 0.1, 0.3, 1)}
GLOW = {"Emission Strength": 0.15, "Emission Color": (0.2, 0.5, 0.9, 1)}
FIRE = {"Blackbody Intensity": 0.8, "Temperature": 1.0, "Density": 2.0}

CASES = {
    "smoke": Cloud(SMOKE),
    "coloured smoke": Cloud({**SMOKE, "Color Attribute": "color"}),
    "smoke that glows": Cloud({**SMOKE, **GLOW}),
    "fire": Cloud(FIRE),
    "smoke of a larger object": Cloud(SMOKE, scale=1.4),
    "smoke by the world's unit": Cloud(SMOKE, scale=1.4, space="WORLD"),
    "several bounces": Cloud({**SMOKE, "Anisotropy": 0.4}, settings={"volume_bounces": 4}),
    "scattering by an attribute": Cloud({"Density": ("AttributeDensity", "Fac")}, shader="VolumeScatter"),
    "absorption by an attribute": Cloud(
        {"Density": ("AttributeDensity", "Fac"), "Color": ("AttributeColor", "Color")}, shader="VolumeAbsorption"
    ),
    "volume info": Cloud({"Density": ("Info", "Density"), "Color": ("Info", "Color")}, shader="VolumeScatter"),
    "a ramp over the density": Cloud({"Density": ("Ramp", "Color"), "Density Attribute": ""}),
    "flames by volume info": Cloud({"Strength": ("Info", "Flame"), "Color": (0.9, 0.4, 0.1, 1)}, shader="Emission"),
    "heat by volume info": Cloud({**FIRE, "Temperature": ("Info", "Temperature"), "Temperature Attribute": ""}),
    "emission alone": Cloud({"Strength": ("Info", "Density"), "Color": (0.3, 0.5, 0.9, 1)}, shader="Emission"),
    "without a material": Cloud({}, material=False),
    "made by a modifier": Cloud(SMOKE, made=True),
    "seen from inside": Cloud({**SMOKE, "Density": 1.0}, camera_inside=True),
    "seen from inside, the nearest clipped": Cloud({**SMOKE, "Density": 1.0}, camera_inside=True, clip_start=0.3),
    "a frame of a sequence": Cloud(SMOKE, frame=2),
}
