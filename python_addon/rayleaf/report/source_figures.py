"""Figures that the sources printed, to stand beside ours. Each says where it is from and why it may not be compared.

RI: Atalay & Mount, Interpolation over Light Fields with Applications in Computer Graphics. MGC: Christensen, Laur, Fong,
Wooten, Batali, Ray Differentials and Multiresolution Geometry Caching for Distribution Ray Tracing in Complex Scenes
(2003). BEZ: a student report on Bezier curves and surfaces as ray-traced primitives.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class SourceTable:
    """A table as printed; columns beside its rows."""

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str | float, ...], ...]
    remark: str


RI_TABLE_1 = SourceTable(
    "RI table 1: tomatoes, 1200 x 900, one sample",
    ("distance", "angle (degrees)", "depth", "speed-up, FLOPs", "speed-up, CPU", "error", "MB"),
    ((0.25, 30, 28, 2.65, 1.89, 0.00482, 34), (0.05, 10, 28, 2.40, 1.63, 0.00190, 47)),
    "Their scene and machine are not to be had; distances are in units of their scenes.",
)

RI_TABLE_2_DISTANCE = SourceTable(
    "RI table 2, distance threshold (figure 5)",
    ("scene", "distance", "speed-up, FLOPs", "speed-up, CPU", "error", "MB"),
    (
        ("Bezier surface", 0.01, 3.127, 1.965, 0.00377, 2.925),
        ("Bezier surface", 0.05, 3.745, 2.077, 0.00676, 1.931),
        ("Bezier surface", 0.1, 4.083, 2.247, 0.0103, 1.549),
        ("Bezier surface", 0.25, 4.521, 2.346, 0.01867, 1.185),
        ("random volumes, rays", 0.01, 3.122, 2.635, 0.00627, 19.252),
        ("random volumes, rays", 0.05, 3.405, 2.719, 0.00679, 15.799),
        ("random volumes, rays", 0.1, 3.569, 2.792, 0.00780, 14.088),
        ("random volumes, rays", 0.25, 3.803, 2.919, 0.01076, 12.094),
        ("random volumes, lengths", 0.05, 2.951, 2.428, 0.00850, 11.773),
        ("random volumes, lengths", 0.15, 3.310, 2.673, 0.01179, 9.503),
        ("random volumes, lengths", 0.25, 3.550, 2.814, 0.01488, 8.344),
    ),
    "600 x 600, angle 30 degrees, depth 28. Speed-up over their own tracer of 2003, by Newton iteration or the like.",
)

RI_TABLE_2_DEPTH = SourceTable(
    "RI table 2, tree depth (figure 7)",
    ("scene", "depth", "speed-up, FLOPs", "speed-up, CPU", "error", "MB"),
    (
        ("Bezier surface", 22, 3.505, 2.056, 0.02098, 0.565),
        ("Bezier surface", 25, 4.032, 2.175, 0.01032, 1.084),
        ("Bezier surface", 28, 3.745, 2.077, 0.00676, 1.931),
        ("Bezier surface", 30, 3.360, 1.974, 0.00653, 2.629),
        ("random volumes, rays", 22, 3.105, 2.565, 0.01859, 3.729),
        ("random volumes, rays", 25, 3.854, 2.904, 0.01449, 6.560),
        ("random volumes, rays", 28, 3.803, 2.919, 0.01076, 12.094),
        ("random volumes, rays", 30, 3.340, 2.732, 0.00987, 17.413),
    ),
    "Distance 0.05 (surface), 0.25 (volumes).",
)

RI_TABLE_2_ANGLE = SourceTable(
    "RI table 2, angular threshold (figure 6)",
    ("scene", "angle (degrees)", "speed-up, FLOPs", "speed-up, CPU", "error"),
    (
        ("Bezier surface", 5, 2.681, 1.682, 0.00424),
        ("Bezier surface", 15, 3.686, 2.117, 0.00663),
        ("Bezier surface", 30, 3.745, 2.077, 0.00676),
        ("random volumes, rays", 5, 2.563, 2.154, 0.00478),
        ("random volumes, rays", 15, 3.709, 2.840, 0.01007),
        ("random volumes, rays", 30, 3.803, 2.919, 0.01076),
        ("random volumes, lengths", 15, 3.215, 2.627, 0.01340),
        ("random volumes, lengths", 30, 3.550, 2.814, 0.01488),
    ),
    "300 x 300 with antialiasing for the volumes.",
)

MGC_CACHE_SIZES = SourceTable(
    "MGC section 6.3.2: chrome and colour bleeding, recomputed vertices by cache size",
    (
        "cache",
        "single resolution: misses, hit rate, vertices",
        "multiresolution: misses (coarse + medium + fine); vertices",
    ),
    (
        ("100 MB", "100 k, 99.4 %, 29 M", "0; 0"),
        ("30 MB", "350 k, 98.0 %, 100 M", "0 + 84 + 180; 54 k"),
        ("10 MB", "700 k, 96.1 %, 200 M", "21 k + 770 + 2.3 k; 770 k"),
        ("3 MB", "1.2 M, 93.3 %, 350 M", "180 k + 16 k + 7.3 k; 3.2 M"),
        ("1 MB", "1.7 M, 90.5 %, 490 M", "470 k + 39 k + 20 k; 8.6 M"),
    ),
    "183,000 subpatches; their creatures are not to be had.",
)

MGC_HIT_RATES = SourceTable(
    "MGC sections 6.2 and 6.3: lookups, hit rates and recomputed vertices at 30 MB",
    (
        "scene",
        "fully tessellated",
        "single resolution: lookups, misses, hit rate, vertices",
        "multiresolution: lookups (coarse + medium + fine), misses, hit rates, vertices",
    ),
    (
        (
            "parking lot, shiny cars: 940,000 subpatches",
            "270 M vertices, 3.3 GB",
            "100 M, 1.3 M, 98.7 %, 360 M",
            "35 + 23 + 41 M, 7.1 k + 3.3 k + 14 k, 99.97 to 99.99 %, 6.2 M",
        ),
        (
            "the same on ground with ambient occlusion",
            "270 M vertices, 3.3 GB",
            "1.2 G, 30 M, 97.5 %, 8.7 G",
            "950 + 190 + 120 M, 1.6 M + 4.5 k + 13 k, 99.8 to 99.99 %, 10 M",
        ),
        (
            "dragons, chrome and colour bleeding: 183,000 subpatches",
            "53 M vertices, 630 MB",
            "350 k misses, 98.0 %, 100 M",
            "0 + 84 + 180 misses; 54 k",
        ),
    ),
    "A fine grid has 17 x 17 vertices. The tree over the subpatches takes some 35 MB there; ours is printed above with "
    "cache and records.",
)

BEZ_TABLE_3_4_1 = SourceTable(
    "BEZ table 3.4.1: rendering time with a lamp",
    ("primitive", "time"),
    (
        ("Bezier curve as spheres", "3 min 4 s"),
        ("Bezier curve as triangles", "55 min 8 s"),
        ("Bezier curve as quadrilaterals", "43 min 58 s"),
        ("Bezier surface", "7 min 8 s"),
    ),
    "No acceleration structure, another machine; its order of primitives is what can be compared.",
)

BY_BENCHMARK: dict[str, tuple[SourceTable, ...]] = {
    "rays": (RI_TABLE_1, RI_TABLE_2_DISTANCE, RI_TABLE_2_ANGLE, RI_TABLE_2_DEPTH),
    "geometry": (MGC_HIT_RATES, MGC_CACHE_SIZES),
    "curves": (BEZ_TABLE_3_4_1,),
    "target": (),  # no other engine's
}
