"""Shader nodes of volumes: what they do to light inside an object or the world, with a weight."""

from ... import cycles_versions
from ...names import text_of
from .compiler import NodeView, value_node, volume_node
from .emitter import Emitter, Register
from .resources import Resources


@volume_node("ShaderNodeVolumeAbsorption")
def absorption(view: NodeView, weight: Register) -> None:
    """Volume Absorption."""
    view.emitter.operation("volume_absorption", [weight, view.input("Color"), view.input("Density")])


_OF_PHASES = {  # what phase functions ask for
    "HENYEY_GREENSTEIN": ("Anisotropy",),
    "DRAINE": ("Anisotropy", "Alpha"),
    "FOURNIER_FORAND": ("IOR", "Backscatter"),
    "MIE": ("Diameter",),
}


def _scatter(view: NodeView, weight: Register, color: Register, density: Register) -> None:
    phase = getattr(view.node, "phase", "HENYEY_GREENSTEIN")  # 4.3
    asked = [view.input(name) for name in _OF_PHASES.get(phase, ())] or [view.emitter.scalar(0.0)]
    view.emitter.operation("volume_scatter", [weight, color, density, *asked], text=phase)


@volume_node("ShaderNodeVolumeScatter")
def scatter(view: NodeView, weight: Register) -> None:
    """Volume Scatter."""
    _scatter(view, weight, view.input("Color"), view.input("Density"))


@volume_node("ShaderNodeVolumeCoefficients")
def coefficients(view: NodeView, weight: Register) -> None:
    """Volume Coefficients of 4.5: each by itself."""
    emitter, one = view.emitter, view.emitter.scalar(1.0)
    left = emitter.operation("vector_math", [one, view.input("Absorption Coefficients")], text="SUBTRACT")
    emitter.operation("volume_absorption", [weight, left, one])
    _scatter(view, weight, view.input("Scatter Coefficients"), one)
    emitter.operation("emission", [weight, view.input("Emission Coefficients"), one])


def _times_grid(view: NodeView, value: Register, attribute: str, is_color: bool = False) -> Register:
    """A value times what the grid holds that an input names, where there is such a grid."""
    socket = view.socket(attribute)
    name = "" if socket is None else text_of(socket, "default_value")
    if not view.compiler.reads_grids or not name:
        return value
    emitter = view.emitter
    held = emitter.operation("grid_value", [emitter.scalar(1.0)], [view.resources.attribute(name)])
    if is_color:
        return emitter.operation("vector_math", [value, held], text="MULTIPLY")
    number = emitter.operation("average", [held])
    return emitter.math("MULTIPLY", value, emitter.math("MAXIMUM", number, emitter.scalar(0.0)))


def write_default_volume(emitter: Emitter, resources: Resources) -> None:
    """What Cycles takes for volumes without a material: grey, as dense as the grid of that name says."""
    zero, one = emitter.scalar(0.0), emitter.scalar(1.0)
    density = emitter.operation("average", [emitter.operation("grid_value", [one], [resources.attribute("density")])])
    emitter.operation("volume_principled", [one, emitter.scalar(0.5), density, *(zero,) * 4, zero, one, zero])


@value_node("ShaderNodeVolumeInfo")
def volume_info(view: NodeView, output: str) -> Register:
    """Volume Info: grids by their usual names."""
    if not view.compiler.reads_grids:
        return view.emitter.scalar(0.0)
    held = view.emitter.operation("attribute", ints=[view.resources.attribute(output.lower())])
    return held if output == "Color" else view.emitter.operation("average", [held])


@volume_node("ShaderNodeVolumePrincipled")
def principled(view: NodeView, weight: Register) -> None:
    """Principled Volume. Its attributes are those of grids, which meshes have not."""
    color = _times_grid(view, view.input("Color"), "Color Attribute", is_color=True)
    density = _times_grid(view, view.input("Density"), "Density Attribute")
    strength, heat = view.input("Emission Strength"), view.input("Blackbody Intensity")
    kelvins = view.input("Temperature")
    if view.emitter.value_of(heat) != (0.0, 0.0, 0.0, 0.0):
        kelvins = _times_grid(view, kelvins, "Temperature Attribute")
    if cycles_versions.glow_counts_its_weight_twice():
        strength, heat = (view.emitter.math("MULTIPLY", each, weight) for each in (strength, heat))
    operands = [
        *(weight, color, density, view.input("Anisotropy")),
        *(view.input("Absorption Color"), strength, view.input("Emission Color")),
        *(heat, view.input("Blackbody Tint"), kelvins),
    ]
    view.emitter.operation("volume_principled", operands)


@volume_node("ShaderNodeEmission")
def emission(view: NodeView, weight: Register) -> None:
    """Emission, by the length of the way."""
    view.emitter.operation("emission", [weight, view.input("Color"), view.input("Strength")])


@volume_node("ShaderNodeBsdfPrincipled")
def principled_surface(view: NodeView, weight: Register) -> None:
    """Its emission, where Cycles makes a node of its own of that; of the rest nothing acts inside a body."""
    if not cycles_versions.principled_shines_inside():
        return
    view.emitter.operation("emission", [weight, view.input("Emission"), view.input("Emission Strength")])
