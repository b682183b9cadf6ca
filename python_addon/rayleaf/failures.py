"""What goes wrong in a render without being the scene's fault: told by Blender's report, and by a traceback on the console."""

import sys
import traceback
from typing import Any

from . import kept_messages
from .core_module import CoreError
from .messages import Message, printable

_TOLD_IN_VIEWS: set[str] = set()


def told(error: Exception) -> str:
    """An exception in a line."""
    if isinstance(error, MemoryError):
        return f"Out of memory: {error or 'the scene needs more than there is'}"
    if isinstance(error, CoreError):
        return str(error)
    return f"Rayleaf failed, the console says where: {type(error).__name__}: {error}"


def report(engine: Any, error: Exception) -> None:
    """End a render with an error. Nothing of it is left: a traceback that Python keeps would keep Blender's data too."""
    text = printable(told(error))
    if not isinstance(error, CoreError):  # which says all there is to say
        sys.stderr.write(printable("".join(traceback.format_exception(error))))
    kept_messages.keep(Message("ERROR", text))
    engine.report({"ERROR"}, text)
    engine.error_set(text)


def report_in_view(engine: Any, error: Exception) -> None:
    """Show in a view's corner what went wrong there; the console says where, once."""
    text = printable(told(error))
    if not isinstance(error, CoreError) and text not in _TOLD_IN_VIEWS:
        _TOLD_IN_VIEWS.add(text)
        sys.stderr.write(printable("".join(traceback.format_exception(error))))
    engine.update_stats("Rayleaf", text)
