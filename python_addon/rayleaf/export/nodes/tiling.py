"""Radial Tiling, since 5.0: the plane cut into the segments of a regular polygon, each with coordinates of its own.

Angles are counted from the x axis, lengths in those of the polygon's inner radius. A segment lies between two corners; its
middle is the middle of a side. Of a number of sides that is not whole the last segment is narrower, and its side stretched so
that the sides meet.
"""

import math
from dataclasses import dataclass

from .compiler import NodeView, value_node
from .emitter import Emitter, Register


@dataclass(frozen=True)
class _Number:
    """A scalar register, with arithmetic."""

    emitter: Emitter
    register: Register

    def _with(self, name: str, *others: "_Number | float") -> "_Number":
        registers = [self.emitter.scalar(x) if isinstance(x, (int, float)) else x.register for x in others]
        return _Number(self.emitter, self.emitter.math(name, self.register, *registers))

    def __add__(self, other: "_Number | float") -> "_Number":
        return self._with("ADD", other)

    def __sub__(self, other: "_Number | float") -> "_Number":
        return self._with("SUBTRACT", other)

    def __mul__(self, other: "_Number | float") -> "_Number":
        return self._with("MULTIPLY", other)

    def __truediv__(self, other: "_Number | float") -> "_Number":
        return self._with("DIVIDE", other)  # by zero: 0

    def of(self, name: str, *others: "_Number | float") -> "_Number":
        """Blender's operation of that name."""
        return self._with(name, *others)

    def where(self, mask: "_Number", other: "_Number") -> "_Number":
        """This where the mask is 1, the other where it is 0."""
        return self * mask + other * (mask * -1.0 + 1.0)


@dataclass(frozen=True)
class _Segment:
    """Where a point lies: the number of its segment, and the half angles of a whole segment and of its own."""

    number: _Number
    half: _Number
    own_half: _Number
    turned: _Number  # the point's angle from the middle of its segment
    length: _Number  # from the centre

    def rotation(self) -> _Number:
        """The angle of the segment's middle."""
        return self.number * self.half * 2.0 + self.own_half

    def sharp(self) -> tuple[_Number, _Number, _Number]:
        """Along the middle, along the side, and half the side's length where the former is 1."""
        stretch = self.half.of("COSINE") / self.own_half.of("COSINE")
        along = stretch * self.length * self.turned.of("COSINE")
        return along, along * self.turned.of("TANGENT"), self.own_half.of("TANGENT")

    def rounded(self, roundness: _Number, normalize: bool) -> tuple[_Number, _Number, _Number]:
        """The same where all segments are whole and corners are arcs. On these a coordinate grows with the angle, on the straight
        part with the length; between them, quadratically from one to the other. Normalized, it is divided by what it is at
        the corner."""
        straight, across, _ = self.sharp()
        to_arc = ((roundness * -1.0 + 1.0) * self.half.of("TANGENT")).of("ARCTANGENT")  # from the middle
        arc = self.half - to_arc  # half its angle
        from_corner = self.half - self.turned.of("ABSOLUTE")
        bent = (roundness * -1.0 + 1.0) * arc  # the angle over which the coordinate changes its kind
        in_arc = from_corner.of("LESS_THAN", arc)

        center = (roundness * -1.0 + 1.0) / self.half.of("COSINE")
        cosine = from_corner.of("COSINE") * center
        rim = cosine + (cosine * cosine + roundness * roundness - center * center).of("SQRT")
        along = (self.length / rim).where(in_arc, straight)

        beside, ahead = self.length * to_arc.of("SINE"), self.length * to_arc.of("COSINE")
        angle = arc - from_corner  # beyond the straight part
        growing = ahead * angle + (ahead * -1.0 + 1.0) * angle * angle * 0.5 / bent
        grown = bent * (ahead * 0.5 - 0.5) + angle
        curved = beside + growing.where(angle.of("LESS_THAN", bent), grown)
        side = (curved * self.turned.of("SIGN")).where(in_arc, across)
        if normalize:

            def at_corner(tangential: _Number, radial: _Number) -> _Number:
                return tangential + bent * (radial * 0.5 + 0.5) + roundness * arc

            by_side = at_corner(along * to_arc.of("TANGENT"), along)
            share = angle / arc
            mixed = at_corner(beside, ahead) * share + by_side * (share * -1.0 + 1.0)
            side = side / mixed.where(in_arc, by_side)
        return along, side, to_arc.of("TANGENT") + bent + roundness * arc


def _segment(view: NodeView, sides: _Number) -> _Segment:
    emitter, vector = view.emitter, view.input("Vector")
    x, y = (_Number(emitter, emitter.component(vector, axis)) for axis in (0, 1))
    half = sides.of("POWER", -1.0) * math.pi
    turn = y.of("ARCTAN2", x) + y.of("LESS_THAN", 0.0) * (2.0 * math.pi)
    number = (turn / (half * 2.0)).of("FLOOR")
    last = number.of("LESS_THAN", sides.of("FLOOR")) * -1.0 + 1.0
    own_half = (sides.of("FLOOR") * half * -1.0 + math.pi).where(last, half)
    return _Segment(number, half, own_half, turn - number * half * 2.0 - own_half, (x * x + y * y).of("SQRT"))


@value_node("ShaderNodeRadialTiling")
def radial_tiling(view: NodeView, output: str) -> Register:
    """Radial Tiling."""
    emitter, normalize = view.emitter, bool(view.node.normalize)
    sides = _Number(emitter, view.input("Sides")).of("MAXIMUM", 2.0)
    segment = _segment(view, sides)
    if output == "Segment ID":
        return segment.number.register
    if output == "Segment Rotation":
        return segment.rotation().register
    roundness = view.input("Roundness")
    known, count = emitter.value_of(roundness), emitter.value_of(view.input("Sides"))
    is_sharp, is_whole = known is not None and known[0] <= 0.0, count is not None and count[0] == round(count[0])
    if is_sharp or not is_whole:
        if not is_sharp:
            view.warn("corners are rounded for a fixed, whole number of sides alone; they are sharp")
        along, side, width = segment.sharp()
        ends = sides.of("GREATER_THAN", 2.0)  # those of two half planes have no end
        width = width * ends
        if normalize:
            side = (segment.turned.of("TANGENT") / width).where(ends, side)
    else:
        along, side, width = segment.rounded(_Number(emitter, emitter.saturate(roundness)), normalize)
    if output == "Segment Width":
        return width.register
    if normalize:
        side = side * 0.5 + 0.5
    else:
        along = along - 1.0
    return emitter.operation("combine", [side.register, along.register, emitter.scalar(0.0)])
