"""Blender's curves and colour ramps as tables."""

from collections.abc import Callable
from typing import Any

import numpy as np

from .compiler import NodeView
from .emitter import Register

# Entries of a table, as many as Cycles takes.
TABLE_SIZE = 256


def sample_places(low: float, high: float) -> list[float]:
    """The places at which a table over low..high is sampled."""
    return [low + (high - low) * index / (TABLE_SIZE - 1) for index in range(TABLE_SIZE)]


def curve_range(curves: list[Any]) -> tuple[float, float]:
    """The span of the points of some curves, and of a table."""
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


def _beyond(view: NodeView, place: Register, ends: list[float]) -> Register:
    """What a curve that goes on straight adds beyond the ends of its table; `ends`: the first two entries, the last two."""
    emitter, found = view.emitter, view.emitter.scalar(0.0)
    first, second, last_but_one, last = map(np.float32, ends)  # whose steps are Cycles'
    below = emitter.math("MINIMUM", place, emitter.scalar(0.0))
    above = emitter.math("MAXIMUM", emitter.math("SUBTRACT", place, emitter.scalar(1.0)), emitter.scalar(0.0))
    for way, step in ((below, second - first), (above, last - last_but_one)):
        rise = emitter.scalar(float(step) * (TABLE_SIZE - 1))
        found = emitter.add(found, emitter.multiply(way, rise))
    return found


def _component_of_table(view: NodeView, place: Register, floats: list[float], component: int) -> Register:
    """A component of a table's entries at a place. Beyond its ends curves go on straight where the node says so."""
    emitter = view.emitter
    inside = emitter.component(emitter.operation("table", [place], [1], floats), component)
    if view.node.mapping.extend != "EXTRAPOLATED":
        return inside
    values = floats[component::4]
    return emitter.add(inside, _beyond(view, place, [*values[:2], *values[-2:]]))


def number_curve(view: NodeView, register: Register) -> Register:
    """The node's only curve applied to a number."""
    mapping = view.node.mapping
    mapping.initialize()
    (curve,) = mapping.curves
    low, high = curve_range([curve])
    floats = [value for x in sample_places(low, high) for value in [mapping.evaluate(curve, x)] * 4]
    return _component_of_table(view, to_table_place(view, register, low, high), floats, 0)


def _each_component(view: NodeView, vector: Register, evaluate: Callable[[float], list[float]]) -> Register:
    """Three curves over the span of all of the node's; `evaluate` gives their values at a place."""
    emitter = view.emitter
    low, high = curve_range(list(view.node.mapping.curves))
    floats = [value for x in sample_places(low, high) for value in (*evaluate(x), 1.0)]
    parts = []
    for index in range(3):
        place = to_table_place(view, emitter.component(vector, index), low, high)
        parts.append(_component_of_table(view, place, floats, index))
    return emitter.operation("combine", parts)


def vector_curves(view: NodeView, vector: Register) -> Register:
    """Vector Curves: one per component."""
    mapping = view.node.mapping
    mapping.initialize()
    return _each_component(view, vector, lambda x: [mapping.evaluate(curve, x) for curve in list(mapping.curves)[:3]])


def color_curves(view: NodeView, color: Register) -> Register:
    """RGB Curves: the combined curve first, then that of each channel."""
    mapping = view.node.mapping
    mapping.initialize()
    *channels, combined = list(mapping.curves)[:4]

    def evaluate(x: float) -> list[float]:
        y = mapping.evaluate(combined, x)
        return [mapping.evaluate(curve, y) for curve in channels]

    return _each_component(view, color, evaluate)


def ramp_table(ramp: Any) -> tuple[list[float], int]:
    """The entries of a colour ramp, and whether to interpolate between them."""
    floats = [channel for x in sample_places(0.0, 1.0) for channel in ramp.evaluate(x)]
    return floats, int(ramp.interpolation != "CONSTANT")
