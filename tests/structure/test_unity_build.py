"""The preset `release` compiles several sources at once, so that what they keep to themselves shares one scope."""

import re
from collections import defaultdict
from pathlib import Path

ROOT = Path(__file__).parents[2]
UNNAMED = re.compile(r"^namespace \{\n(.*?)^\}  // namespace$", re.S | re.M)
CONSTANT = re.compile(r"\b(k[A-Z]\w*)\b(?= =|\[|\{)")
TYPE = re.compile(r"(?:class|struct|enum class|using) (\w+)")
FUNCTION = re.compile(r"(?!class |struct |using |template|enum)[\w:<>,&* ]+?[ &*](\w+)\((.*)")
PARAMETER_NAME = re.compile(r" \w+(?=[,)])")


def declared(line: str) -> list[str]:
    """The names that a line declares at the outermost level; a function's with the types of its first parameters."""
    if not line[:1].isalpha():
        return []
    names = CONSTANT.findall(line) if line.startswith("constexpr") else []
    if kind := TYPE.match(line):
        return [kind[1]]
    if not names and (function := FUNCTION.match(line)):
        names = [f"{function[1]}({PARAMETER_NAME.sub('', function[2])}"]
    return names


def unnamed_names(text: str) -> set[str]:
    return {name for part in UNNAMED.findall(text) for line in part.splitlines() for name in declared(line)}


def test_sources_declare_no_name_twice_in_unnamed_namespaces():
    users = defaultdict(list)
    for source in sorted((ROOT / "core").glob("*/*.cpp")):
        text = source.read_text()
        if "HWY_TARGET_INCLUDE" in text:
            continue  # compiled alone
        for name in unnamed_names(text):
            users[name].append(str(source.relative_to(ROOT)))
    shared = {name: sources for name, sources in users.items() if len(sources) > 1}
    assert not shared, f"rename, or share through a header: {shared}"


def test_names_are_found():
    constants, part = "constexpr int kMost = 6, kLeast = 1;", "struct Part {\n    int x;\n};"
    text = f"namespace {{\n\n{constants}\n{part}\nfloat mix(float a, float b) {{\n}}\n}}  // namespace\n"
    assert unnamed_names(text) == {"kMost", "kLeast", "Part", "mix(float, float) {"}
