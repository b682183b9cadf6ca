"""The stability part of the report: what the tests of tests/stability measured, against the bounds they must keep."""

import re
from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import page, plots, test_runs

_VARIABLE = "RAYLEAF_STABILITY"  # names the file that tests/stability/measured.py adds to


@dataclass
class Family:
    """All checks of one kind of case and one quantity."""

    case: str
    quantity: str
    unit: str
    count: int = 0
    failed: int = 0
    worst: float = 0.0  # measured, where it came nearest to its bound or farthest beyond
    bound: float = 0.0
    place: str = ""  # offset, scale and other conditions of the worst
    _share: float = -1.0

    def add(self, line: dict[str, Any]) -> None:
        measured, bound = float(line["measured"]), float(line["bound"])
        share = measured / bound if bound > 0.0 else (0.0 if measured <= 0.0 else float("inf"))
        self.count += 1
        self.failed += not measured <= bound
        if share > self._share:
            self._share, self.worst, self.bound = share, measured, bound
            self.place = line["case"].partition(", ")[2]

    @property
    def share(self) -> float:
        """Of the bound that the worst takes."""
        return max(self._share, 0.0)


def families(lines: Iterable[dict[str, Any]]) -> list[Family]:
    """In the order in which they were measured."""
    found: dict[tuple[str, str], Family] = {}
    for line in lines:
        case, quantity = line["case"].partition(", ")[0], line["quantity"].partition(" at ")[0]
        family = found.setdefault((case, quantity), Family(case, quantity, line["unit"]))
        family.add(line)
    return list(found.values())


def measure(root: Path, folder: Path, quick: bool) -> tuple[list[dict[str, Any]], str]:
    """Runs the tests; their lines, and pytest's last line."""
    tests = root / "tests" / "stability"
    selection = tests / "test_closed_forms.py" if quick else tests
    return test_runs.figures(root, [str(selection)], _VARIABLE, folder / "stability.jsonl")


Curves = dict[str, list[tuple[float, float]]]
_CHAIN = re.compile(r"(.*), (\d+) (?:interior )?hits")
_SMALLEST = 1e-16  # of an error, for a logarithmic axis


def growth(lines: Iterable[dict[str, Any]]) -> tuple[Curves, Curves]:
    """Errors of directions by the number of hits of chains, and their bounds."""
    measured: Curves = defaultdict(list)
    bounds: Curves = defaultdict(list)
    for line in lines:
        chain = _CHAIN.fullmatch(line["case"])
        if not chain or not line["quantity"].endswith("direction"):
            continue
        name, hits = chain[1], float(chain[2])
        measured[name].append((hits, max(float(line["measured"]), _SMALLEST)))
        bounds[f"{name}, bound"].append((hits, float(line["bound"])))
    return measured, bounds


def section(lines: list[dict[str, Any]], summary: str) -> str:
    """The page of the report."""
    found = families(lines)
    words = (
        "Rays against stiff and extreme cases, at offsets 0, 10³ and 10⁶ and sizes 10⁻⁶ to 10⁶, compared with extended "
        "precision (64 bits of significand) or with closed forms. Each row is one kind of case: the check that came "
        "nearest to its bound. 'Of bound' above 100 % would be a failure."
    )
    head = ("case", "quantity", "checks", "failed", "worst", "bound", "unit", "of bound", "where")
    rows = [
        (f.case, f.quantity, f.count, f.failed, f.worst, f.bound, f.unit, f"{f.share:.0%}", f.place or None)
        for f in found
    ]
    curves, bounds = growth(lines)
    drawing = plots.lines("Error of a chain of hits", "hits", "direction, rad", curves, bounds) if curves else ""
    return page.section(
        "Numerical stability",
        page.paragraph(words),
        page.paragraph(f"{len(lines)} checks, {sum(f.failed for f in found)} beyond their bound. Tests: {summary}"),
        page.plot(drawing, "A ray between walls, in a curved mirror, in a round rod of glass: how its error grows")
        if drawing
        else "",
        page.table(head, rows, (not f.failed and f.share < 1e-3 for f in found)),
    )
