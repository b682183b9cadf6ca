"""Writes a core Program; equal operations are written once, and constants are known while compiling."""

from collections.abc import Sequence
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

Register = int
UNCONNECTED: Register = -1

Constant = tuple[float, float, float, float]


class Emitter:
    """A program under construction."""

    def __init__(self, core: ModuleType, name: str, bump_shadow: str = "CUBIC", clearing: str = "ALL") -> None:
        """`bump_shadow`, `clearing`: the core's, of closures."""
        self.program: Any = core.Program(name, bump_shadow, clearing)
        self.rejected: type[Exception] = core.InputError  # what the core raises for operations that it does not know
        self._has_bump_width = False
        self._constants: dict[Constant, Register] = {}
        self._values: dict[Register, Constant] = {}
        self._operations: dict[Any, Register] = {}

    def take_bump_width(self, width: float) -> float:
        """Sets the distance over which bumps compare heights, in pixels, if it is not set yet; returns the one that is used."""
        if not self._has_bump_width:
            self._has_bump_width, self.program.bump_width = True, width
        return float(self.program.bump_width)

    def constant(self, x: float, y: float, z: float, w: float = 1.0) -> Register:
        """A register holding a colour or vector."""
        value = (float(x), float(y), float(z), float(w))
        if value not in self._constants:
            register = int(self.program.constant(*value))
            self._constants[value] = register
            self._values[register] = value
        return self._constants[value]

    def scalar(self, value: float) -> Register:
        """A register holding a number."""
        return self.constant(value, value, value, value)

    def value_of(self, register: Register) -> Constant | None:
        """What a register holds if that is known now."""
        return self._values.get(register)

    def operation(
        self,
        identifier: str,
        operands: Sequence[Register] = (),
        ints: Sequence[int] = (),
        floats: Sequence[float] | NDArray[np.float32] = (),
        text: str = "",
    ) -> Register:
        """Append an operation of core/shading/operations.def, unless an equal one has been written; its result."""
        numbers = np.asarray(floats, np.float32)
        key = (identifier, tuple(operands), tuple(ints), numbers.tobytes(), text)
        if key not in self._operations:
            result = int(self.program.operation(identifier, list(operands), list(ints), numbers, text))
            if result == UNCONNECTED:  # closures add up: a second equal one counts
                return result
            self._operations[key] = result
        return self._operations[key]

    def component(self, register: Register, index: int) -> Register:
        """One of the four floats, as a scalar."""
        known = self.value_of(register)
        return self.operation("component", [register], [index]) if known is None else self.scalar(known[index])

    def math(self, name: str, *operands: Register) -> Register:
        """Scalar arithmetic by Blender's name of the operation."""
        return self.operation("math", operands, [0], text=name)

    def multiply(self, a: Register, b: Register) -> Register:
        """The product of two scalars."""
        known_a, known_b = self.value_of(a), self.value_of(b)
        if known_a is not None and known_b is not None:
            return self.scalar(known_a[0] * known_b[0])
        for known, other in ((known_a, b), (known_b, a)):
            if known is not None and known[0] == 1.0:
                return other
            if known is not None and known[0] == 0.0:
                return self.scalar(0.0)
        return self.math("MULTIPLY", a, b)

    def add(self, a: Register, b: Register) -> Register:
        """The sum of two scalars."""
        known_a, known_b = self.value_of(a), self.value_of(b)
        if known_a is not None and known_b is not None:
            return self.scalar(known_a[0] + known_b[0])
        for known, other in ((known_a, b), (known_b, a)):
            if known is not None and known[0] == 0.0:
                return other
        return self.math("ADD", a, b)

    def complement(self, a: Register) -> Register:
        """One minus a scalar."""
        known = self.value_of(a)
        return self.math("SUBTRACT", self.scalar(1.0), a) if known is None else self.scalar(1.0 - known[0])

    def saturate(self, a: Register) -> Register:
        """A scalar clamped to 0..1."""
        known = self.value_of(a)
        if known is not None:
            return self.scalar(min(max(known[0], 0.0), 1.0))
        return self.operation("clamp", [a, self.scalar(0.0), self.scalar(1.0)], text="MINMAX")
