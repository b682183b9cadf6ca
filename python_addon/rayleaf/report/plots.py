"""Plots as SVG text, drawn by matplotlib without a display."""

import io
import math
from typing import Any

import matplotlib

matplotlib.use("svg")
matplotlib.rcParams["svg.fonttype"] = "none"  # text stays text: small, and readable by all
matplotlib.rcParams["svg.hashsalt"] = "rayleaf"  # the same plot is the same file

from matplotlib import pyplot  # noqa: E402  (after the choice of the backend)

from .measure import Measured  # noqa: E402

_MARKERS = "osD^vPX*"


def _as_svg(figure: Any) -> str:
    text = io.StringIO()
    figure.savefig(text, format="svg", metadata={"Date": None}, bbox_inches="tight")
    pyplot.close(figure)
    svg = text.getvalue()
    return svg[svg.index("<svg") :]


def _apart(place: tuple[float, float], others: list[tuple[float, float]]) -> bool:
    """Whether there is room for a label; places in decades."""
    return all(abs(place[0] - x) > 0.12 or abs(place[1] - y) > 0.06 for x, y in others)


def _below(axes: Any) -> None:
    """The legend, where it hides nothing and takes no width: a phone has little."""
    axes.legend(fontsize=7, loc="upper center", bbox_to_anchor=(0.5, -0.16), frameon=False, ncol=2)


def frontier(measured: list[Measured]) -> str:
    """Error against seconds, both logarithmic; what is dominated is hollow."""
    figure, axes = pyplot.subplots(figsize=(6.4, 4.2))
    labelled: list[tuple[float, float]] = []
    for number, series in enumerate(dict.fromkeys(each.point.series for each in measured)):
        own = [each for each in measured if each.point.series == series]
        marker = _MARKERS[number % len(_MARKERS)]
        line = axes.plot([each.time for each in own], [each.error.rmse for each in own], "-", linewidth=0.8)[0]
        color = line.get_color()
        axes.plot([], [], marker + "-", color=color, linewidth=0.8, label=series)  # for the legend
        for each in own:
            face = "none" if each.beaten_by else color
            axes.plot(each.time, each.error.rmse, marker, color=color, markerfacecolor=face)
            place = math.log10(max(each.time, 1e-9)), math.log10(max(each.error.rmse, 1e-9))
            if _apart(place, labelled):
                labelled.append(place)
                axes.annotate(each.point.label, (each.time, each.error.rmse), fontsize=6, xytext=(4, 3),
                              textcoords="offset points")  # fmt: skip
    if all(each.time > 0 for each in measured):
        axes.set_xscale("log")
    if all(each.error.rmse > 0 for each in measured):
        axes.set_yscale("log")
    axes.set_xlabel("seconds (median)")
    axes.set_ylabel("root mean square error, display RGB")
    axes.grid(True, which="both", linewidth=0.3)
    _below(axes)
    return _as_svg(figure)


def lines(
    title: str,
    x_label: str,
    y_label: str,
    series: dict[str, list[tuple[float, float]]],
    others: dict[str, list[tuple[float, float]]] | None = None,
) -> str:
    """Curves over a logarithmic x where all x are positive; used for tables of one parameter. Those of `others` are
    dashed and grey."""
    figure, axes = pyplot.subplots(figsize=(5.2, 3.4))
    for number, (name, points) in enumerate(series.items()):
        style = _MARKERS[number % len(_MARKERS)] + "-"
        axes.plot(*zip(*sorted(points), strict=True), style, linewidth=0.9, label=name)
    for number, (name, points) in enumerate((others or {}).items()):
        style = _MARKERS[number % len(_MARKERS)] + "--"
        axes.plot(*zip(*sorted(points), strict=True), style, color="0.55", linewidth=0.7, markersize=4, label=name)
    drawn = [place for points in [*series.values(), *(others or {}).values()] for place in points]
    if all(x > 0 for x, _ in drawn):
        axes.set_xscale("log")
    if all(y > 0 for _, y in drawn):
        axes.set_yscale("log")
    axes.set_title(title, fontsize=9)
    axes.set_xlabel(x_label)
    axes.set_ylabel(y_label)
    axes.grid(True, which="both", linewidth=0.3)
    _below(axes)
    return _as_svg(figure)
