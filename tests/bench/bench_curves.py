"""Primitive types of one bevelled curve: build time, memory, render time and error of each against the exact tube.

The curve is a spiral of cubic Bezier segments with a round bevel, seen from all around by rays through its box. Every
primitive is traced one ray at a time on one thread, by processor time; memory is what the process holds more for shape
and tree. The error is the distance along the ray to the exact tube's hit, in radii, of rays that hit both; "missed" are
rays that hit one of them alone. The report's table 3.4.1 has the first four rows as pictures of 3 to 55 minutes.

Then, the swept patch against the smallest tube of triangles of equal silhouette error, as Blender would make it, in
Rayleaf and in Embree alone; axis hits that each primitive loses; and de Casteljau's algorithm beside the Bernstein form, in
rounding units, by degree.
"""

import time
from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np
import rayleaf_rivals
from numpy.typing import NDArray
from rayleaf import _core
from rayleaf.report.curve_primitives import RADIUS, curve

Doubles = NDArray[np.float64]
Tracer = _core.trace.Tracer

PRINTS_ITSELF = True
# A pixel of a picture 1000 wide that shows the whole curve, from where the rays start.
PIXEL_ANGLE = 4e-4
EYE = (0.0, -3.0, 0.0)
# For a swept patch that stands for the exact surface.
FINEST_PIXEL = 1e-5
DETAILS = (8, 16, 32)
DEGREES = (1, 2, 3, 5, 8, 12, 20, 30, 40)


def knot(_: int) -> Any:
    """A closed NURBS curve that winds about a torus, thicker than the spiral, in the unit cube."""
    t = np.arange(30) / 30 * 2 * np.pi
    distance = 1.1 + 0.52 * np.cos(3 * t)
    points = np.stack(
        [distance * np.cos(2 * t), distance * np.sin(2 * t), 0.52 * np.sin(3 * t), np.full(30, 3.8)], axis=1
    )
    points /= 3.8
    splines = _core.CurveSplines("NURBS", np.array([30], np.int32), points, order=4, cyclic=True)
    return _core.SweptCurve("knot", [splines], bevel_depth=0.27 / 3.8)


def rays(count: int) -> tuple[Doubles, Doubles]:
    """Rays from a sphere around the curve through its box."""
    random = np.random.default_rng(11)
    directions = random.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    return random.uniform(-0.5, 0.5, (count, 3)) - 3.0 * directions, directions


