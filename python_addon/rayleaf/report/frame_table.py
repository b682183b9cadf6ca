"""The table of whole frames beside Cycles: its columns, its words, and how it is printed."""

from collections.abc import Iterable, Sequence
from typing import Any

from .frames import Frame, Plan, different_limits

HEAD = ("scene", "samples", "engine", "first, s", "second, s", "first, ratio", "second, ratio", "error",
        "ratio at equal error", "from Cycles", "MB")  # fmt: skip
_FORMATS = ("{}", "{}", "{}", "{:.2f}", "{:.2f}", "{:.2f}", "{:.2f}", "{:.4f}", "{:.2f}", "{:.4f}", "{:.0f}")

# Error between converged pictures from which on they may be of different things: facets and other filters stay below.
_ANOTHER_PICTURE = 0.1


def caption(plan: Plan) -> str:
    """What the figures are."""
    clock = "processor time of all threads for" if plan.processor_time else "of"
    turns = "the first render in a fresh Blender, and the second in the same. "
    if plan.orbit:
        turns = f"the first frame of an animation in a fresh Blender, and as second its frame {plan.orbit}; the camera "
        turns += "turns about the vertical axis through the origin by a degree a frame. "
    return (
        f"{plan.percentage} % of each file's resolution, {plan.threads} threads. Seconds are {clock} a whole "
        f"frame, export and building included, the least of {plan.rounds} in turn: {turns}"
        "Cycles on the CPU, without denoiser and adaptive sampling; "
        "light path limits as the file has them. Rayleaf with ray interpolation off, on Auto and On. Ratio: Cycles' "
        "time over ours; above 1 Rayleaf is faster. Error: root mean square in display RGB against the engine's "
        f"own picture with {plan.converged_count} samples and other random numbers, interpolation off. Ratio at "
        "equal error: error falls as one over the root of the samples, so the second render's ratio times "
        "(Cycles' error over ours) squared, from the errors measured; left out where the engines' pictures are "
        "not of the same. From Cycles: the error of our converged picture against Cycles' (which shows facets). "
        "MB: the most that Blender held above what it held with the file just opened."
    )


def _ratio(frame: Frame, cycles: Frame, times: str) -> float:
    return float(min(getattr(cycles, times)) / min(getattr(frame, times)))


def shows_something_else(frame: Frame, cycles: Frame) -> bool:
    """As where Rayleaf shows an object as an x-ray does, which Cycles does not know. Noise is no reason: converged
    pictures have less of it than either frame."""
    if frame.from_cycles is None:
        return False
    return frame.from_cycles > max(_ANOTHER_PICTURE, frame.rmse or 0.0, cycles.rmse or 0.0)


def at_equal_error(frame: Frame, cycles: Frame) -> float | None:
    """Cycles' time over ours for pictures of equal error; None where an error is not known, there is none, or the
    engines do not show the same."""
    if not frame.rmse or not cycles.rmse or shows_something_else(frame, cycles):
        return None
    return _ratio(frame, cycles, "second") * (cycles.rmse / frame.rmse) ** 2


def row(frame: Frame, cycles: Frame) -> tuple[Any, ...]:
    """The cells of a frame beside Cycles'; None where there is nothing."""
    head = frame.scene, frame.samples, frame.contender
    if frame.problem:
        return *head, *[None] * (len(HEAD) - len(head))
    own = min(frame.first), min(frame.second)
    if cycles.problem or frame is cycles:
        return *head, *own, None, None, frame.rmse, None, None, frame.memory_mb
    ratios = _ratio(frame, cycles, "first"), _ratio(frame, cycles, "second")
    return *head, *own, *ratios, frame.rmse, at_equal_error(frame, cycles), frame.from_cycles, frame.memory_mb


def rows(side_by_side: Sequence[Frame]) -> list[tuple[Any, ...]]:
    """Of one scene and one number of samples; Cycles comes first."""
    return [row(frame, side_by_side[0]) for frame in side_by_side]


def _last_words(problem: str) -> str:
    """The line that says what was wrong; Blender adds that its script failed."""
    lines = [line for line in problem.splitlines() if line.strip() and not line.startswith("Error: script failed")]
    return lines[-1] if lines else problem


def remarks(side_by_side: Sequence[Frame]) -> list[str]:
    """What a reader must know of one scene: failures, and where the engines were not asked for the same."""
    found = [f"{frame.name}: {_last_words(frame.problem)}" for frame in side_by_side if frame.problem]
    scene = side_by_side[0].scene
    if limits := different_limits(list(side_by_side)):
        found.append(f"{scene}: Cycles' and Rayleaf's limits differ in the file: {', '.join(limits)}.")
    if any(shows_something_else(frame, side_by_side[0]) for frame in side_by_side):
        found.append(f"{scene}: the engines do not show the same.")
    if any(frame.told.get("integrator") == "DISTRIBUTION" for frame in side_by_side):
        found.append(f"{scene}: Rayleaf distributes rays, Cycles traces paths: another picture, and other noise.")
    return found


def text_lines(cells: Iterable[Sequence[Any]], scene_width: int) -> list[str]:
    """Rows as text; columns are as wide as their heads, the first as wide as the longest scene."""
    widths = [scene_width, *(max(len(name), 7) for name in HEAD[1:])]
    widths[2] = 13
    lines = []
    for each in cells:
        texts = [
            "–" if value is None else value if isinstance(value, str) else pattern.format(value)
            for pattern, value in zip(_FORMATS, each, strict=True)
        ]
        aligned = [
            text.ljust(width) if column in (0, 2) else text.rjust(width)
            for column, (text, width) in enumerate(zip(texts, widths, strict=True))
        ]
        lines.append("  ".join(aligned).rstrip())
    return lines
