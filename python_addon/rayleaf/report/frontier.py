"""Which settings are worth choosing: nothing else is at once faster and closer."""

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Cost:
    """Of one point: its times with their spread, and its error."""

    least: float  # seconds
    most: float
    error: float

    def beats(self, other: "Cost") -> bool:
        """Surely faster, its slowest run against the other's fastest, and not farther off."""
        return self.most < other.least and self.error <= other.error


def dominated(points: Sequence[Cost]) -> list[int | None]:
    """For each point the index of one that beats it, the closest such; or None."""
    best: list[int | None] = []
    for point in points:
        better = [index for index, other in enumerate(points) if other.beats(point)]
        best.append(min(better, key=lambda index: points[index].error) if better else None)
    return best


def cheapest_within(points: Sequence[Cost], wanted: float) -> int | None:
    """The index of the fastest point whose error is at most `wanted`; None if there is none."""
    within = [index for index, point in enumerate(points) if point.error <= wanted]
    return min(within, key=lambda index: points[index].most) if within else None
