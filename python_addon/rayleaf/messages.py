"""What the user is told: each thing once, with the name of what it is about."""

from collections.abc import Callable


class Messages:
    """Collects messages; each new one is passed on at once."""

    def __init__(self, report: Callable[[str, str], None] | None = None) -> None:
        """`report` takes Blender's kind ('INFO', 'WARNING', 'ERROR') and the text."""
        self._report = report
        self.texts: list[str] = []
        self._known: set[str] = set()

    def note(self, text: str) -> None:
        """Something worth knowing that takes nothing from the picture."""
        self._add("INFO", text)

    def warn(self, text: str) -> None:
        """Something is left out or replaced, and the render goes on."""
        self._add("WARNING", text)

    def error(self, text: str) -> None:
        """The render cannot go on."""
        self._add("ERROR", text)

    def _add(self, kind: str, text: str) -> None:
        if text in self._known:
            return
        self._known.add(text)
        self.texts.append(text)
        if self._report is not None:
            self._report(kind, text)
