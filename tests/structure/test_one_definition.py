"""Two types of one name in one namespace are undefined behaviour, and no compiler that sees one file can tell.

Where a member function of one is not inlined, the linker takes either's.
"""

import re
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[2]
OPENS = re.compile(r"namespace (?:([\w:]+) )?\{$")
CLOSES = re.compile(r"\}  // namespace")
TYPE = re.compile(r"(?:class|struct|union|enum class) (?:alignas\(\w+\) )?([\w:]+)[^;]*$")


def types_of(text: str) -> Iterator[str]:
    """The types that a file defines at the outermost level, with their namespaces; none of an unnamed one."""
    namespaces: list[str | None] = []
    for line in text.splitlines():
        if opened := OPENS.match(line):
            namespaces.append(opened[1])
        elif CLOSES.match(line):
            namespaces.pop()
        elif (found := TYPE.match(line)) and None not in namespaces:
            yield "::".join([*map(str, namespaces), found[1]])


def test_no_type_is_defined_twice_under_one_name():
    users = defaultdict(set)
    for source in sorted([*ROOT.glob("core/*/*.[ch]*"), *ROOT.glob("rivals/*.[ch]*")]):
        for name in types_of(source.read_text()):
            users[name].add(str(source.relative_to(ROOT)))
    assert len(users) > 300
    shared = {name: sorted(sources) for name, sources in users.items() if len(sources) > 1}
    assert not shared, f"rename one of each: {shared}"


def test_types_are_found():
    inner = "namespace {\n\nstruct Hidden {\n};\n\n}  // namespace\nstruct Part final : Whole {\n};\nstruct Part::Inner {\n};"
    text = f"namespace a {{\nnamespace b {{\n{inner}\n\nclass Later;\n}}  // namespace b\nenum class C : int {{ D }}\n"
    assert list(types_of(text)) == ["a::b::Part", "a::b::Part::Inner", "a::C"]
