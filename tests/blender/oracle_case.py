"""A node as it is compared with Cycles."""

from dataclasses import dataclass, field
from typing import Any


@dataclass
class Case:
    """A node, its settings, what is linked (by the name of a source that the comparison has) or written to its inputs, and
    the output that is compared."""

    node: str
    settings: dict[str, Any] = field(default_factory=dict)
    inputs: dict[str, Any] = field(default_factory=dict)
    output: str = ""

    @property
    def name(self) -> str:
        """What failures show."""
        return f"{self.node.removeprefix('ShaderNode')} {self.settings} {self.inputs} {self.output}"
