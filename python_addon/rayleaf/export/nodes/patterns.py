"""Textures that are computed from their coordinate: noises, cells, and regular patterns."""

from ...cycles_versions import voronoi_hash
from .compiler import NodeView, value_node
from .emitter import Register
from .textures import name_hidden_mapping

# Positions in the core's lists.
_FRACTALS = ("FBM", "MULTIFRACTAL", "HYBRID_MULTIFRACTAL", "RIDGED_MULTIFRACTAL", "HETERO_TERRAIN")
_VORONOI_OCTAVES = {"Detail": 0.0, "Roughness": 0.5, "Lacunarity": 2.0}
_VORONOI_HASHES = ("JENKINS", "PCG")
_METRICS = ("EUCLIDEAN", "MANHATTAN", "CHEBYCHEV", "MINKOWSKI")
_AXES = {"X": 0, "Y": 1, "Z": 2, "DIAGONAL": 3, "SPHERICAL": 3}


def _coordinate(view: NodeView, dimensions: int) -> list[Register]:
    """The vector and the fourth coordinate, where the texture has so many dimensions."""
    zero = view.emitter.scalar(0.0)
    return [
        zero if dimensions == 1 else view.vector("Vector"),
        view.input("W") if dimensions in (1, 4) else zero,
    ]


def _shown(view: NodeView, name: str, default: float) -> Register:
    """An input that some modes hide."""
    socket = view.socket(name)
    return view.input(name) if socket is not None and socket.enabled else view.emitter.scalar(default)


def _color_or_factor(view: NodeView, result: Register, output: str, factor: str = "Fac") -> Register:
    """Colour textures hold their factor in the fourth component."""
    return view.emitter.component(result, 3) if output == factor else result


@value_node("ShaderNodeTexChecker")
def checker(view: NodeView, output: str) -> Register:
    """Checker Texture."""
    name_hidden_mapping(view)
    operands = [view.vector("Vector"), view.input("Color1"), view.input("Color2"), view.input("Scale")]
    return _color_or_factor(view, view.emitter.operation("checker", operands), output)


@value_node("ShaderNodeTexNoise")
def noise(view: NodeView, output: str) -> Register:
    """Noise Texture. Blender 4.1 gave it the types of Musgrave, and lacunarity."""
    name_hidden_mapping(view)
    node = view.node
    dimensions = int(node.noise_dimensions[0])
    operands = _coordinate(view, dimensions)
    operands += [view.input(name) for name in ("Scale", "Detail", "Roughness", "Distortion")]
    ints = [dimensions]
    if view.socket("Lacunarity") is not None:
        operands += [view.input("Lacunarity"), _shown(view, "Offset", 0.0), _shown(view, "Gain", 1.0)]
        ints += [int(getattr(node, "normalize", True)), _FRACTALS.index(getattr(node, "noise_type", "FBM"))]
    return _color_or_factor(view, view.emitter.operation("noise", operands, ints), output)


@value_node("ShaderNodeTexMusgrave")
def musgrave(view: NodeView, output: str) -> Register:
    """Musgrave Texture."""
    name_hidden_mapping(view)
    node = view.node
    dimensions = int(node.musgrave_dimensions[0])
    operands = _coordinate(view, dimensions)
    operands += [view.input(name) for name in ("Scale", "Detail", "Dimension", "Lacunarity")]
    operands += [_shown(view, "Offset", 0.0), _shown(view, "Gain", 1.0)]
    return view.emitter.operation("musgrave", operands, [dimensions], text=node.musgrave_type)


@value_node("ShaderNodeTexVoronoi")
def voronoi(view: NodeView, output: str) -> Register:
    """Voronoi Texture. Blender 4.0 gave it octaves."""
    name_hidden_mapping(view)
    node, emitter = view.node, view.emitter
    dimensions = int(node.voronoi_dimensions[0])
    place = output in ("Position", "W")
    operands = _coordinate(view, dimensions)
    operands += [view.input("Scale"), _shown(view, "Smoothness", 0.0), _shown(view, "Exponent", 1.0)]
    operands.append(view.input("Randomness"))
    ints = [dimensions, _METRICS.index(node.distance), int(place)]
    if view.socket("Detail") is not None:
        operands += [_shown(view, name, default) for name, default in _VORONOI_OCTAVES.items()]
        ints += [int(node.normalize), _VORONOI_HASHES.index(voronoi_hash())]
    result = emitter.operation("voronoi", operands, ints, text=node.feature)
    return result if output in ("Color", "Position") else emitter.component(result, 3)


@value_node("ShaderNodeTexWhiteNoise")
def white_noise(view: NodeView, output: str) -> Register:
    """White Noise Texture."""
    dimensions = int(view.node.noise_dimensions[0])
    zero = view.emitter.scalar(0.0)
    operands = [
        zero if dimensions == 1 else view.input("Vector"),
        view.input("W") if dimensions in (1, 4) else zero,
    ]
    return _color_or_factor(view, view.emitter.operation("white_noise", operands, [dimensions]), output, "Value")


@value_node("ShaderNodeTexGradient")
def gradient(view: NodeView, output: str) -> Register:
    """Gradient Texture; its colour is grey."""
    name_hidden_mapping(view)
    return view.emitter.operation("gradient", [view.vector("Vector")], text=view.node.gradient_type)


@value_node("ShaderNodeTexWave")
def wave(view: NodeView, output: str) -> Register:
    """Wave Texture; its colour is grey."""
    name_hidden_mapping(view)
    node = view.node
    rings = node.wave_type == "RINGS"
    names = ("Scale", "Distortion", "Detail", "Detail Scale", "Detail Roughness", "Phase Offset")
    operands = [view.vector("Vector"), *(view.input(name) for name in names)]
    ints = [int(rings), _AXES[node.rings_direction if rings else node.bands_direction]]
    return view.emitter.operation("wave", operands, ints, text=node.wave_profile)


@value_node("ShaderNodeTexMagic")
def magic(view: NodeView, output: str) -> Register:
    """Magic Texture."""
    name_hidden_mapping(view)
    operands = [view.vector("Vector"), view.input("Scale"), view.input("Distortion")]
    return _color_or_factor(view, view.emitter.operation("magic", operands, [view.node.turbulence_depth]), output)


@value_node("ShaderNodeTexBrick")
def brick(view: NodeView, output: str) -> Register:
    """Brick Texture."""
    name_hidden_mapping(view)
    node, emitter = view.node, view.emitter
    names = ("Color1", "Color2", "Mortar", "Scale", "Mortar Size", "Mortar Smooth", "Bias", "Brick Width", "Row Height")
    operands = [view.vector("Vector"), *(view.input(name) for name in names)]
    operands += [emitter.scalar(node.offset), emitter.scalar(node.squash)]
    ints = [node.offset_frequency, node.squash_frequency]
    return _color_or_factor(view, emitter.operation("brick", operands, ints), output)


@value_node("ShaderNodeTexGabor")
def gabor(view: NodeView, output: str) -> Register:
    """Gabor Texture, of Blender 4.3."""
    name_hidden_mapping(view)
    in_space = view.node.gabor_type == "3D"
    operands = [view.vector("Vector"), *(view.input(name) for name in ("Scale", "Frequency", "Anisotropy"))]
    # The way of the waves: two sockets of one name, of which the dimensions hide one.
    nothing = view.emitter.scalar(0.0)
    operands += [nothing, view.input("Orientation 3D")] if in_space else [view.input("Orientation 2D"), nothing]
    result = view.emitter.operation("gabor", operands, [3 if in_space else 2])
    return view.emitter.component(result, ("Value", "Phase", "Intensity").index(output))