def tubes(exact: Any, detail: int, facets: str) -> Any:
    """A tube of facets along the exact strands, `detail` sides and rings a segment in proportion."""
    return _core.strand_tubes(exact, max(1, detail // 2), detail, facets)


def primitives(segments: int) -> dict[str, Callable[[], Any]]:
    """What makes the shape of each type."""
    description = curve(segments)

    def along(form: str, spheres: int = 16) -> Any:
        return _core.strands_along(description, form, spheres)

    made: dict[str, Callable[[], Any]] = {}
    for detail in DETAILS:
        made[f"spheres, {4 * detail} a segment"] = lambda detail=detail: along("SPHERES", 4 * detail)
    for facets in ("TRIANGLES", "QUADS"):
        for detail in DETAILS:
            name = f"{facets.lower()}, {detail} sides"
            made[name] = lambda detail=detail, facets=facets: tubes(along("ROUND"), detail, facets)
    made["ribbon"] = lambda: along("RIBBON")
    made["Embree's round curve"] = lambda: along("EMBREE_ROUND")
    made["round strand"] = lambda: along("ROUND")
    made["swept patch"] = lambda: _core.trace.SweptSurface(description)
    return made


def compared(t: Doubles, exact: Doubles) -> tuple[float, float, float]:
    """(share of rays that hit one alone, median and largest distance of the other hits in radii)."""
    hit, wanted = np.isfinite(t), np.isfinite(exact)
    off = np.abs(t[hit & wanted] - exact[hit & wanted]) / RADIUS
    return float(np.mean(hit != wanted)), float(np.median(off)), float(np.quantile(off, 0.99))


def measured(
    make: Callable[[], Any], origins: Doubles, directions: Doubles, repeats: int, pixel_angle: float = PIXEL_ANGLE
) -> dict[str, Any]:
    """Build seconds, bytes, nanoseconds a ray and distances of one primitive."""
    began = time.perf_counter()
    shape = make()
    tracer = Tracer([(shape, np.eye(4), 31)], pixel_angle=pixel_angle, eye=EYE)
    built = time.perf_counter() - began
    seconds, t = tracer.timed_closest(origins, directions)  # also dices what is diced when it is met
    seconds = min(tracer.timed_closest(origins, directions)[0] for _ in range(repeats))
    held = tracer.statistics()
    memory = shape.bytes + held["record_bytes"] + held["bvh_bytes"] + held["geometry_cache"]["bytes"]
    return {"build": built, "memory": memory, "ray": 1e9 * seconds / len(t), "t": t, "shape": shape}


def table_of_primitives(segments: int, count: int, repeats: int) -> list[dict[str, Any]]:
    """Prints the comparison; its rows."""
    origins, directions = rays(count)
    results = {name: measured(make, origins, directions, repeats) for name, make in primitives(segments).items()}
    exact = results["round strand"]["t"]
    print(f"  {segments} segments, {count} rays, {np.isfinite(exact).mean():.0%} hit")
    print(f"  {'':24} {'build ms':>9} {'KiB':>9} {'ns a ray':>9} {'missed':>9} {'median':>9} {'99 %':>9}  (radii)")
    rows = []
    for name, result in results.items():
        missed, median, most = compared(result["t"], exact)
        numbers = f"{1e3 * result['build']:>9.2f} {result['memory'] / 1024:>9.0f} {result['ray']:>9.0f}"
        print(f"  {name:24} {numbers} {missed:>9.1e} {median:>9.1e} {most:>9.1e}")
        for unit, value in (("ms", 1e3 * result["build"]), ("bytes", result["memory"]), ("ns a ray", result["ray"])):
            rows.append({"name": name, "unit": unit, "values": [float(value)]})
        rows.append({"name": name, "unit": "radii, median error", "values": [median]})
    assert compared(results["swept patch"]["t"], exact)[0] < 0.01, "the swept patch is not the exact tube"
    return rows


def equal_mesh(strands: Any, wanted: float, exact: Doubles, origins: Doubles, directions: Doubles) -> tuple[Any, str]:
    """The smallest tube of triangles of which no more rays hit one alone, among some numbers of sides and rings."""
    found: list[tuple[int, str]] = []
    for rings_a_side in (0.25, 0.5, 1.0):
        for sides in (8, 10, 12, 14, 16, 20, 24, 28, 32, 36, 40, 48, 56, 64, 80):
            rings = round(sides * rings_a_side)
            mesh = _core.strand_tubes(strands, rings, sides)
            _, t = Tracer([(mesh, np.eye(4), 31)]).timed_closest(origins, directions)
            if compared(t, exact)[0] <= wanted:
                found.append((rings * sides, f"{sides} sides, {rings} rings a segment", rings, sides))
                break
    _, words, rings, sides = min(found)
    return _core.strand_tubes(strands, rings, sides), words


def table_of_silhouettes(
    name: str, make: Callable[[int], Any], segments: int, count: int, repeats: int
) -> list[dict[str, Any]]:
    """Prints the swept patch beside the smallest mesh of equal silhouette error."""
    origins, directions = rays(count)
    # Open at its ends as the mesh is; a strand is closed there, which one ray in two thousand sees.
    exact = measured(lambda: _core.trace.SweptSurface(make(segments)), origins, directions, 1, FINEST_PIXEL)
    swept = measured(lambda: _core.trace.SweptSurface(make(segments)), origins, directions, repeats)
    wanted = compared(swept["t"], exact["t"])[0]
    mesh, words = equal_mesh(_core.strands_along(make(segments)), wanted, exact["t"], origins, directions)
    triangles = measured(lambda: mesh, origins, directions, repeats)
    alone = rayleaf_rivals.EmbreeBaseline(mesh)
    bare = {
        "memory": alone.bytes,
        "ray": 1e9 * min(alone.timed_closest(*rays(count))[0] for _ in range(repeats + 1)) / count,
    }
    bare["t"] = alone.timed_closest(origins, directions)[1]
    print(f"\n  {name}, equal silhouette error: {words}")
    rows = []
    for kind, result in (("swept patch", swept), ("triangles", triangles), ("triangles, Embree alone", bare)):
        missed, median, _ = compared(result["t"], exact["t"])
        ratios = (
            f"patch over it: memory {swept['memory'] / result['memory']:.3f}, time {swept['ray'] / result['ray']:.2f}"
        )
        print(
            f"  {kind:24} {result['memory'] / 1024:>9.0f} KiB {result['ray']:>7.0f} ns a ray, missed {missed:.1e},"
            f" median error {median:.1e}; {ratios}"
        )
        for unit, value in (("bytes", result["memory"]), ("ns a ray", result["ray"])):
            rows.append({"name": f"equal silhouette, {name}: {kind}", "unit": unit, "values": [float(value)]})
    return rows


def lost_hits(count: int) -> list[dict[str, Any]]:
    """Prints how many rays aimed at the axis of an S each round primitive loses."""
    control = np.array([[0, 0, 0], [0.4, 0.3, 0.1], [0.6, -0.3, 0.2], [1, 0, 0]])
    random = np.random.default_rng(5)
    directions = random.normal(size=(count, 3))
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    t = random.uniform(0.001, 0.999, count)[:, None]
    axis = (1 - t) ** 3 * control[0] + 3 * t * (1 - t) ** 2 * control[1] + 3 * t * t * (1 - t) * control[2]
    axis = axis + t**3 * control[3]
    rows = []
    print(f"\n  of {count} rays aimed at the axis are lost, by radius over length and distance from the origin")
    print(f"  {'':24}" + "".join(f"{f'{r:.0e} at {o:.0e}':>15}" for r in (1e-2, 1e-4, 1e-6) for o in (0, 1e4, 1e6)))
    for form in ("ROUND", "RIBBON", "EMBREE_ROUND"):
        shares = []
        for radius in (1e-2, 1e-4, 1e-6):
            for offset in (0.0, 1e4, 1e6):
                offsets = np.array([0, 4], np.int32)
                shape = _core.Strands("S", control, np.full(4, radius, np.float32), offsets, basis="BEZIER", form=form)
                matrix = np.eye(4)
                matrix[:3, 3] = offset
                hits = Tracer([(shape, matrix, 31)]).closest_hits(axis + offset - 3 * directions, directions)
                shares.append(float(np.mean(~np.isfinite(hits["t"]))))
        print(f"  {form.lower():24}" + "".join(f"{share:>15.2%}" for share in shares))
        rows.append({"name": f"lost axis hits: {form.lower()}", "unit": "share", "values": shares})
    return rows


def evaluation_error(degree: int, kind: str, points: Doubles, places: Doubles) -> float:
    """The largest error of a way to evaluate, in rounding units of the largest control point."""
    if kind == "power":
        # Coefficients of t^k, exactly, then rounded to double: what the power form starts from.
        size = range(degree + 1)
        coefficients = [
            float(
                mpmath.fsum(
                    (-1) ** (k - i) * mpmath.binomial(degree, k) * mpmath.binomial(k, i) * mpmath.mpf(points[i, 0])
                    for i in range(k + 1)
                )
            )
            for k in size
        ]
        values = np.polynomial.polynomial.polyval(places, coefficients)
    else:
        bezier = _core.BezierCurve(points)
        values = bezier.evaluate(places)[:, 0, 0] if kind == "Bernstein" else bezier.de_casteljau(places)[:, 0]
    worst = 0.0
    for t, value in zip(places, values, strict=True):
        s = mpmath.mpf(1) - mpmath.mpf(t)
        exact = mpmath.fsum(
            mpmath.binomial(degree, i) * s ** (degree - i) * mpmath.mpf(t) ** i * mpmath.mpf(points[i, 0])
            for i in range(degree + 1)
        )
        worst = max(worst, float(abs(exact - mpmath.mpf(float(value)))))
    return worst / (np.finfo(float).eps * float(np.abs(points[:, 0]).max()))


def table_of_degrees(count: int) -> list[dict[str, Any]]:
    """Prints the errors of evaluating by degree."""
    rows = []
    random = np.random.default_rng(9)
    kinds = ("Bernstein", "de Casteljau", "power")
    print("\n  largest error of a value, in rounding units of the largest control point")
    print(f"  {'degree':>8}" + "".join(f"{kind:>16}" for kind in kinds))
    with mpmath.workdps(60):
        for degree in DEGREES:
            points = np.hstack([random.uniform(-1, 1, (degree + 1, 3)), np.ones((degree + 1, 1))])
            errors = [evaluation_error(degree, kind, points, np.linspace(0, 1, count)) for kind in kinds]
            print(f"  {degree:>8}" + "".join(f"{error:>16.3g}" for error in errors))
            rows += [
                {"name": f"degree {degree}, {kind}", "unit": "rounding units", "values": [error]}
                for kind, error in zip(kinds, errors, strict=True)
            ]
    return rows


def run(quick: bool = False) -> list[dict[str, Any]]:
    """All tables."""
    segments, count, repeats = (12, 2_000, 1) if quick else (48, 100_000, 3)
    rows = table_of_primitives(segments, count, repeats)
    for name, make in (("spiral", curve), ("knot", knot)):
        rows += table_of_silhouettes(name, make, segments, count, repeats)
    rows += lost_hits(2_000 if quick else 100_000)
    rows += table_of_degrees(9 if quick else 33)
    return rows
