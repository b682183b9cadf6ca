"""The textures that test_nodes_oracle.py compares with Cycles: every mode, every socket."""

from itertools import product
from typing import Any, Callable

import bpy
from oracle_case import choices

Make = Callable[..., Any]
_DIMENSIONS = ("1D", "2D", "3D", "4D")


def _coordinates(dimensions: str) -> dict[str, Any]:
    """Links for a texture of so many dimensions."""
    vector = {} if dimensions == "1D" else {"Vector": "p"}
    return vector | ({"W": "x"} if dimensions == "1D" else {"W": "y"} if dimensions == "4D" else {})


def _noise(case: Make) -> list[Any]:
    found = []
    for dimensions in _DIMENSIONS:
        for detail, roughness, distortion in ((0.0, 0.5, 0.0), (2.0, 0.5, 0.0), (3.6, 0.7, 0.0), (2.0, 0.5, 1.3)):
            inputs = {"Scale": 1.7, "Detail": detail, "Roughness": roughness, "Distortion": distortion}
            inputs |= _coordinates(dimensions)
            found.append(case("ShaderNodeTexNoise", {"noise_dimensions": dimensions}, inputs, "Color"))
        inputs = _coordinates(dimensions)
        for output in ("Value", "Color"):
            found.append(case("ShaderNodeTexWhiteNoise", {"noise_dimensions": dimensions}, inputs, output))
    found.append(case("ShaderNodeTexNoise", {}, {"Vector": "p", "Scale": 3.0}, "Fac"))
    return found


def _fractal_noise(case: Make) -> list[Any]:
    """Since 4.1, where Musgrave's textures became types of noise."""
    found = []
    for kind, dimensions in product(choices("ShaderNodeTexNoise", "noise_type"), _DIMENSIONS):
        settings = {"noise_type": kind, "noise_dimensions": dimensions}
        inputs = {"Scale": 1.3, "Detail": 2.6, "Roughness": 0.7, "Lacunarity": 2.3, **_coordinates(dimensions)}
        inputs |= {"Offset": 0.7, "Gain": 1.7} if kind not in ("MULTIFRACTAL", "FBM") else {}
        found.append(case("ShaderNodeTexNoise", settings, inputs, "Color"))
        found.append(case("ShaderNodeTexNoise", {**settings, "normalize": False}, inputs, "Fac"))
    return found


def _musgrave(case: Make) -> list[Any]:
    found = []
    kinds = ("MULTIFRACTAL", "RIDGED_MULTIFRACTAL", "HYBRID_MULTIFRACTAL", "FBM", "HETERO_TERRAIN")
    for kind, dimensions in product(kinds, _DIMENSIONS):
        settings = {"musgrave_type": kind, "musgrave_dimensions": dimensions}
        more = {"Offset": 0.7} if kind not in ("MULTIFRACTAL", "FBM") else {}
        more |= {"Gain": 1.7} if kind in ("RIDGED_MULTIFRACTAL", "HYBRID_MULTIFRACTAL") else {}
        for detail, dimension, lacunarity in ((2.0, 2.0, 2.0), (3.6, 0.8, 2.3), (0.4, 1.0, 2.0), (5.0, 0.0, 0.0)):
            inputs = {"Scale": 1.3, "Detail": detail, "Dimension": dimension, "Lacunarity": lacunarity, **more}
            found.append(case("ShaderNodeTexMusgrave", settings, inputs | _coordinates(dimensions)))
    return found


