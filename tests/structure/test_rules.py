"""Rules every source file keeps."""

import ast
import fnmatch

import pytest
from structure.sources import RIVALS, ROOT, bare_code, core_files, cpp_files, matches, python_files, text_files

ROOT_ENTRIES = {
    *("core", "rivals", "examples", "cmake", "python_addon", "tests", "blend_scenes", ".ci"),
    *("README.md", "LICENSE", "rayleaf", "CMakeLists.txt", "CMakePresets.json", "pyproject.toml"),
    *(".clang-format", ".clang-tidy", ".gitignore", ".git"),
}
LONGEST_FILE = 400  # lines; longer ones hold more than one concept
LONGEST_FUNCTION = 60  # lines
LONGEST_LINE = 140  # characters; formatters keep code to 120, tables and tests' texts may need more

# Functions that are longer for a reason: {"file:function": "reason"}.
LONG_FUNCTIONS: dict[str, str] = {}


def test_the_root_folder_holds_only_what_belongs_there():
    ignored = [line.strip("/") for line in (ROOT / ".gitignore").read_text().split() if not line.startswith("#")]
    names = {path.name for path in ROOT.iterdir()}
    strange = {name for name in names - ROOT_ENTRIES if not any(fnmatch.fnmatch(name, each) for each in ignored)}
    assert strange == set()


def test_the_core_never_prints_and_never_ends_the_process():
    pattern = (
        r"\b(cout|cerr|clog|stdout|stderr)\b|\b(f|v|vf)?printf\s*\(|\b(puts|fputs|putchar|perror|abort|_?exit|_Exit|quick_exit"
        r"|terminate|raise)\s*\(|\bassert\s*\("
    )
    assert matches(core_files() + cpp_files(RIVALS), pattern, bare=True) == []


def test_no_error_is_swallowed():
    swallowing = [
        str(path.relative_to(ROOT))
        for path in core_files() + cpp_files(RIVALS)
        if "catch(...){}" in "".join(bare_code(path.read_text()).split())
    ]
    assert swallowing == []


def test_the_add_on_reports_instead_of_printing():
    printing = []
    for path in python_files("python_addon/rayleaf"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and node.func.id == "print":
                printing.append(f"{path.relative_to(ROOT)}:{node.lineno}")
    assert printing == []


def test_names_that_users_give_are_read_as_text_whatever_their_bytes():
    """Blender's Python raises where a name is not UTF-8; names.py reads it. Own names are those of a Subject and of self."""
    given = {"name", "name_full", "uv_map", "layer_name", "attribute_name"}
    direct = []
    for path in python_files("python_addon/rayleaf/export"):
        for node in ast.walk(ast.parse(path.read_text())):
            if (
                isinstance(node, ast.Attribute)
                and node.attr in given
                and ast.unparse(node.value) not in ("subject", "self", "versions")
            ):
                direct.append(f"{path.relative_to(ROOT)}:{node.lineno}: {ast.unparse(node)}")
    assert direct == []


def test_nothing_is_left_for_later():
    words = ["TO" + "DO", "FIX" + "ME", "XX" + "X", "HA" + "CK"]
    assert matches(text_files(), r"\b(" + "|".join(words) + r")\b") == []


def test_no_file_is_too_long():
    lengths = {
        str(path.relative_to(ROOT)): path.read_text().count("\n") for path in text_files() if path.suffix != ".md"
    }
    del lengths["rayleaf"]  # one file on purpose: it must run before anything else is there
    del lengths["python_addon/rayleaf/_core.pyi"]  # one module, one stub
    assert {name: length for name, length in lengths.items() if length > LONGEST_FILE} == {}


def test_no_line_is_too_long():
    code = [path for path in text_files() if path.suffix in (".h", ".cpp", ".py", ".pyi") or path.name == "rayleaf"]
    assert matches(code, rf"^.{{{LONGEST_LINE + 1},}}$") == []


def test_no_python_function_is_too_long():
    long = {}
    for path in python_files("python_addon", "tests", "blend_scenes"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and node.end_lineno is not None:
                length = node.end_lineno - node.lineno + 1
                name = f"{path.relative_to(ROOT)}:{node.name}"
                if length > LONGEST_FUNCTION and name not in LONG_FUNCTIONS:
                    long[name] = length
    assert long == {}


def test_every_header_is_included_once():
    headers = [path for path in core_files() + cpp_files(RIVALS) if path.suffix == ".h"]
    assert [str(path) for path in headers if "#pragma once" not in path.read_text()] == []


def test_every_python_module_says_what_it_is_for():
    files = python_files("python_addon", "tests", "blend_scenes")
    assert [str(path) for path in files if not ast.get_docstring(ast.parse(path.read_text()))] == []


def test_every_test_checks_something():
    """A test without an assertion, an expected exception or a helper that asserts cannot fail."""
    silent = []
    for path in python_files("tests"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.FunctionDef) and node.name.startswith("test_"):
                source = ast.unparse(node)
                if not any(word in source for word in ("assert", "raises", "pytest.fail", "check_")):
                    silent.append(f"{path.relative_to(ROOT)}:{node.name}")
    assert silent == []


@pytest.mark.parametrize("kind", [".h", ".inl"])
def test_every_header_opens_with_what_it_is_for(kind):
    files = [path for path in core_files() + cpp_files(RIVALS) if path.suffix == kind]
    assert files
    silent = [str(path) for path in files if not path.read_text().startswith("//")]
    assert silent == []
