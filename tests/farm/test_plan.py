"""Which tasks of the farm count as finished: parts by what their files say, whole frames by their markers."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import pytest
from rayleaf import __version__
from rayleaf.parts import Cut, PartError, Parts, Share, Source, path_in, write

sys.path.append(str(Path(__file__).resolve().parents[2] / "python_addon" / "farm"))
import plan as plans  # noqa: E402
import run_task  # noqa: E402


@pytest.fixture
def plan(tmp_path):
    """One frame in two strips, each in two ranges of samples."""
    (tmp_path / "a.blend").write_bytes(b"file")
    content = plans.content_of(tmp_path / "a.blend")
    return plans.Plan(str(tmp_path / "a.blend"), content, __version__, str(tmp_path / "a"), [7], 2, 2)


def render(plan, version=__version__):
    """Files of all parts, as `rayleaf render` writes them."""
    for tile in (1, 2):
        for samples in (1, 2):
            cut = Cut(Share(tile, 2), Share(samples, 2))
            write(path_in(folder_of(plan), cut), Source(plan.content, 7, version), cut, [])


def folder_of(plan):
    return Path(f"{plan.picture(7)}.parts")


def finished(plan):
    return [plan.is_finished(part) for part in plan.parts()]


def test_a_part_is_finished_while_its_own_file_is_there_of_this_file_and_version(plan):
    assert plans.version_of_checkout() == __version__
    assert finished(plan) == [False] * 4
    render(plan)
    assert finished(plan) == [True] * 4
    assert finished(replace(plan, content="other")) == finished(replace(plan, version="other")) == [False] * 4
    assert not plan.is_finished(plan.merges()[0])
    paths = sorted(folder_of(plan).iterdir())
    paths[0].unlink()
    paths[1].write_bytes(paths[1].read_bytes()[:100])
    paths[2].write_bytes(b"no part")
    assert finished(plan) == [False, False, False, True]
    assert len(run_task.missing_parts(plan, 7)) == 3


def test_parts_are_not_needed_any_more_once_their_frame_is_merged(plan):
    marker = plan.marker(plan.merges()[0])
    marker.parent.mkdir(parents=True)
    marker.touch()
    assert finished(plan) == [False] * 4
    for ending in ("png", "exr"):
        Path(f"{plan.picture(7)}.{ending}").touch()
    assert finished(plan) == [True] * 4


def test_who_cannot_merge_says_which_version_rendered_the_parts(plan):
    render(plan, "0.0.1")
    assert run_task.missing_parts(plan, 7)[0] == "0007_tile-1-of-2_samples-1-of-2 (but by Rayleaf 0.0.1)"
    with pytest.raises(PartError, match=rf"this is Rayleaf {__version__}, others rendered .*\(0\.0\.1\)"):
        Parts(folder_of(plan), Source(plan.content, 7))


def test_a_node_with_another_version_renders_nothing(plan, capsys):
    assert run_task.run("/bin/false", replace(plan, version="0.0.1"), plan.parts()[0]) == 2
    assert "was submitted to Rayleaf 0.0.1" in capsys.readouterr().err


def test_a_plan_is_read_as_it_was_written(plan, tmp_path):
    plan.write(tmp_path / "plan.json")
    assert plans.read(tmp_path / "plan.json") == plan
    assert json.loads((tmp_path / "plan.json").read_text())["version"] == __version__
