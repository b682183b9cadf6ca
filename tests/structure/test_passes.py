"""Core and add-on speak of the same passes."""

from rayleaf import passes


def test_the_add_on_reads_every_line_of_the_pass_table(root):
    lines = (root / "core" / "film" / "passes.def").read_text().splitlines()
    assert len(passes.table()) == sum(line.startswith("PASS(") for line in lines)


def test_the_core_takes_every_pass_of_the_table(core):
    names = [entry.identifier for entry in passes.table()]
    assert core.Settings(width=4, height=4, passes=names).passes == names


def test_no_two_passes_share_a_name_a_channel_or_a_switch():
    table = passes.table()
    for key in ("identifier", "name"):
        assert len({getattr(entry, key) for entry in table}) == len(table)
    assert all(len(set(entry.channels)) == len(entry.channels) <= 4 for entry in table)
