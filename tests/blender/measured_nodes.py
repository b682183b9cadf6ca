"""What comparisons of nodes with Cycles measured: written where RAYLEAF_NODES names a file."""

import json
import os
from pathlib import Path


def _keep(line):
    path = os.environ.get("RAYLEAF_NODES")
    if path:
        with Path(path).open("a", encoding="utf-8") as file:
            file.write(json.dumps(line) + "\n")


def keep_comparison(oracle, case, nodes, difference, median, bound):
    """A case, and the nodes that it is about, as oracle_case describes them. `difference` is the figure that is judged, `bound`
    the most that it may be, `median` that of the case's pixels or parts."""
    figures = {"difference": float(difference), "median": float(median), "bound": float(bound)}
    for node in nodes:
        _keep({"oracle": oracle, "case": case, **node, **figures})


def keep_node(described):
    """A node that Blender has, as node_inventory describes it."""
    _keep(described)
