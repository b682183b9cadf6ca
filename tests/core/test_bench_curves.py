"""The benchmark of curves runs, in small."""

import pytest
from benchmark_runs import run_quickly


@pytest.mark.slow
def test_the_benchmark_of_curves_prints_its_tables(root, addons, tmp_path):
    printed, measured = run_quickly("curves", root, addons, tmp_path)
    for title in (
        "swept patch",
        "Embree's round curve",
        "triangles, 32 sides",
        "equal silhouette error",
        "aimed at the axis",
    ):
        assert title in printed, printed
    rows = {(row["name"], row["unit"]): row["values"] for row in measured}
    assert max(rows["lost axis hits: round", "share"] + rows["lost axis hits: ribbon", "share"]) == 0
    assert rows["quads, 32 sides", "radii, median error"][0] < rows["quads, 8 sides", "radii, median error"][0]
    assert rows["degree 40, de Casteljau", "rounding units"][0] < 50


def test_the_benchmark_of_axes_finds_no_lost_ray(root, addons, tmp_path):
    printed, _ = run_quickly("axis", root, addons, tmp_path)
    assert "round strand, 1e+06" in printed and "touching itself" in printed, printed