def _voronoi(case: Make) -> list[Any]:
    found = []
    features = {
        "F1": ("Distance", "Color", "Position", "W"),
        "F2": ("Distance", "Color", "Position", "W"),
        "SMOOTH_F1": ("Distance", "Color", "Position", "W"),
        "DISTANCE_TO_EDGE": ("Distance",),
        "N_SPHERE_RADIUS": ("Radius",),
    }
    for dimensions, (feature, outputs) in product(_DIMENSIONS, features.items()):
        metrics = ("EUCLIDEAN", "MANHATTAN", "CHEBYCHEV", "MINKOWSKI")
        measured = dimensions != "1D" and len(outputs) > 1
        for metric in metrics if measured else metrics[:1]:
            settings = {"voronoi_dimensions": dimensions, "feature": feature, "distance": metric}
            inputs = {"Scale": 1.7, "Randomness": 0.9} | _coordinates(dimensions)
            inputs |= {"Smoothness": 0.8} if feature == "SMOOTH_F1" else {}
            inputs |= {"Exponent": 1.7} if measured and metric == "MINKOWSKI" else {}
            hidden = {"1D": "Position", "4D": ""}.get(dimensions, "W")
            for output in outputs if metric in metrics[:2] else outputs[:1]:
                if output != hidden:
                    found.append(case("ShaderNodeTexVoronoi", settings, inputs, output))
    for feature, inputs in (("F1", {"Randomness": 0.0}), ("SMOOTH_F1", {"Smoothness": 0.0}), ("F2", {"Scale": -2.0})):
        found.append(case("ShaderNodeTexVoronoi", {"feature": feature}, {"Vector": "p", **inputs}, "Distance"))
    return found


def _voronoi_octaves(case: Make) -> list[Any]:
    """Since 4.0."""
    found = []
    # At 0 the sign of zero tells the cell, and how that comes out is the compiler's: in the Cycles of 5.2 otherwise than before.
    flat = 0.0 if bpy.app.version < (5, 2, 0) else 1e-3
    octaves = ((2.0, 2.0, False), (2.6, 2.3, True), (0.0, 2.0, True), (1.5, flat, True))
    for dimensions, feature in product(_DIMENSIONS, ("F1", "F2", "SMOOTH_F1", "DISTANCE_TO_EDGE", "N_SPHERE_RADIUS")):
        for detail, lacunarity, normalize in octaves:
            settings = {"voronoi_dimensions": dimensions, "feature": feature, "normalize": normalize}
            inputs = {"Scale": 1.1, "Randomness": 0.8, "Smoothness": 0.6, **_coordinates(dimensions)}
            inputs |= {"Detail": detail, "Roughness": 0.6, "Lacunarity": lacunarity}
            blended = {"1D": ("W",), "4D": ("Position", "W")}.get(dimensions, ("Position",))
            outputs = {"DISTANCE_TO_EDGE": ("Distance",), "N_SPHERE_RADIUS": ("Radius",)}
            for output in outputs.get(feature, ("Distance", "Color", *blended)):
                if lacunarity == flat and (output in blended or feature == "DISTANCE_TO_EDGE"):
                    continue  # Cycles divides by it
                found.append(case("ShaderNodeTexVoronoi", settings, inputs, output))
    for metric in ("MANHATTAN", "CHEBYCHEV", "MINKOWSKI"):
        settings = {"distance": metric, "normalize": True}
        inputs = {"Vector": "p", "Scale": 1.1, "Detail": 1.0, "Exponent": 1.7}
        found.append(case("ShaderNodeTexVoronoi", settings, inputs, "Distance"))
    return found


def _waves(case: Make) -> list[Any]:
    found = []
    for shape, axes in (("BANDS", "X Y Z DIAGONAL"), ("RINGS", "X Y Z SPHERICAL")):
        for axis in axes.split():
            settings = {"wave_type": shape, f"{shape.lower()}_direction": axis}
            # Bands along Z are the same everywhere on the square but for distortion.
            found.append(case("ShaderNodeTexWave", settings, {"Vector": "p", "Scale": 0.3, "Distortion": 0.8}, "Fac"))
    for profile in ("SIN", "SAW", "TRI"):
        inputs = {"Vector": "p", "Scale": 0.2, "Distortion": 2.5, "Detail": 2.7, "Detail Scale": 1.3}
        inputs |= {"Detail Roughness": 0.7, "Phase Offset": 0.9}
        found.append(case("ShaderNodeTexWave", {"wave_profile": profile}, inputs, "Color"))
    return found


