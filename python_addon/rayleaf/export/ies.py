"""The light distributions of lamps as manufacturers measure them: files of IES LM-63 as the core's tables."""

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

# Candela to the watts of Blender's point lamps: 4 pi over 177.83 lumens a watt, those of standard daylight, as Cycles.
_WATTS_OF_CANDELA = 0.0706650768394
_MOST_ANGLES = 4096
_TYPE_C, _TYPE_B = 1, 2

Floats = NDArray[np.float64]


class IesError(ValueError):
    """What is wrong with a file."""


class _Numbers:
    """The numbers of a file, one after the other; commas separate as spaces do."""

    def __init__(self, text: str) -> None:
        self._words: Iterator[str] = iter(text.replace(",", " ").split())

    def next(self, what: str) -> float:
        word = next(self._words, None)
        if word is None:
            raise IesError(f"it ends before {what}")
        try:
            value = float(word)
        except ValueError:
            raise IesError(f"'{word[:20]}' stands where {what} should be") from None
        if not math.isfinite(value):
            raise IesError(f"{what} is not finite")
        return value

    def count(self, what: str) -> int:
        """A number of angles."""
        value = self.next(what)
        if not 1 <= value <= _MOST_ANGLES or value != int(value):
            raise IesError(f"{what} is {value:g}, not 1 to {_MOST_ANGLES}")
        return int(value)

    def many(self, count: int, what: str) -> Floats:
        """So many of them."""
        return np.array([self.next(what) for _ in range(count)])


def _after_header(text: str) -> _Numbers:
    """What follows the keywords and the line of TILT."""
    _, found, rest = text.partition("TILT=")
    if not found:
        raise IesError("it has no line TILT=")
    tilt, _, body = rest.partition("\n")
    numbers = _Numbers(body)
    if tilt.strip().upper() == "INCLUDE":
        numbers.next("the lamp's geometry")
        numbers.many(2 * numbers.count("the number of tilts"), "a tilt")
    elif tilt.strip().upper() != "NONE":
        raise IesError("its tilt lies in another file")
    return numbers


def _check_ascending(angles: Floats, what: str) -> None:
    if np.any(np.diff(angles) <= 0.0):
        raise IesError(f"its {what} angles do not ascend")


def _mirrored(horizontal: Floats, values: Floats, end: float) -> tuple[Floats, Floats]:
    """What lies beyond the last angle is the mirror image of what lies before."""
    return np.append(horizontal, end - horizontal[-2::-1]), np.vstack([values, values[-2::-1]])


def _whole_turn(horizontal: Floats, values: Floats) -> tuple[Floats, Floats]:
    """All around, from what symmetry leaves out."""
    if horizontal[0] == 90.0:  # some files give the half from 90 to 270 degrees
        horizontal = horizontal - 90.0
    if horizontal[0] != 0.0:
        raise IesError(f"its horizontal angles begin with {horizontal[0]:g}")
    if len(horizontal) == 1:
        return np.array([0.0, 360.0]), np.vstack([values, values])
    if horizontal[-1] == 90.0:
        horizontal, values = _mirrored(horizontal, values, 180.0)
    if horizontal[-1] == 180.0:
        horizontal, values = _mirrored(horizontal, values, 360.0)
    left = 360.0 - horizontal[-1]
    if left in (horizontal[-1] - horizontal[-2], horizontal[1] - horizontal[0]):  # the first again, left out
        horizontal, values = np.append(horizontal, 360.0), np.vstack([values, values[:1]])
    if horizontal[-1] != 360.0:
        raise IesError(f"its horizontal angles end with {horizontal[-1]:g}")
    return horizontal, values


def _from_the_pole(vertical: Floats, values: Floats) -> tuple[Floats, Floats]:
    """Vertical angles that begin with 0."""
    if vertical[0] == 90.0 and vertical[-1] == 180.0:  # light that goes up: turned over, as in Cycles
        return 180.0 - vertical[::-1], values[:, ::-1]
    if vertical[0] != 0.0:
        raise IesError(f"its vertical angles begin with {vertical[0]:g}")
    return vertical, values


def parse(text: str) -> list[float]:
    """The table that core/shading/ies.h describes, in the watts of a lamp. Raises IesError."""
    numbers = _after_header(text)
    numbers.many(2, "the lamps and their lumens")
    factor = numbers.next("the candela multiplier")
    rows, columns = numbers.count("the number of vertical angles"), numbers.count("the number of horizontal angles")
    kind = numbers.next("the photometric type")
    numbers.many(4, "the luminaire's size")
    factor *= numbers.next("the ballast factor") * numbers.next("the ballast-lamp factor")
    numbers.next("the input watts")
    vertical, horizontal = numbers.many(rows, "a vertical angle"), numbers.many(columns, "a horizontal angle")
    values = numbers.many(rows * columns, "an intensity").reshape(columns, rows) * (factor * _WATTS_OF_CANDELA)
    if kind != _TYPE_C:
        raise IesError(f"its photometric type is {'B' if kind == _TYPE_B else 'A'}; only C is supported")
    _check_ascending(vertical, "vertical")
    _check_ascending(horizontal, "horizontal")
    if rows < 2:
        raise IesError("it has a single vertical angle")
    vertical, values = _from_the_pole(vertical, values)
    horizontal, values = _whole_turn(horizontal, values)
    table = [float(len(vertical)), float(len(horizontal)), 0.0, 0.0]
    table += np.radians(vertical).tolist() + np.radians(horizontal).tolist() + values.ravel().tolist()
    return table + [0.0] * (-len(table) % 4)
