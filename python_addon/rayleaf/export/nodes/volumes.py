"""Shader nodes of volumes: what they do to light inside an object or the world, with a weight."""

from ... import versions
from .compiler import NodeView, volume_node
from .emitter import Register


@volume_node("ShaderNodeVolumeAbsorption")
def absorption(view: NodeView, weight: Register) -> None:
    """Volume Absorption."""
    view.emitter.operation("volume_absorption", [weight, view.input("Color"), view.input("Density")])


def _name_phase(view: NodeView) -> None:
    phase = getattr(view.node, "phase", "HENYEY_GREENSTEIN")  # 4.3
    if phase != "HENYEY_GREENSTEIN":
        view.warn(f"the phase function {phase.title().replace('_', '-')} is not supported; Henyey-Greenstein is taken")


@volume_node("ShaderNodeVolumeScatter")
def scatter(view: NodeView, weight: Register) -> None:
    """Volume Scatter."""
    _name_phase(view)
    operands = [weight, view.input("Color"), view.input("Density"), view.input("Anisotropy")]
    view.emitter.operation("volume_scatter", operands)


@volume_node("ShaderNodeVolumeCoefficients")
def coefficients(view: NodeView, weight: Register) -> None:
    """Volume Coefficients of 4.5: each by itself."""
    _name_phase(view)
    emitter, one = view.emitter, view.emitter.scalar(1.0)
    left = emitter.operation("vector_math", [one, view.input("Absorption Coefficients")], text="SUBTRACT")
    emitter.operation("volume_absorption", [weight, left, one])
    operands = [weight, view.input("Scatter Coefficients"), one, view.input("Anisotropy")]
    emitter.operation("volume_scatter", operands)
    emitter.operation("emission", [weight, view.input("Emission Coefficients"), one])


@volume_node("ShaderNodeVolumePrincipled")
def principled(view: NodeView, weight: Register) -> None:
    """Principled Volume. Its attributes are those of grids, which meshes have not."""
    strength, heat = view.input("Emission Strength"), view.input("Blackbody Intensity")
    if versions.glow_counts_its_weight_twice():
        strength, heat = (view.emitter.math("MULTIPLY", each, weight) for each in (strength, heat))
    operands = [
        *(weight, view.input("Color"), view.input("Density"), view.input("Anisotropy")),
        *(view.input("Absorption Color"), strength, view.input("Emission Color")),
        *(heat, view.input("Blackbody Tint"), view.input("Temperature")),
    ]
    view.emitter.operation("volume_principled", operands)


@volume_node("ShaderNodeEmission")
def emission(view: NodeView, weight: Register) -> None:
    """Emission, by the length of the way."""
    view.emitter.operation("emission", [weight, view.input("Color"), view.input("Strength")])
