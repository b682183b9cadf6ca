"""What a render did: kept in `rayleaf.last_statistics` and, where RAYLEAF_STATS names a file, added to it."""

import json
import os
import sys
from pathlib import Path
from typing import Any

# Names a file to which each rendered view layer adds one line: a JSON object.
STATISTICS_VARIABLE = "RAYLEAF_STATS"

# The scenes and view layers, by name, that Blender has asked for; None: nobody wants to know.
asked: set[tuple[str, str]] | None = None


def note_asked(scene: str, view_layer: str) -> None:
    """Blender wants a view layer rendered."""
    if asked is not None:
        asked.add((scene, view_layer))


def publish(record: dict[str, Any]) -> None:
    """Keep a render's record, and write it where the user asked for it."""
    sys.modules[__package__].last_statistics = record  # type: ignore[attr-defined]
    path = os.environ.get(STATISTICS_VARIABLE)
    if path:
        with Path(path).open("a", encoding="utf-8") as file:
            file.write(json.dumps(record, default=str) + "\n")


def last(scene: str) -> dict[str, Any]:
    """The record of the last render, if it was of the scene of that name; else empty."""
    record: dict[str, Any] = sys.modules[__package__].last_statistics
    return record if record.get("scene") == scene else {}


def process_memory() -> tuple[float, float] | None:
    """Megabytes of this process now and at most so far; None where the system does not tell."""
    try:
        lines = Path("/proc/self/status").read_text(encoding="utf-8").splitlines()
    except OSError:
        return None
    kilobytes = {line.split(":")[0]: int(line.split()[1]) for line in lines if line.startswith(("VmRSS", "VmHWM"))}
    return kilobytes["VmRSS"] / 1024, kilobytes["VmHWM"] / 1024
