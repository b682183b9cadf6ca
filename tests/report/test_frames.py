"""Whole frames beside Cycles: what the table computes, what stands side by side, what is kept."""

import json
from dataclasses import asdict, replace

import numpy as np
import pytest
from rayleaf.report import converged, frame_scenes, frame_table, frames, points
from rayleaf.report.errors import compare
from rayleaf.report.frames import Frame, Plan, Ruler, check_alike, different_limits
from rayleaf.report.measure import Conditions
from rayleaf.report.parts import Part
from rayleaf.report.run_report import Planned, Report

TOLD = {"samples": 16, "threads": 2, "persistent data": False, **dict.fromkeys(points.LIMITS, 4)}

BLENDERS = "Error: script failed, file: 'render_points.py', exiting."


def frame(engine, seconds, error, contender=None, **told):
    return Frame(
        *("sheet", 16, contender or engine.title(), engine),
        first=[seconds + 1, seconds + 2],
        second=[seconds, seconds + 0.5],
        memory_mb=10.0,
        rmse=error,
        size=(40, 30),
        told=TOLD | told,
    )


def cells(frames_of_scene):
    return [dict(zip(frame_table.HEAD, row, strict=True)) for row in frame_table.rows(frames_of_scene)]


def test_the_ratio_is_cycles_time_over_ours_and_at_equal_error_that_times_the_squared_ratio_of_errors():
    cycles, ours = cells([frame("CYCLES", 1.0, 0.01), frame("RAYLEAF", 2.0, 0.02)])
    assert (ours["first, s"], ours["second, s"]) == (3.0, 2.0), "the least of all rounds"
    assert ours["first, ratio"] == pytest.approx(2 / 3) and ours["second, ratio"] == 0.5
    # Twice the error takes four times the samples to mend.
    assert ours["ratio at equal error"] == pytest.approx(0.5 / 4)
    assert cycles["second, ratio"] is None and cycles["ratio at equal error"] is None


def test_pictures_of_different_things_have_no_ratio_at_equal_error():
    for error, distance, shown, lines in ((0.02, 0.09, 0.125, 0), (0.02, 0.5, None, 1), (0.6, 0.5, 0.5 / 3600, 0)):
        pair = [frame("CYCLES", 1.0, 0.01), replace(frame("RAYLEAF", 2.0, error), from_cycles=distance)]
        assert (
            cells(pair)[1]["ratio at equal error"] == (shown and pytest.approx(shown))
            and cells(pair)[1]["from Cycles"] == distance
        )
        assert len(frame_table.remarks(pair)) == lines


def test_what_is_not_known_is_left_empty_and_says_why():
    failed = Frame("sheet", 16, "Rayleaf, on", "RAYLEAF", problem=f"Blender ended with 1:\nout of memory\n\n{BLENDERS}")
    spared = [frame("CYCLES", 1.0, 0.0), frame("RAYLEAF", 2.0, 0.1), failed]
    _, ours, empty = cells(spared)
    assert ours["ratio at equal error"] is None, "a picture without noise has no equal"
    assert set(empty.values()) == {"sheet", 16, "Rayleaf, on", None}
    assert frame_table.remarks(spared) == ["sheet, 16 samples, Rayleaf, on: out of memory"]
    alone = [replace(failed, contender="Cycles", engine="CYCLES"), frame("RAYLEAF", 2.0, 0.1)]
    assert cells(alone)[1]["second, s"] == 2.0 and cells(alone)[1]["second, ratio"] is None


def test_the_printed_table_has_a_line_for_each_frame_under_its_head():
    printed = frame_table.text_lines([frame_table.HEAD, *frame_table.rows([frame("CYCLES", 1.0, 0.01)])], 5)
    assert all(name in printed[0] for name in frame_table.HEAD)
    assert printed[1].split() == ["sheet", "16", "Cycles", "2.00", "1.00", "–", "–", "0.0100", "–", "–", "10"]
    for word in ("16", "1.00", "0.0100"):  # numbers end where their heads do
        column = {"16": "samples", "1.00": "second, s", "0.0100": "error"}[word]
        head = printed[0].index(column) + len(column)
        assert printed[1].index(f" {word}") + len(word) + 1 == head, (word, printed)


@pytest.mark.parametrize("name", points.ALIKE)
def test_frames_that_were_not_set_alike_are_refused_by_name(name):
    pair = [frame("CYCLES", 1.0, 0.1), frame("RAYLEAF", 1.0, 0.1, **{name: 99})]
    with pytest.raises(RuntimeError, match=f"{name} 99"):
        check_alike(pair)
    check_alike(pair[:1] * 2)


