"""The project's source files, as the structure tests read them."""

import re
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
CORE = ROOT / "core"
RIVALS = ROOT / "rivals"
ADDON = ROOT / "python_addon" / "rayleaf"


def cpp_files(folder: Path) -> list[Path]:
    """Headers, sources and tables."""
    return sorted(path for path in folder.rglob("*") if path.suffix in (".h", ".cpp", ".inl", ".def"))


def core_files() -> list[Path]:
    """Those of the core."""
    return cpp_files(CORE)


def python_files(*folders: str) -> list[Path]:
    """The Python files of those folders of the checkout."""
    return sorted(
        path for folder in folders for path in (ROOT / folder).rglob("*.py") if "__pycache__" not in path.parts
    )


def text_files() -> list[Path]:
    """Everything that people write and read."""
    files = (
        core_files()
        + cpp_files(RIVALS)
        + cpp_files(ROOT / "examples")
        + python_files("python_addon", "tests", "blend_scenes")
    )
    files += [ROOT / name for name in ("rayleaf", "CMakeLists.txt", "pyproject.toml", "CMakePresets.json")]
    return files + sorted(ROOT.glob("*.md")) + sorted(CORE.rglob("*.md")) + sorted(ADDON.rglob("*.pyi"))


TOKEN = re.compile(r'//[^\n]*|/\*.*?\*/|R"\((?:.*?)\)"|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'', re.DOTALL)


def bare_code(source: str) -> str:
    """C++ without what its comments and string literals say; line numbers stay."""

    def blank(match: re.Match[str]) -> str:
        text = match[0]
        return "\n" * text.count("\n") if text.startswith("/") else '""' + "\n" * text.count("\n")

    return TOKEN.sub(blank, source)


def matches(files: list[Path], pattern: str, *, bare: bool = False) -> list[str]:
    """Where a pattern occurs: "file:line: the line"; with `bare`, outside of C++ comments and strings."""
    found = []
    regex = re.compile(pattern)
    for path in files:
        text = path.read_text()
        lines = (bare_code(text) if bare else text).splitlines()
        for number, line in enumerate(lines, 1):
            if regex.search(line):
                found.append(f"{path.relative_to(ROOT)}:{number}: {line.strip()}")
    return found
