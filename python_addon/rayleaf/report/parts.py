"""Parts of a report that are kept between runs: one that was made before, by the same commit on the same machine, from the
same file and of the same extent, is not made again."""

import hashlib
import json
import subprocess
import time
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

FOLDER = "parts"  # inside the report's


@dataclass
class Part:
    """A section of the page, and its figures."""

    html: str
    figures: dict[str, dict[str, Any]] = field(default_factory=dict)  # kind -> name -> what report.json holds of it
    seconds: float = 0.0  # that it took
    made: str = ""  # when, local time
    load: float = 0.0  # of the machine before


def state(root: Path) -> str | None:
    """The commit and what differs from it in files that it has, as one word; None where nobody can tell (no clone)."""
    answers = []
    for command in (["rev-parse", "HEAD"], ["diff", "HEAD"]):
        try:
            done = subprocess.run(["git", *command], cwd=root, capture_output=True, check=False)
        except OSError:
            return None
        if done.returncode != 0:
            return None
        answers.append(done.stdout)
    return hashlib.sha256(b"\0".join(answers)).hexdigest()


def mark(*circumstances: Any) -> str:
    """One word for all that a part depends on; files by what they hold."""
    plain = [
        hashlib.sha256(each.read_bytes()).hexdigest() if isinstance(each, Path) else each for each in circumstances
    ]
    return hashlib.sha256(json.dumps(plain, sort_keys=True, default=str).encode()).hexdigest()


class KeptParts:
    """The parts in a report's folder."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder / FOLDER
        self._folder.mkdir(parents=True, exist_ok=True)

    def _path(self, name: str) -> Path:
        return self._folder / f"{name}.json"

    def find(self, name: str, wanted: str) -> Part | None:
        """The part if it was made in the circumstances that `wanted` marks."""
        try:
            held = json.loads(self._path(name).read_text(encoding="utf-8"))
            return Part(**held["part"]) if held["mark"] == wanted else None
        except (OSError, ValueError, KeyError, TypeError):  # none, or broken off while it was written
            return None

    def keep(self, name: str, circumstances: str, part: Part) -> None:
        """For the next run. Whole or not at all: a report may be stopped at any time."""
        unfinished = self._path(name).with_suffix(".new")
        unfinished.write_text(json.dumps({"mark": circumstances, "part": asdict(part)}), encoding="utf-8")
        unfinished.replace(self._path(name))


def now() -> str:
    """As the page shows when a part was made."""
    return time.strftime("%Y-%m-%d %H:%M")