def test_frames_of_different_sizes_are_refused():
    with pytest.raises(RuntimeError, match="pixels"):
        check_alike([frame("CYCLES", 1.0, 0.1), replace(frame("RAYLEAF", 1.0, 0.1), size=(41, 30))])


def test_limits_in_which_a_file_differs_between_the_engines_are_named():
    pair = [frame("CYCLES", 1.0, 0.1), frame("RAYLEAF", 1.0, 0.1, **{"glossy bounces": 6}, integrator="DISTRIBUTION")]
    assert different_limits(pair) == ["glossy bounces 4 / 6"]
    limits, integrator = frame_table.remarks(pair)
    assert "glossy bounces 4 / 6" in limits and "distributes rays" in integrator
    assert different_limits(pair[:1]) == []


def test_the_engines_are_asked_for_the_same_and_only_interpolation_differs():
    cycles, *own = points.contenders(16)
    assert cycles.assign["cycles.samples"] == 16 and cycles.assign["cycles.use_denoising"] is False
    assert [point.assign["rayleaf.ray_interpolation.mode"] for point in own] == ["OFF", "AUTO", "ON"]
    assert {point.assign["rayleaf.samples"] for point in own} == {16}
    assert all(set(points.ALIKE + points.LIMITS) <= set(point.told) for point in (cycles, *own))


class Renders:
    """In place of Blender: counts renders, and answers with pictures of one value."""

    def __init__(self, value=0.5):
        self.value, self.asked = value, []

    def __call__(self, blender, file, points_of_job, conditions, folder):
        (point,) = points_of_job
        self.asked.append((point.engine, conditions))
        path = folder / "picture.npy"
        np.save(path, np.full((8, 8, 4), self.value, np.float32))
        seconds, processor = [2.0, 1.0][: conditions.repeats], [4.0, 2.0][: conditions.repeats]
        told = TOLD | {"samples": point.assign[f"{point.engine.lower()}.samples"]}
        times = {"seconds": seconds, "processor_seconds": processor}
        return [{"name": point.name, **times, "memory_mb": 5.0, "picture": str(path), "told": told}]


@pytest.fixture
def scene(tmp_path):
    path = tmp_path / "sheet.blend"
    path.write_text("a scene")
    return path


def kept_pictures(folder, **options):
    return converged.ConvergedPictures("/bin/true", folder, Conditions(percentage=50), **options)


def test_a_converged_picture_is_made_once_for_a_file_an_engine_a_size_and_a_number_of_samples(
    scene, tmp_path, monkeypatch
):
    made = Renders()
    monkeypatch.setattr(converged, "render", made)
    for count, engine, expected in ((64, "RAYLEAF", 1), (64, "RAYLEAF", 1), (64, "CYCLES", 2), (128, "CYCLES", 3)):
        assert np.all(kept_pictures(tmp_path).picture(scene, engine, count) == 0.5)
        assert len(made.asked) == expected
    scene.write_text("another scene")
    kept_pictures(tmp_path).picture(scene, "CYCLES", 128)
    assert len(made.asked) == 4
    small = converged.ConvergedPictures("/bin/true", tmp_path, Conditions(percentage=25))
    small.picture(scene, "CYCLES", 128)
    assert len(made.asked) == 5
    anew = kept_pictures(tmp_path, again=True)
    for _ in range(2):
        anew.picture(scene, "CYCLES", 128)
    assert len(made.asked) == 6


def test_every_round_takes_turns_in_a_cold_blender_of_its_own(scene, tmp_path, monkeypatch):
    timed, references = Renders(0.5), Renders(0.25)
    monkeypatch.setattr(frames, "render", timed)
    monkeypatch.setattr(converged, "render", references)
    plan = Plan(counts=(1, 4), percentage=50, threads=2, rounds=2, modes=("off", "on"))
    first, second = Ruler("/bin/true", plan, kept_pictures(tmp_path)).scene(scene)
    assert [engine for engine, _ in timed.asked] == ["CYCLES", "RAYLEAF", "RAYLEAF"] * 4
    assert all(each.cold and each.repeats == 2 and each.threads == 2 for _, each in timed.asked)
    assert len(references.asked) == 2 and plan.converged_count == 16
    assert [each.samples for each in (*first, *second)] == [1] * 3 + [4] * 3
    assert first[0].first == [2.0, 2.0] and first[0].second == [1.0, 1.0]
    picture = np.full((8, 8, 4), 0.5, np.float32)
    assert first[1].rmse == compare(picture, picture / 2).rmse
    assert [each.from_cycles for each in first] == [None, 0.0, 0.0]
    assert Frame(**json.loads(json.dumps(asdict(first[1])))).rmse == first[1].rmse


