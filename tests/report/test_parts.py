"""Parts of a report that are kept: a report that was stopped goes on, and nothing old passes for new."""

import json
import shutil
import subprocess

import pytest
from rayleaf.report import parts
from rayleaf.report.parts import KeptParts, Part
from rayleaf.report.run_report import Planned, Report


def report(folder, circumstances="commit", **options):
    return Report(folder, "introduction", {"commit": "abc"}, circumstances, **options)


class Counted:
    """Makes a part and counts how often."""

    def __init__(self, text="made"):
        self.text, self.count = text, 0

    def __call__(self):
        self.count += 1
        return Part(f"<p>{self.text} {self.count}</p>", {"scenes": {self.text: [{"setting": self.text}]}})


def fails():
    raise RuntimeError("Blender ended with 11")


def test_a_report_that_was_stopped_goes_on_where_it_was(tmp_path):
    first, second = Counted("first"), Counted("second")
    stopped = report(tmp_path)
    stopped.add(Planned("First", first))
    resumed = report(tmp_path)
    for title, make in (("First", first), ("Second", second)):
        resumed.add(Planned(title, make))
    assert (first.count, second.count) == (1, 1)
    text = (tmp_path / "report.html").read_text()
    assert "first 1" in text and "second 1" in text
    figures = json.loads((tmp_path / "report.json").read_text())
    assert list(figures["scenes"]) == ["first", "second"] and list(figures["seconds"]) == ["First", "Second"]
    assert (tmp_path / "frontier.csv").read_text().splitlines()[1:] == ["first,first", "second,second"]


@pytest.mark.parametrize("circumstances", ["another commit", None])
def test_a_part_of_another_commit_or_of_an_unknown_one_is_made_anew(tmp_path, circumstances):
    made = Counted()
    report(tmp_path).add(Planned("First", made))
    report(tmp_path, circumstances).add(Planned("First", made))
    assert made.count == 2


def test_a_part_of_a_file_that_has_changed_is_made_anew(tmp_path):
    file, made = tmp_path / "scene.blend", Counted()
    for content, count in (("one", 1), ("one", 1), ("two", 2)):
        file.write_text(content)
        report(tmp_path).add(Planned("Scene", made, file))
        assert made.count == count


def test_one_part_is_made_again_and_the_others_are_shown_as_they_are(tmp_path):
    one, other = Counted("one"), Counted("other")
    for options, counts in (({}, (1, 1)), ({"only": ["one"]}, (2, 1)), ({"again": True}, (3, 2))):
        page = report(tmp_path, **options)
        page.add(Planned("One", one))
        page.add(Planned("Other", other))
        assert (one.count, other.count) == counts
        assert list(page.parts) == ["One", "Other"]


def test_a_part_that_fails_says_so_leaves_the_others_and_is_tried_again(tmp_path):
    page, made = report(tmp_path), Counted()
    page.add(Planned("First", fails))
    page.add(Planned("Second", made))
    text = (tmp_path / "report.html").read_text()
    assert page.failed == {"First": "Blender ended with 11"} and "Blender ended with 11" in text and "made 1" in text
    again = report(tmp_path)
    again.add(Planned("First", made))
    assert made.count == 2 and not again.failed


def test_a_part_whose_file_was_broken_off_is_made_anew(tmp_path):
    kept = KeptParts(tmp_path)
    kept.keep("part", "mark", Part("<p>whole</p>"))
    assert kept.find("part", "mark").html == "<p>whole</p>" and kept.find("part", "another") is None
    (tmp_path / parts.FOLDER / "part.json").write_text('{"mark": "mark", "pa')
    assert kept.find("part", "mark") is None


@pytest.mark.skipif(shutil.which("git") is None, reason="Git is not installed")
def test_a_commit_and_what_differs_from_it_tell_two_states_of_the_sources_apart(tmp_path):
    def git(*command):
        subprocess.run(["git", "-C", str(tmp_path), *command], check=True, capture_output=True)

    assert parts.state(tmp_path) is None, "no clone"
    git("init")
    git("config", "user.email", "a@b")
    git("config", "user.name", "a")
    states = []
    for content, commit in (("one", True), ("two", False), ("three", False), ("one", False)):
        (tmp_path / "file").write_text(content)
        if commit:
            git("add", "file")
            git("commit", "-m", content)
        states.append(parts.state(tmp_path))
    assert states[0] == states[3] and len(set(states)) == 3
