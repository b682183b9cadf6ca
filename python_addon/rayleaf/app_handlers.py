"""Functions that Blender calls at events, for as long as the add-on is enabled."""

from collections.abc import Callable

Handler = Callable[..., None]


def handlers_factory(
    pairs: tuple[tuple[list[Handler], Handler], ...], at_end: Callable[[], None]
) -> tuple[Callable[[], None], Callable[[], None]]:
    """A register and an unregister function for pairs of a list in bpy.app.handlers and what it gets.

    `at_end` runs after the handlers are removed.
    """

    def register() -> None:
        for handlers, handler in pairs:
            handlers.append(handler)

    def unregister() -> None:
        for handlers, handler in pairs:
            handlers.remove(handler)
        at_end()

    return register, unregister
