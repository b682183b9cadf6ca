"""RI's figures 5 to 8 drawn from our measurements: speed-up, error and memory over one parameter each.

The benchmark `rays` writes rows named 'table 2|scene|parameter|value|tree|quantity'."""

from collections import defaultdict
from typing import Any

from . import page, plots

_FIGURES = {
    "distance": ("RI figure 5", "distance threshold"),
    "angle": ("RI figure 6", "angular threshold, degrees"),
    "depth": ("RI figure 7", "depth limit"),
    "cache, MB": ("RI figure 8", "cache, MB"),
}
_QUANTITIES = ("CPU over Newton", "error", "MB")
Curves = dict[str, list[tuple[float, float]]]


def curves(rows: list[dict[str, Any]]) -> dict[tuple[str, str], Curves]:
    """(parameter, quantity) -> 'scene, tree' -> points."""
    found: dict[tuple[str, str], Curves] = defaultdict(lambda: defaultdict(list))
    for row in rows:
        parts = row["name"].split("|")
        if len(parts) != 6 or parts[0] != "table 2" or not row["values"]:
            continue
        _, scene, parameter, value, tree, quantity = parts
        found[parameter, quantity][f"{scene}, {tree}"].append((float(value), float(row["values"][0])))
    return found


def figures(rows: list[dict[str, Any]]) -> str:
    """All that the rows allow; empty without them."""
    found = curves(rows)
    parts = []
    for parameter, (title, label) in _FIGURES.items():
        drawn = [
            page.plot(plots.lines(f"{title}: {quantity}", label, quantity, found[parameter, quantity]), "")
            for quantity in _QUANTITIES
            if (parameter, quantity) in found
        ]
        if drawn:
            parts.append(page.section(title, page.pictures(*drawn), level=3))
    return "".join(parts)
