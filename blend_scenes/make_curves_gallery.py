"""Makes curves_gallery.blend: what a curve object can be set to, each setting on a small curve with its label."""

import colorsys
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np

sys.path.append(str(Path(__file__).resolve().parent))
from scene_curves import add_bezier, add_curve, add_points, label  # noqa: E402
from scene_tools import light_gallery, material, save, start_empty  # noqa: E402

COLUMNS = 6
SPACING_X, SPACING_Y = 2.9, 2.35
ROUND = {"bevel_depth": 0.16}
WAVE = [(-1.05, -0.35, 0.35), (-0.4, 0.45, 0.7), (0.35, -0.4, 0.4), (1.05, 0.4, 0.8)]
FLAT = [(-1.0, -0.4, 0), (-0.35, 0.45, 0), (0.35, -0.4, 0), (1.0, 0.4, 0)]
LOOP = [(0.85, 0, 0.5), (0, 0.6, 0.8), (-0.85, 0, 0.45), (0, -0.6, 0.7)]
CORNERS = [("AUTO", "VECTOR"), ("VECTOR", "VECTOR"), ("VECTOR", "AUTO"), ("AUTO", "AUTO")]
RADII = [1.0, 0.35, 1.5, 0.5]
TILTS = [0.0, 1.6, -0.8, 1.2]
Exhibit = Callable[[str, Any], Any]


def wave(points: Any = WAVE, spline: dict[str, Any] | None = None, **settings: Any) -> Exhibit:
    """A wave of one Bezier spline with these settings of the curve and of the spline."""
    return lambda name, location: _filled(add_curve(name, location, **settings), add_bezier, points, **(spline or {}))


def points(kind: str, place: Any = WAVE, spline: dict[str, Any] | None = None, **settings: Any) -> Exhibit:
    """The same of a NURBS or poly spline."""
    return lambda name, location: _filled(
        add_curve(name, location, **settings), add_points, kind, place, **(spline or {})
    )


def _filled(curve: Any, add: Callable[..., Any], *arguments: Any, **settings: Any) -> Any:
    add(curve, *arguments, **settings)
    return curve


def cornered(name: str, location: Any) -> Any:
    """A Bezier spline whose handles make corners and straight parts."""
    curve = add_curve(name, location, **ROUND)
    spline = add_bezier(curve, WAVE)
    for point, (left, right) in zip(spline.bezier_points, CORNERS):
        point.handle_left_type, point.handle_right_type = left, right
    return curve


def flower(name: str, location: Any) -> Any:
    """Two closed 2D splines, one of them a hole, with an area between."""
    curve = add_curve(name, location, dimensions="2D", fill_mode="BOTH", extrude=0.12, bevel_depth=0.05)
    for scale in (1.0, 0.45):
        angle = np.arange(5) * 2 * np.pi / 5
        add_bezier(
            curve,
            np.stack([0.8 * scale * np.cos(angle), 0.8 * scale * np.sin(angle), 0 * angle], axis=1),
            use_cyclic_u=True,
        )
    curve.location.z = 0.35
    return curve


def helpers() -> dict[str, Any]:
    """Bevel and taper objects, below the floor."""
    made = {}
    for name, kind, outline, closed in (
        ("square", "POLY", [(-0.15, -0.15, 0), (0.15, -0.15, 0), (0.15, 0.15, 0), (-0.15, 0.15, 0)], True),
        ("channel", "POLY", [(-0.16, 0.16, 0), (-0.16, -0.1, 0), (0.16, -0.1, 0), (0.16, 0.16, 0)], False),
    ):
        made[name] = add_curve(name, (0, 0, -5), dimensions="2D", fill_mode="NONE")
        add_points(made[name], kind, outline, use_cyclic_u=closed)
    angle = np.arange(10) * np.pi / 5
    size = np.where(np.arange(10) % 2, 0.09, 0.24)
    made["star"] = add_curve("star", (0, 0, -5), dimensions="2D", fill_mode="NONE")
    add_points(
        made["star"],
        "POLY",
        np.stack([size * np.cos(angle), size * np.sin(angle), 0 * angle], axis=1),
        use_cyclic_u=True,
    )
    made["heart"] = add_curve("heart", (0, 0, -5), dimensions="2D", fill_mode="NONE")
    add_bezier(made["heart"], [(0, -0.2, 0), (0.2, 0.06, 0), (0, 0.1, 0), (-0.2, 0.06, 0)], use_cyclic_u=True)
    made["twin"] = add_curve("twin", (0, 0, -5), dimensions="2D", fill_mode="NONE")
    for x in (-0.14, 0.14):
        angle = np.arange(4) * np.pi / 2
        add_bezier(
            made["twin"],
            np.stack([x + 0.08 * np.cos(angle), 0.08 * np.sin(angle), 0 * angle], axis=1),
            use_cyclic_u=True,
        )
    made["taper"] = add_curve("taper", (0, 0, -5))
    add_bezier(made["taper"], [(0, 0.15, 0), (1, 1.4, 0), (2, 0.1, 0)])
    return made


