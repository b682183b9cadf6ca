"""Blender's curves and colour ramps as tables."""

from typing import Any

from .compiler import NodeView
from .emitter import Register

# Entries of a table, as many as Cycles takes.
TABLE_SIZE = 256


def sample_places(low: float, high: float) -> list[float]:
    """The places at which a table over low..high is sampled."""
    return [low + (high - low) * index / (TABLE_SIZE - 1) for index in range(TABLE_SIZE)]


def curve_range(curves: list[Any]) -> tuple[float, float]:
    """The span of the points of some curves; beyond it a table is constant."""
    places = [point.location[0] for curve in curves for point in curve.points]
    low, high = min(places), max(places)
    return (low, high) if high > low else (low, low + 1.0)


def to_table_place(view: NodeView, register: Register, low: float, high: float) -> Register:
    """A number of low..high as a place in a table, 0..1."""
    emitter = view.emitter
    if (low, high) == (0.0, 1.0):
        return register
    shifted = emitter.math("SUBTRACT", register, emitter.scalar(low))
    return emitter.math("DIVIDE", shifted, emitter.scalar(high - low))


def curve_table(view: NodeView, register: Register, curve: Any, component: int) -> Register:
    """A curve of the node's curve mapping applied to a number."""
    mapping = view.node.mapping
    mapping.initialize()
    low, high = curve_range([curve])
    floats = [value for x in sample_places(low, high) for value in [mapping.evaluate(curve, x)] * 4]
    place = to_table_place(view, register, low, high)
    return view.emitter.operation("table", [place], [1], floats)


def color_curves(view: NodeView, color: Register) -> Register:
    """RGB Curves: the combined curve first, then that of each channel."""
    emitter, mapping = view.emitter, view.node.mapping
    mapping.initialize()
    *channels, combined = list(mapping.curves)[:4]
    low, high = curve_range([*channels, combined])
    floats: list[float] = []
    for x in sample_places(low, high):
        y = mapping.evaluate(combined, x)
        floats += [*(mapping.evaluate(curve, y) for curve in channels), 1.0]
    parts = []
    for index in range(3):
        place = to_table_place(view, emitter.component(color, index), low, high)
        parts.append(emitter.component(emitter.operation("table", [place], [1], floats), index))
    return emitter.operation("combine", parts)


def ramp_table(ramp: Any) -> tuple[list[float], int]:
    """The entries of a colour ramp, and whether to interpolate between them."""
    floats = [channel for x in sample_places(0.0, 1.0) for channel in ramp.evaluate(x)]
    return floats, int(ramp.interpolation != "CONSTANT")
