"""The nodes part of the report: each shader node of the running Blender, and how far it is from Cycles, by what the oracles of
tests/blender measured."""

import os
from collections.abc import Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from . import page, test_runs

_VARIABLE = "RAYLEAF_NODES"  # names the file that tests/blender/measured_nodes.py adds to
_QUICK = ("test_compared_nodes.py", "test_nodes_oracle.py")
_PREFIX = "ShaderNode"


@dataclass
class Node:
    """A node, and all comparisons of it."""

    kind: str
    label: str
    use: str = "supported"  # or "organises", "left out"
    told: list[str] = field(default_factory=list)  # what Rayleaf says of it
    told_of: dict[str, list[str]] = field(default_factory=dict)  # and of its modes
    not_compared: dict[str, str] = field(default_factory=dict)  # modes and sockets that no case has, with reasons
    elsewhere: str = ""  # what else holds that it is right
    wanted: set[str] = field(default_factory=set)  # choices, switches and sockets that it has
    count: int = 0
    failed: int = 0
    oracles: list[str] = field(default_factory=list)
    modes: dict[str, list[Any]] = field(default_factory=dict)  # choice or switch -> values that are compared
    sockets: set[str] = field(default_factory=set)  # that are compared
    difference: float = -1.0  # the largest; and what belongs to it
    median: float = 0.0
    bound: float = 0.0
    case: str = ""
    share: float = 0.0  # of its bound, that any case takes at most

    def describe(self, line: dict[str, Any]) -> None:
        """Take over what Blender has."""
        self.label, self.use, self.told, self.told_of = line["label"], line["use"], line["told"], line["told_of"]
        self.not_compared, self.elsewhere = line["not_compared"], line["elsewhere"]
        self.wanted = {f"{path}={value}" for path, values in line["modes"].items() for value in values}
        self.wanted |= {f"input {name}" for name in line["inputs"]} | {f"output {name}" for name in line["outputs"]}

    def add(self, line: dict[str, Any]) -> None:
        """Take over a comparison."""
        difference, bound = float(line["difference"]), float(line["bound"])
        self.count += 1
        self.failed += not difference <= bound
        if line["oracle"] not in self.oracles:
            self.oracles.append(line["oracle"])
        for path, value in line["modes"].items():
            values = self.modes.setdefault(path, [])
            if value not in values:
                values.append(value)
        self.sockets |= {f"input {name}" for name in line["inputs"]} | {f"output {line['output']}"}
        self.share = max(self.share, difference / bound)
        if difference > self.difference:
            self.difference, self.bound = difference, bound
            self.median, self.case = float(line["median"]), f"{line['oracle']}: {line['case']}"

    @property
    def lacking(self) -> list[str]:
        """Choices, switches and sockets that no case has and no message names."""
        compared = {f"{path}={value}" for path, values in self.modes.items() for value in values} | self.sockets
        return sorted(self.wanted - compared - set(self.told_of))


def nodes(lines: Iterable[dict[str, Any]]) -> list[Node]:
    """By name."""
    found: dict[str, Node] = {}
    for line in lines:
        kind = line["node"]
        node = found.setdefault(kind, Node(kind, kind.removeprefix(_PREFIX)))
        if "use" in line:
            node.describe(line)
        else:
            node.add(line)
    return [found[kind] for kind in sorted(found)]


def measure(root: Path, folder: Path, blender: str, quick: bool) -> tuple[list[dict[str, Any]], str]:
    """Runs the oracles; their lines, and pytest's last line."""
    tests = root / "tests" / "blender"
    selection = ["-m", "nodes", *([str(tests / name) for name in _QUICK] if quick else [str(tests)])]
    environment = {"BLENDER": blender}
    if scripts := os.environ.get("BLENDER_USER_SCRIPTS"):
        environment["RAYLEAF_BLENDER_SCRIPTS"] = scripts
    return test_runs.figures(root, selection, _VARIABLE, folder / "nodes.jsonl", environment)


def _modes(node: Node) -> str:
    """Each choice with its values; switches by their name, where both ways are compared."""
    words = []
    for path, values in node.modes.items():
        if all(isinstance(value, bool) for value in values):
            words.append(f"{path} {' and '.join('on' if value else 'off' for value in values)}")
        else:
            words.append(f"{path}: {' '.join(str(value) for value in values)}")
    return "; ".join(words)


def _remarks(node: Node) -> str:
    """What is not compared, and why."""
    words = [f"{name}: {' '.join(texts)}" for name, texts in node.told_of.items()]
    words += [f"{name}: {reason}" for name, reason in node.not_compared.items() if name not in node.told_of]
    if lacking := [name for name in node.lacking if name not in node.not_compared]:
        words.append(f"not compared: {', '.join(lacking)}")
    return "; ".join(words)


def _row(node: Node) -> tuple[Any, ...]:
    if not node.count:
        return (node.label, node.kind, *(None,) * 8, _handling(node))
    of_all = (
        f"{len(node.sockets & node.wanted)} of {sum(name.startswith(('input ', 'output ')) for name in node.wanted)}"
    )
    return (
        *(node.label, node.kind, node.count, _modes(node) or None, of_all, node.difference, node.bound),
        *(node.median, node.case, f"{node.share:.0%}", _remarks(node) or None),
    )


def _handling(node: Node) -> str:
    """What becomes of a node that is not compared."""
    if node.use == "left out":
        return "left out: " + ("; ".join(node.told) or "it has no outputs")
    use = "organises a tree" if node.use == "organises" else "supported, and not compared in this run"
    return f"{use}; {node.elsewhere}" if node.elsewhere else use


def section(lines: list[dict[str, Any]], summary: str) -> str:
    """The page of the report."""
    found = nodes(lines)
    compared = [node for node in found if node.count]
    words = (
        "Every shader node of this Blender, compared with Cycles: the same node, modes and sockets in both. Where both are "
        "free of noise, points and pixels are compared one by one, and a few percent of them, where steps fall otherwise, "
        "are left out; else means of converged pictures. Differences are shares of the value or of the brightest part; "
        "where Rayleaf is known to be another, the bound is what it may differ by. 'Nearest to a bound' above 100 % would "
        "be a failure."
    )
    head = ("node", "name", "cases", "modes compared", "sockets compared", "largest difference", "its bound")
    rows = [_row(node) for node in sorted(found, key=lambda node: (not node.count, node.use, node.label))]
    return page.section(
        "Nodes",
        page.paragraph(words),
        page.paragraph(
            f"{len(compared)} nodes, {sum(node.count for node in compared)} cases, "
            f"{sum(node.failed for node in compared)} beyond their bound. Tests: {summary}"
        ),
        page.table(
            (*head, "its median", "its case", "nearest to a bound", "not compared"), rows, (not row[2] for row in rows)
        ),
    )