def _regular(case: Make) -> list[Any]:
    found = []
    inputs: dict[str, Any] = {"Vector": "p", "Color1": (0.8, 0.1, 0.2, 1), "Color2": (0.1, 0.2, 0.9, 1), "Scale": 1.9}
    found += [case("ShaderNodeTexChecker", {}, inputs, output) for output in ("Color", "Fac")]
    for kind in "LINEAR QUADRATIC EASING DIAGONAL SPHERICAL QUADRATIC_SPHERE RADIAL".split():
        found += [case("ShaderNodeTexGradient", {"gradient_type": kind}, {"Vector": "p"}, o) for o in ("Color", "Fac")]
    for depth in range(11):
        inputs = {"Vector": "p", "Scale": 0.7, "Distortion": 1.2}
        found.append(case("ShaderNodeTexMagic", {"turbulence_depth": depth}, inputs, "Color"))
    found.append(case("ShaderNodeTexMagic", {}, {"Vector": "p", "Distortion": 0.0}, "Fac"))
    colors = {"Color1": (0.8, 0.1, 0.2, 1), "Color2": (0.1, 0.2, 0.9, 1), "Mortar": (0.4, 0.5, 0.3, 1)}
    for settings in ({}, {"offset": 0.3, "offset_frequency": 3, "squash": 1.4, "squash_frequency": 2}):
        for smooth in (0.0, 0.6):
            inputs = {"Vector": "p", "Scale": 1.3, "Mortar Size": 0.07, "Mortar Smooth": smooth, "Bias": 0.2, **colors}
            inputs |= {"Brick Width": 0.7, "Row Height": 0.3}
            found += [case("ShaderNodeTexBrick", settings, inputs, output) for output in ("Color", "Fac")]
    return found


def _gabor(case: Make) -> list[Any]:
    """Since 4.3."""
    found = []
    for output in ("Value", "Phase", "Intensity"):
        for anisotropy in (1.0, 0.0, 0.6):
            inputs = {"Vector": "p", "Scale": 1.3, "Frequency": 2.3, "Anisotropy": anisotropy}
            found.append(case("ShaderNodeTexGabor", {}, {**inputs, "Orientation 2D": 0.7}, output))
            for way in ((0.5, -0.7, 0.3), (-0.2, 0.4, -0.9), (0.0, -2.0, 0.0)):
                in_space = {**inputs, "Orientation 3D": way}
                found.append(case("ShaderNodeTexGabor", {"gabor_type": "3D"}, in_space, output))
    for inputs in ({"Frequency": "x"}, {"Frequency": -2.0}, {"Scale": -3.0}, {"Anisotropy": "x"}, {"Anisotropy": 1.7}):
        found.append(case("ShaderNodeTexGabor", {}, {"Vector": "p", "Scale": 0.8, **inputs}, "Value"))
    return found


def _radial(case: Make) -> list[Any]:
    """Polygons with sharp and round corners, and such whose last side is shorter."""
    found = []
    polygons = [(5.0, 0.0), (2.0, 0.0), (3.4, 0.0), (5.0, 0.3), (7.0, 0.8), (4.0, 1.0)]
    for (sides, roundness), normalize in product(polygons, (False, True)):
        inputs = {"Vector": "p", "Sides": sides, "Roundness": roundness}
        found.append(case("ShaderNodeRadialTiling", {"normalize": normalize}, inputs, "Segment Coordinates"))
    for (sides, roundness), output in product(polygons, ("Segment ID", "Segment Rotation")):
        inputs = {"Vector": "p", "Sides": sides, "Roundness": roundness}
        found.append(case("ShaderNodeRadialTiling", {}, inputs, output))
    for output in ("Segment Coordinates", "Segment Width"):
        for inputs in ({"Sides": 3.4}, {"Roundness": "y"}):
            found.append(case("ShaderNodeRadialTiling", {}, {"Vector": "p", **inputs}, output))
    found.append(case("ShaderNodeRadialTiling", {}, {"Vector": "p", "Sides": "x"}, "Segment Coordinates"))
    return found


def pattern_cases(case: Make) -> list[Any]:
    """Every texture that is computed from its coordinate."""
    octaves = _voronoi_octaves(case) if bpy.app.version >= (4, 0, 0) else []
    return (
        _noise(case)
        + _fractal_noise(case)
        + _musgrave(case)
        + _voronoi(case)
        + octaves
        + _gabor(case)
        + _radial(case)
        + _waves(case)
        + _regular(case)
    )