def exhibits() -> Iterator[tuple[str, Exhibit]]:
    """Label and maker of each, row by row."""
    made = helpers()
    yield "Bezier", wave(**ROUND)
    yield "Bezier with corners", cornered
    yield "NURBS, order 3", points("NURBS", spline={"order_u": 3}, **ROUND)
    yield "NURBS, closed", points("NURBS", LOOP, spline={"use_cyclic_u": True}, **ROUND)
    yield "poly", points("POLY", **ROUND)
    yield "poly, closed", points("POLY", LOOP, spline={"use_cyclic_u": True}, **ROUND)

    yield "round bevel, caps", wave(use_fill_caps=True, bevel_depth=0.22)
    yield "half", wave(fill_mode="HALF", bevel_depth=0.3)
    yield "front", wave(fill_mode="FRONT", bevel_depth=0.3)
    yield "back", wave(fill_mode="BACK", bevel_depth=0.3)
    yield "extruded bevel", wave(extrude=0.25, bevel_depth=0.1)
    yield "extrude", wave(extrude=0.3)

    for name in ("square", "channel", "star", "heart", "twin"):
        bevel = {"bevel_mode": "OBJECT", "bevel_object": made[name], "use_fill_caps": name in ("square", "heart")}
        yield f"bevel object: {name}", wave(twist_mode="Z_UP", **bevel)
    yield "offset 0.2", wave(offset=0.2, bevel_depth=0.1, spline={"tilts": TILTS})

    square = {"bevel_mode": "OBJECT", "bevel_object": made["square"]}
    yield "twist: Z up", wave(LOOP, {"use_cyclic_u": True}, twist_mode="Z_UP", **square)
    yield "twist: minimum", wave(LOOP, {"use_cyclic_u": True}, twist_mode="MINIMUM", **square)
    yield "twist: tangent", wave(LOOP, {"use_cyclic_u": True}, twist_mode="TANGENT", **square)
    for mode in ("LINEAR", "CARDINAL", "EASE"):
        spline = {"tilts": TILTS, "tilt_interpolation": mode}
        yield f"tilt: {mode.lower()}", wave(spline=spline, twist_mode="Z_UP", extrude=0.25, bevel_depth=0.04)

    for mode in ("LINEAR", "CARDINAL", "BSPLINE", "EASE"):
        yield f"radius: {mode.lower()}", wave(spline={"radii": RADII, "radius_interpolation": mode}, bevel_depth=0.2)
    yield "taper object", wave(taper_object=made["taper"], bevel_depth=0.25)
    taper = {"taper_object": made["taper"], "taper_radius_mode": "MULTIPLY"}
    yield "taper times radius", wave(spline={"radii": RADII}, bevel_depth=0.25, **taper)

    for mapping in ("RESOLUTION", "SEGMENTS", "SPLINE"):
        cut = {"bevel_factor_start": 0.2, "bevel_factor_end": 0.75, "use_fill_caps": True, **ROUND}
        cut |= {f"bevel_factor_mapping_{end}": mapping for end in ("start", "end")}
        yield f"start and end: {mapping.lower()}", wave(
            [(-1.05, -0.3, 0.4), (0.4, 0.5, 0.6), (0.7, -0.4, 0.4), (1.1, 0.1, 0.6)], **cut
        )
    yield "2D, extruded", wave(FLAT, dimensions="2D", fill_mode="NONE", extrude=0.3, bevel_depth=0.05)
    yield "2D, poly, mitred", points(
        "POLY", FLAT, dimensions="2D", fill_mode="NONE", extrude=0.3, offset=0.1, bevel_depth=0.05
    )
    yield "2D, filled", flower


def main() -> None:
    start_empty(width=780, height=600, samples=32)
    look = material("label", (0.03, 0.03, 0.035), 0.6)
    listed = list(exhibits())
    rows = (len(listed) + COLUMNS - 1) // COLUMNS
    for number, (name, make) in enumerate(listed):
        row, column = divmod(number, COLUMNS)
        x, y = (column - (COLUMNS - 1) / 2) * SPACING_X, ((rows - 1) / 2 - row) * SPACING_Y
        thing = make(name, (x, y, 0.0))
        thing.location.z = max(thing.location.z, 0.35 if thing.data.dimensions == "2D" else 0.0)
        thing.data.materials.append(material(name, colorsys.hsv_to_rgb(number / len(listed), 0.8, 0.75), 0.3))
        label(name, (x, y - 0.98, 0.01), 0.25, look)
    light_gallery((0, -20, 30), (0, -0.25, 0), 17.8)
    save("curves_gallery")


main()
