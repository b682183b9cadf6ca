"""The report's page and points: self-contained, escaped, complete."""

import io

import numpy as np
from rayleaf.report import page, plots, points
from rayleaf.report.errors import compare
from rayleaf.report.measure import judge
from rayleaf.report.run_report import FULL, QUICK, tried_points
from rayleaf.report.source_figures import BY_BENCHMARK


def test_a_picture_of_the_page_is_a_png_that_others_can_read():
    from matplotlib.image import imread

    pixels = np.random.default_rng(2).integers(0, 255, (5, 7, 3), dtype=np.uint8)
    assert np.array_equal(np.round(imread(io.BytesIO(page.png(pixels))) * 255)[..., :3], pixels)


def test_rows_that_run_upwards_are_shown_the_right_way_up():
    linear = np.zeros((2, 1, 3))
    linear[1] = 1.0  # the upper row
    assert page.png(np.array([[[255, 255, 255]], [[0, 0, 0]]], np.uint8)) in _embedded(page.picture(linear, "up"))


def _embedded(figure):
    import base64

    return base64.b64decode(figure.split("base64,")[1].split("'")[0])


def test_the_page_asks_for_nothing_from_elsewhere_and_escapes_names():
    text = page.page("A <b> title", page.table(("a & b",), [("<script>",), (1.5,), (None,)]))
    assert "<script>" not in text and "&lt;script&gt;" in text and "a &amp; b" in text
    assert "http" not in text and "src=" not in text


def raw(folder, name, value, seconds):
    path = folder / f"{name}.npy"
    np.save(path, np.full((8, 8, 4), value, np.float32))
    return {"name": name, "seconds": [seconds], "memory_mb": 1.0, "picture": str(path), "statistics": {}}


def test_pictures_are_judged_against_their_engines_reference_and_their_own_noise(tmp_path):
    tried = points.interpolation([0.01], 4)
    references = [points.reference("RAYLEAF", 64)]
    results = [
        raw(tmp_path, tried[0].name, 0.5, 2.0),
        {"name": tried[1].name, "problem": "no such setting"},
        raw(tmp_path, tried[2].name, 0.6, 1.0),
        raw(tmp_path, references[0].name, 0.7, 9.0),
    ]
    found = judge(results, tried, references)
    assert found.problems == [f"{tried[1].name}: no such setting"]
    off, on = found.measured
    half, reference = (np.full((8, 8, 4), value, np.float32) for value in (0.5, 0.7))
    assert off.error == compare(half, reference) and off.shortcut is None
    assert round(on.shortcut.rmse, 6) == 0.1
    assert off.beaten_by == on.point.name and on.beaten_by == ""
    drawing = plots.frontier(found.measured)
    assert drawing.startswith("<svg") and on.point.label in drawing


def test_a_little_faster_in_a_single_run_beats_nothing(tmp_path):
    tried = points.samples([1, 4])
    references = [points.reference("RAYLEAF", 64)]
    times = {tried[0].name: 1.0, tried[1].name: 1.1, references[0].name: 9.0}
    for second, beaten in ((1.1, ""), (1.5, tried[0].name)):
        times[tried[1].name] = second
        results = [raw(tmp_path, name, 0.5, seconds) for name, seconds in times.items()]
        assert judge(results, tried, references).measured[1].beaten_by == beaten


def test_every_point_has_a_name_of_its_own_and_what_it_is_compared_with_is_there():
    for extent in (FULL, QUICK):
        tried = tried_points(extent)
        names = [point.name for point in tried]
        assert len(set(names)) == len(names)
        assert all(f"{p.series}: {p.same_noise_as}" in names for p in tried if p.same_noise_as)


def test_every_row_of_a_sources_table_is_as_long_as_its_head():
    tables = [table for each in BY_BENCHMARK.values() for table in each]
    assert tables and all(len(row) == len(table.head) for table in tables for row in table.rows)


def test_the_contents_lead_to_every_section():
    text = page.page("Title", "introduction", page.section("A & B", "<p>first</p>"), page.section("Part", level=3))
    assert text.index("introduction") < text.index("<nav>") < text.index("<p>first")
    assert text.count("<a href=") == 1 and "<h2 id='" in text
    link = text.split("<a href='#")[1].split("'")[0]
    assert f"<h2 id='{link}'>" in text
