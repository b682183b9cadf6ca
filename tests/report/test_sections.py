"""The parts of the report that are about the project: stability, the sources' figures and pictures."""

import numpy as np
import pytest
from rayleaf.report import gallery, source_curves, source_pictures, stability
from rayleaf.report.source_figures import RI_TABLE_2_DISTANCE


def check(case, measured, bound, quantity="position"):
    return {"case": case, "quantity": quantity, "measured": measured, "bound": bound, "unit": "sizes"}


def test_checks_of_one_kind_become_one_row_that_names_the_worst():
    lines = [
        check("bicubic, offset 0, scale 1", 1e-9, 1e-6),
        check("bicubic, offset 1000, scale 1", 5e-7, 1e-6),
        check("cusp, offset 0, scale 1", 0.0, 0.0, "rays lost at 0.5 rad"),
    ]
    bicubic, cusp = stability.families(lines)
    assert (bicubic.case, bicubic.count, bicubic.failed) == ("bicubic", 2, 0)
    assert (bicubic.worst, bicubic.place) == (5e-7, "offset 1000, scale 1") and abs(bicubic.share - 0.5) < 1e-12
    assert (cusp.quantity, cusp.share, cusp.failed) == ("rays lost", 0.0, 0)


def test_what_is_beyond_its_bound_is_counted_and_stands_out():
    lines = [check("leak", 3.0, 0.0, "rays that leaked"), check("leak", 0.0, 0.0, "rays that leaked")]
    (family,) = stability.families(lines)
    assert family.failed == 1 and family.share == float("inf")
    assert "1 beyond their bound" in stability.section(lines, "2 passed")


def test_the_growth_of_errors_is_drawn_from_chains_of_hits():
    lines = [check(f"mirror ball, {hits} hits", 1e-6 * hits, 1e-5 * hits**2, "direction") for hits in (2, 8, 64)]
    lines.append(check("glass rod, 4 interior hits", 0.0, 1e-3, "exit direction"))
    curves, bounds = stability.growth(lines)
    assert [x for x, _ in curves["mirror ball"]] == [2.0, 8.0, 64.0] and curves["glass rod"] == [(4.0, 1e-16)]
    assert bounds["glass rod, bound"] == [(4.0, 1e-3)]
    assert "<svg" in stability.section(lines, "3 passed")
    assert stability.growth([check("cusp", 0.0, 1.0)]) == ({}, {})


def test_a_sweep_of_the_benchmark_becomes_the_sources_figure():
    rows = [
        {"name": f"table 2|sheet|distance|{x}|fast|{quantity}", "unit": "", "values": [x * 2]}
        for x in (0.01, 0.05, 0.25)
        for quantity in ("CPU over Newton", "error", "MB")
    ]
    rows.append({"name": "sheet, 600 x 600: fast, first frame", "unit": "s", "values": [1.0]})
    assert source_curves.curves(rows)["distance", "MB"] == {"sheet, fast": [(0.01, 0.02), (0.05, 0.1), (0.25, 0.5)]}
    drawn = source_curves.figures(rows)
    assert "RI figure 5" in drawn and "RI figure 6" not in drawn
    theirs = source_curves.printed(RI_TABLE_2_DISTANCE, "MB")["Bezier surface, as printed"]
    assert theirs[0] == (0.01, 2.925) and "Bezier surface, as printed" in drawn
    assert source_curves.figures([]) == ""


def test_the_sources_pictures_stand_beside_their_mask_and_their_difference():
    traced = np.full((4, 6, 4), 0.5, np.float32)
    shown = source_pictures.figures(traced, traced, np.ones((4, 6, 3)))
    assert shown.count("<img") == 4 and "mask" in shown
    assert source_pictures.figures(traced, traced, None).count("<img") == 3


def test_channels_of_a_file_come_in_the_order_that_people_mean(tmp_path):
    """A writer may sort them by name, a reader by meaning."""
    oiio = pytest.importorskip("OpenImageIO")
    path = tmp_path / "layers.exr"
    meant = {"Combined.R": 1, "Combined.G": 2, "Combined.B": 3, "Combined.A": 4, "Normal.X": 5, "Normal.Y": 6}
    meant |= {"Normal.Z": 7, "UV.U": 8, "UV.V": 9, "UV.A": 10, "Depth.Z": 11}
    for names in (sorted(meant), list(meant)):
        spec = oiio.ImageSpec(2, 2, len(names), "float")
        spec.channelnames = tuple(f"View Layer.{name}" for name in names)
        output = oiio.ImageOutput.create(str(path))
        assert output.open(str(path), spec)
        output.write_image(np.broadcast_to(np.array([meant[name] for name in names], np.float32), (2, 2, len(names))))
        output.close()
        layers = gallery.read_layers(path)
        found = {name: list(values[0, 0]) for name, values in layers.items()}
        assert found == {"Combined": [1, 2, 3, 4], "Normal": [5, 6, 7], "UV": [8, 9, 10], "Depth": [11]}
