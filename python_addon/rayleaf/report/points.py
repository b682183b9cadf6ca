"""The settings that a report tries on a scene: one `Point` is one picture to render and judge."""

from dataclasses import dataclass, field
from typing import Any

# How Cycles is told to do just what was asked: so many samples in every pixel, nothing smoothed afterwards.
CYCLES_PLAIN = {
    "cycles.use_adaptive_sampling": False,
    "cycles.use_denoising": False,
    "cycles.device": "CPU",
    "render.use_persistent_data": False,
}


@dataclass(frozen=True)
class Point:
    """One setting of one sweep."""

    series: str  # what is swept
    label: str  # the value, as the report shows it
    engine: str = "RAYLEAF"
    assign: dict[str, Any] = field(default_factory=dict)  # property path from the scene -> value
    same_noise_as: str | None = None  # label of the point of the series with equal random numbers and no shortcut
    needs: str = ""  # a kind of shape, as the statistics name it: scenes without one are not rendered so
    told: dict[str, str] = field(default_factory=dict)  # name -> path of a property whose value the result repeats

    @property
    def name(self) -> str:
        return f"{self.series}: {self.label}"

    def as_job(self) -> dict[str, Any]:
        """What `render_points` reads."""
        return {key: getattr(self, key) for key in ("name", "engine", "assign", "told", "needs")}


def counted(count: int) -> str:
    """A number of samples in words."""
    return f"{count} sample" + ("s" if count > 1 else "")


def samples(counts: list[int]) -> list[Point]:
    """Paths per pixel, everything traced."""
    return [
        Point(
            "Samples",
            counted(count),
            assign={"rayleaf.samples": count, "rayleaf.ray_interpolation.mode": "OFF"},
        )
        for count in counts
    ]


def interpolation(errors: list[float], count: int) -> list[Point]:
    """Ray interpolation off, auto and on at several errors, with `count` samples and the same random numbers."""
    path = "rayleaf.ray_interpolation"
    common = {"rayleaf.samples": count, f"{path}.use_advanced": False}
    series = "Ray interpolation"
    points = [
        Point(series, "off", assign={**common, f"{path}.mode": "OFF"}),
        Point(series, "auto", assign={**common, f"{path}.mode": "AUTO"}, same_noise_as="off"),
    ]
    for error in errors:
        assign = {**common, f"{path}.mode": "ON", f"{path}.error": error}
        points.append(Point(series, f"on, error {error:g}", assign=assign, same_noise_as="off"))
    return points


def _label(value: Any) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value).replace("_", " ").lower()


def cached_facets(series: str, path: str, tried: list[Any], count: int, exact: Any) -> list[Point]:
    """A property of the geometry cache at several values, `count` samples, compared with `exact` at equal random numbers.

    All facets go through the cache."""
    return [
        Point(
            series,
            _label(value),
            assign={"rayleaf.samples": count, "rayleaf.facet_memory": 0.0, path: value},
            same_noise_as=None if value == exact else _label(exact),
        )
        for value in tried
    ]


# What hair and bevelled curves are rendered as, the exact first; and how finely, where that is by a detail: a hundred
# thousand tubes of hair must fit into memory.
PRIMITIVES = ("EXACT", "RIBBON", "SPHERES", "TRIANGLES", "QUADS", "EMBREE_ROUND")
PRIMITIVE_DETAIL = {"strands": 3, "bevelled_curves": 16}


def primitives(kind: str, count: int) -> list[Point]:
    """Every primitive for one kind of shape, with `count` samples and the same random numbers."""
    series = f"Primitive of {kind.replace('_', ' ')}"
    common = {"rayleaf.samples": count, "rayleaf.curve_detail": PRIMITIVE_DETAIL[kind]}
    return [
        Point(
            series,
            _label(primitive),
            assign={**common, "rayleaf.curve_primitive": primitive},
            same_noise_as=None if primitive == PRIMITIVES[0] else _label(PRIMITIVES[0]),
            needs=kind,
        )
        for primitive in PRIMITIVES
    ]


def cycles(counts: list[int]) -> list[Point]:
    """The same file in Cycles."""
    return [Point("Cycles", counted(count), "CYCLES", {**CYCLES_PLAIN, "cycles.samples": count}) for count in counts]


def reference(engine: str, count: int) -> Point:
    """What an engine converges to: many samples with other random numbers, no shortcut."""
    if engine == "CYCLES":
        return Point("Reference", "Cycles", engine, {**CYCLES_PLAIN, "cycles.samples": count, "cycles.seed": 7919})
    assign = {"rayleaf.samples": count, "rayleaf.seed": 7919, "rayleaf.ray_interpolation.mode": "OFF"}
    return Point("Reference", "Rayleaf", engine, assign)


# What whole frames beside Cycles are told of, to see that both engines were set alike: name -> Cycles' path, Rayleaf's.
_ALIKE = {
    "samples": ("cycles.samples", "rayleaf.samples"),
    "threads": ("render.threads", "render.threads"),
    "persistent data": ("render.use_persistent_data", "render.use_persistent_data"),
}
# Light path limits and what else is of the file: they are left as they are, and may differ.
_LIMITS = {
    "bounces": ("cycles.max_bounces", "rayleaf.max_bounces"),
    "diffuse bounces": ("cycles.diffuse_bounces", "rayleaf.diffuse_bounces"),
    "glossy bounces": ("cycles.glossy_bounces", "rayleaf.glossy_bounces"),
    "transmission bounces": ("cycles.transmission_bounces", "rayleaf.transmission_bounces"),
    "transparent bounces": ("cycles.transparent_max_bounces", "rayleaf.transparent_bounces"),
    "volume bounces": ("cycles.volume_bounces", "rayleaf.volume_bounces"),
    "filter glossy": ("cycles.blur_glossy", "rayleaf.filter_glossy"),
    "reflective caustics": ("cycles.caustics_reflective", "rayleaf.use_reflective_caustics"),
    "refractive caustics": ("cycles.caustics_refractive", "rayleaf.use_refractive_caustics"),
    "clamp of direct light": ("cycles.sample_clamp_direct", "rayleaf.clamp_direct"),
    "clamp of indirect light": ("cycles.sample_clamp_indirect", "rayleaf.clamp_indirect"),
    "filter width": ("cycles.filter_width", "rayleaf.filter_width"),
}
ALIKE, LIMITS = tuple(_ALIKE), tuple(_LIMITS)
INTERPOLATION_MODES = ("off", "auto", "on")


def _told(engine: str) -> dict[str, str]:
    own = {name: paths[engine == "RAYLEAF"] for name, paths in (_ALIKE | _LIMITS).items()}
    if engine == "CYCLES":
        return own | {path.removeprefix("cycles."): path for path in CYCLES_PLAIN if path.startswith("cycles.")}
    return own | {"integrator": "rayleaf.integrator", "interpolation": "rayleaf.ray_interpolation.mode"}


def contenders(count: int, modes: tuple[str, ...] = INTERPOLATION_MODES) -> list[Point]:
    """The same frame in Cycles and, in each mode of ray interpolation, in Rayleaf; all else as the file says."""
    found = [Point("Frame", "Cycles", "CYCLES", {**CYCLES_PLAIN, "cycles.samples": count}, told=_told("CYCLES"))]
    for mode in modes:
        assign = {"rayleaf.samples": count, "rayleaf.ray_interpolation.mode": mode.upper()}
        assign["render.use_persistent_data"] = CYCLES_PLAIN["render.use_persistent_data"]
        found.append(Point("Frame", f"Rayleaf, {mode}", assign=assign, told=_told("RAYLEAF")))
    return found
