"""Runs tests/bench/bench_*.py; started by `rayleaf bench`.

Each benchmark is a module with `run() -> list[dict]`: it checks its answers first (an assertion that fails ends that
benchmark), then measures, and returns rows {"name": what, "unit": of the values, "values": every single measurement}.
The first line of its docstring says what it measures. One with PRINTS_ITSELF prints its own tables. `run` may take
`quick`: small and once, to see that it works; and `small`: sizes at which the ratios already hold, in minutes. One with
`add_options(parser)` takes all words after its name, and `run` gets them as `options`; what is not given is as it says.
"""

import argparse
import importlib.util
import inspect
import json
import os
import platform
import statistics
import sys
import traceback
from pathlib import Path
from types import ModuleType
from typing import Any

HERE = Path(__file__).resolve().parent


def cases() -> dict[str, Path]:
    """The benchmarks by name."""
    return {path.stem.removeprefix("bench_"): path for path in sorted(HERE.glob("bench_*.py"))}


def load(path: Path) -> ModuleType:
    """Import a benchmark from its file."""
    spec = importlib.util.spec_from_file_location(path.stem, path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def table(rows: list[dict[str, Any]]) -> list[str]:
    """Rows as text: name, median, smallest and largest value, spread as a share of the median, count, unit."""
    width = max([len(row["name"]) for row in rows] + [4])
    lines = [f"  {'':<{width}}  {'median':>10}  {'least':>10}  {'most':>10}  {'spread':>6}  {'of':>3}"]
    for row in rows:
        values = row["values"]
        median = statistics.median(values)
        spread = (max(values) - min(values)) / median if median else 0.0
        numbers = "  ".join(f"{value:>10.4g}" for value in (median, min(values), max(values)))
        lines.append(f"  {row['name']:<{width}}  {numbers}  {spread:>6.0%}  {len(values):>3}  {row['unit']}")
    return lines


def machine() -> dict[str, Any]:
    """What the figures depend on."""
    from rayleaf.report.machine import processor  # on the path once `main` has set it

    return {
        "processor": processor(),
        "cores": os.cpu_count(),
        "load": os.getloadavg()[0],
        "python": platform.python_version(),
    }


def parser_of(name: str) -> argparse.ArgumentParser:
    """With what every benchmark can be asked for."""
    parser = argparse.ArgumentParser(prog=f"rayleaf bench{name}")
    parser.add_argument("--json", type=Path, help="writes every single measurement")
    parser.add_argument("--quick", action="store_true", help="small and once, where a case knows how: no measurement")
    return parser


def asked(words: list[str], known: dict[str, Path]) -> argparse.Namespace:
    """What the command line says. `options` are those of a case that has its own."""
    if words and words[0] in known and hasattr(module := load(known[words[0]]), "add_options"):
        parser = parser_of(f" {words[0]}")
        module.add_options(parser)
        own = parser.parse_args(words[1:])
        return argparse.Namespace(case=words[:1], json=own.json, quick=own.quick, small=False, list=False, options=own)
    parser = parser_of("")
    parser.add_argument("case", nargs="*", help="default: all")
    parser.add_argument("--small", action="store_true", help="small sizes, where a case knows how: minutes, not hours")
    parser.add_argument("--list", action="store_true", help="names the cases")
    parser.set_defaults(options=None)
    options = parser.parse_args(words)
    unknown = [name for name in options.case if name not in known]
    if unknown:
        parser.error(f"there is no case {', '.join(unknown)}; there are: {', '.join(known)}")
    return options


def arguments(module: ModuleType, options: argparse.Namespace) -> dict[str, Any]:
    """What a benchmark's `run` is called with. One with options of its own that is run among others gets their defaults."""
    given = {name: getattr(options, name) for name in inspect.signature(module.run).parameters}
    if "options" in given and given["options"] is None:
        parser = argparse.ArgumentParser()
        module.add_options(parser)
        given["options"] = parser.parse_args([])
    return given


def main() -> int:
    known = cases()
    addons = Path(os.environ["RAYLEAF_PACKAGE_DIR"])
    sys.path[:0] = [str(addons), str(addons.parents[1] / "rivals"), str(HERE)]
    options = asked(sys.argv[1:], known)
    if options.list:
        print("\n".join(known))
        return 0
    results: dict[str, Any] = {"machine": machine(), "cases": {}}
    print(
        f"{results['machine']['processor']}, {results['machine']['cores']} cores, load {results['machine']['load']:.1f}"
    )
    failed = []
    for name in options.case or known:
        module = load(known[name])
        print(f"\n{name}: {(module.__doc__ or '').strip().splitlines()[0]}", flush=True)
        try:
            rows = module.run(**arguments(module, options))
        except AssertionError:
            traceback.print_exc()
            failed.append(name)
            continue
        results["cases"][name] = rows
        if not getattr(module, "PRINTS_ITSELF", False):
            print("\n".join(table(rows)), flush=True)
    if options.json:
        options.json.write_text(json.dumps(results, indent=2) + "\n")
    if failed:
        print(f"\nwrong answers, therefore not timed: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
