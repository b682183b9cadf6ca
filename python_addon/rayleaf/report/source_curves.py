"""RI's figures 5 to 8 from our measurements, with the points that the source printed: speed-ups, error and memory over
one parameter each.

The benchmark `rays` writes rows named 'table 2|scene|parameter|value|tree|quantity'."""

from collections import defaultdict
from dataclasses import dataclass
from statistics import median
from typing import Any

from . import page, plots
from .source_figures import RI_TABLE_2_ANGLE, RI_TABLE_2_DEPTH, RI_TABLE_2_DISTANCE, SourceTable


@dataclass(frozen=True)
class _Figure:
    title: str
    label: str  # of the parameter
    printed: SourceTable | None  # its points, where the source has a table of them


_FIGURES = {
    "distance": _Figure("RI figure 5", "distance threshold", RI_TABLE_2_DISTANCE),
    "angle": _Figure("RI figure 6", "angular threshold, degrees", RI_TABLE_2_ANGLE),
    "depth": _Figure("RI figure 7", "depth limit", RI_TABLE_2_DEPTH),
    "cache, MB": _Figure("RI figure 8", "cache, MB", None),
}
# What the benchmark calls a quantity -> the source's column.
_QUANTITIES = {
    "CPU over Newton": "speed-up, CPU",
    "FLOP over Newton": "speed-up, FLOPs",
    "error": "error",
    "MB": "MB",
}
Curves = dict[str, list[tuple[float, float]]]


def curves(rows: list[dict[str, Any]]) -> dict[tuple[str, str], Curves]:
    """(parameter, quantity) -> 'scene, tree' -> points."""
    found: dict[tuple[str, str], Curves] = defaultdict(lambda: defaultdict(list))
    for row in rows:
        parts = row["name"].split("|")
        if len(parts) != 6 or parts[0] != "table 2" or not row["values"]:
            continue
        _, scene, parameter, value, tree, quantity = parts
        found[parameter, quantity][f"{scene}, {tree}"].append((float(value), median(row["values"])))
    return found


def printed(table: SourceTable, quantity: str) -> Curves:
    """The source's points of one of the benchmark's quantities; empty where its table has no such column."""
    column = _QUANTITIES[quantity]
    if column not in table.head:
        return {}
    found: Curves = defaultdict(list)
    for row in table.rows:
        found[f"{row[0]}, as printed"].append((float(row[1]), float(row[table.head.index(column)])))
    return found


def figures(rows: list[dict[str, Any]]) -> str:
    """All that the rows allow; empty without them."""
    found = curves(rows)
    parts = []
    for parameter, figure in _FIGURES.items():
        drawn = []
        for quantity in _QUANTITIES:
            own = found.get((parameter, quantity))
            if not own:
                continue
            theirs = printed(figure.printed, quantity) if figure.printed else {}
            drawn.append(page.plot(plots.lines(quantity, figure.label, quantity, own, theirs), ""))
        if drawn:
            parts.append(page.section(figure.title, page.pictures(*drawn), level=3))
    return "".join(parts)