def test_processor_time_stands_in_the_place_of_time_that_passes(scene, tmp_path, monkeypatch):
    monkeypatch.setattr(frames, "render", Renders())
    monkeypatch.setattr(converged, "render", Renders())
    for wanted, expected in ((False, 2.0), (True, 4.0)):
        plan = Plan(counts=(1,), processor_time=wanted)
        (found,) = Ruler("/bin/true", plan, kept_pictures(tmp_path)).scene(scene)
        assert {each.first[0] for each in found} == {expected}
        assert ("processor time" in frame_table.caption(plan)) == wanted


def test_of_an_orbit_the_first_and_the_last_frame_count(scene, tmp_path, monkeypatch):
    timed, references = Renders(), Renders()

    def of_four_frames(*arguments):
        (raw,) = timed(*arguments)
        return [raw | {"seconds": [4.0, 3.0, 2.0, 1.0]}]

    monkeypatch.setattr(frames, "render", of_four_frames)
    monkeypatch.setattr(converged, "render", references)
    plan = Plan(counts=(1,), orbit=4)
    by = frames.ruler("/bin/true", plan, tmp_path, lambda line: None)
    (found,) = by.scene(scene)
    assert {(each.first[0], each.second[0]) for each in found} == {(4.0, 1.0)}
    assert {asked.orbit for _, asked in timed.asked + references.asked} == {4}
    assert {asked.repeats for _, asked in references.asked} == {1}, "of the last frame alone"
    assert "frame 4" in frame_table.caption(plan)


def test_an_engine_that_fails_leaves_the_others_in_the_table(scene, tmp_path, monkeypatch):
    timed = Renders()

    def fails_with_rays_interpolated(blender, file, points_of_job, conditions, folder):
        if points_of_job[0].label == "Rayleaf, on":
            raise RuntimeError("Blender ended with 11")
        return timed(blender, file, points_of_job, conditions, folder)

    monkeypatch.setattr(frames, "render", fails_with_rays_interpolated)
    monkeypatch.setattr(converged, "render", Renders())
    (found,) = Ruler("/bin/true", Plan(counts=(1,), rounds=2), kept_pictures(tmp_path)).scene(scene)
    assert [each.problem for each in found] == ["", "", "", "Blender ended with 11"]
    assert len(timed.asked) == 6


def test_a_large_scene_is_made_once_for_what_its_script_says(tmp_path, monkeypatch):
    made = []

    def write(blender, script, folder, words=()):
        made.append(script)
        path = folder / "hall.blend"
        path.write_text("made")
        return path

    monkeypatch.setattr(frame_scenes, "built", write)
    script, helpers = tmp_path / "make_hall.py", tmp_path / "helpers"
    helpers.mkdir()
    for words, count in (("one", 1), ("one", 1), ("two", 2)):
        script.write_text(words)
        file = frame_scenes.kept("/bin/true", script, helpers, tmp_path / "scenes")
        assert file.read_text() == "made" and len(made) == count
    (helpers / "scene_tools.py").write_text("helper")
    frame_scenes.kept("/bin/true", script, helpers, tmp_path / "scenes")
    assert len(made) == 3


def test_the_reports_first_table_is_of_whole_frames(tmp_path):
    pair = [asdict(frame("CYCLES", 1.0, 0.01)), asdict(frame("RAYLEAF", 2.0, 0.02, "Rayleaf, off"))]
    shown = Report(tmp_path, "introduction", {}, None, plan=Plan(counts=(16,)))
    shown.add(Planned("Sheet", lambda: Part("<table>of the sheet</table>")))
    assert "Whole frames beside Cycles" not in (tmp_path / "report.html").read_text()
    shown.add(Planned("Frames: sheet", lambda: Part("", {"frames": {"sheet": json.loads(json.dumps(pair))}})))
    text = (tmp_path / "report.html").read_text()
    assert text.index("Rayleaf, off") < text.index("of the sheet")
    assert all(f"<th>{name}</th>" in text for name in frame_table.HEAD)
    assert json.loads((tmp_path / "report.json").read_text())["frames"]["sheet"][1]["second"] == [2.0, 2.5]
