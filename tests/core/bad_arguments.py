"""What every bound function is called with: a call that holds, and then the same with one argument spoilt.

Run as a program it makes the calls, one after the other, and says before each which one it is: a crash has a name then.
The parameters and their kinds come from the stub, those of submodules, which it does not list, from the module.
"""

import ast
import contextlib
import inspect
import os
import re
import signal
import sys
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

import rayleaf_rivals
from rayleaf import _core
from core.good_arguments import Call, scene, settings
from core.good_bench_calls import BENCH_CALLS
from core.good_calls import CALLS as STUB_CALLS
from structure.test_stub import STUB, signatures_in, split_parameters, stub_members

# What a mistake may raise: nothing that speaks of the bindings' or the interpreter's own trouble.
CLEAN = (TypeError, ValueError, IndexError, KeyError, OverflowError, MemoryError)
SECONDS = 60

Spoilt = tuple[str, Any, bool]  # how, the value, whether it is as good as the right one


CALLS = STUB_CALLS | BENCH_CALLS

# --- what exists ---------------------------------------------------------------------------------------------------


def stub_parameters(function: ast.FunctionDef) -> dict[str, str]:
    """Name -> annotation."""
    arguments = function.args
    every = arguments.posonlyargs + arguments.args + arguments.kwonlyargs
    return {each.arg: ast.unparse(each.annotation) for each in every if each.arg != "self" and each.annotation}


def bound_in_stub() -> Iterator[tuple[str, dict[str, str]]]:
    """Functions, methods and constructors of the module itself."""
    for name, nodes in stub_members(STUB.body).items():
        node = nodes[0]
        if isinstance(node, ast.FunctionDef):
            yield name, stub_parameters(node)
        if not isinstance(node, ast.ClassDef) or name == "InputError":
            continue
        members = [each for each in node.body if isinstance(each, ast.FunctionDef)]
        for member in members:
            if any(ast.unparse(each) == "property" for each in member.decorator_list):
                continue
            yield name if member.name == "__init__" else f"{name}.{member.name}", stub_parameters(member)


def documented_parameters(function: Any, name: str) -> dict[str, str]:
    """The same from what pybind11 writes: of all overloads together."""
    text = inspect.getdoc(function) or ""
    found = {}
    for match in re.finditer(rf"^(?:\d+\. )?{re.escape(name)}\((.*)\) -> ", text, re.MULTILINE):
        for part in split_parameters(match[1]):
            identifier, _, annotation = part.partition(":")
            if annotation and not identifier.startswith("*") and identifier != "self":
                found[identifier.strip()] = annotation
    return found


def bound_in_submodules() -> Iterator[tuple[str, dict[str, str]]]:
    """Those of modules without a stub."""
    modules = {name: getattr(_core, name) for name in ("distribution", "ri_tree", "shading", "trace")}
    for module_name, module in {**modules, "rivals": rayleaf_rivals}.items():
        for name, value in sorted(vars(module).items()):
            where = f"{module_name}.{name}"
            if inspect.isbuiltin(value):
                yield where, documented_parameters(value, name)
            if not isinstance(value, type) or hasattr(value, "__members__"):
                continue
            for member, method in vars(value).items():
                if isinstance(method, property) or not callable(method) or member == "__new__":
                    continue
                if member == "__init__":
                    parameters = documented_parameters(method, member)
                    if parameters or signatures_in(inspect.getdoc(method) or "", member):
                        yield where, parameters
                elif not member.startswith("_"):
                    yield f"{where}.{member}", documented_parameters(method, member)


def bound() -> dict[str, dict[str, str]]:
    """All that can be called, by name: parameters and their kinds."""
    return dict(bound_in_stub()) | dict(bound_in_submodules())


def settable() -> dict[str, list[str]]:
    """Attributes that can be set, by class."""
    result: dict[str, list[str]] = {}
    for name, nodes in stub_members(STUB.body).items():
        if isinstance(nodes[0], ast.ClassDef):
            for member in nodes[0].body:
                descriptor = getattr(getattr(_core, name), getattr(getattr(member, "target", None), "id", ""), None)
                if isinstance(member, ast.AnnAssign) and getattr(descriptor, "fset", None):
                    result.setdefault(name, []).append(ast.unparse(member.target))
    return result


# --- arguments spoilt ----------------------------------------------------------------------------------------------

PLAIN: list[tuple[str, Any]] = [
    ("None", None),
    ("an object", object()),
    ("a type", int),
    ("text", "text"),
    ("bytes", b"\xff\xfe"),
    ("an empty list", []),
    ("a list of None", [None]),
    ("a nested list", [[1, 2], [3]]),
    ("an empty dictionary", {}),
    ("a dictionary of None", {0: None}),
    ("a tuple of Nones", (None, None, None)),
    ("a set", {1}),
    ("a scene", scene()),
]
WHOLE = [("-1", -1), ("a large number", 99999), ("-2^31", -(2**31)), ("2^31 - 1", 2**31 - 1), ("2^63", 2**63)]
REAL = [
    ("NaN", np.nan),
    ("infinity", np.inf),
    ("-infinity", -np.inf),
    ("1e308", 1e308),
    ("-1.0", -1.0),
    ("5e-324", 5e-324),
]
TEXT = [("empty", ""), ("a surrogate", "\udcff"), ("zero byte", "a\0b"), ("a megabyte", "x" * (1 << 20))]


def spoilt_arrays(right: Any) -> Iterator[Spoilt]:
    """Arrays like the right one, some of them as good."""
    array = np.asarray(right)
    kind = array.dtype
    twice = np.repeat(array, 2, axis=0)[::2] if array.ndim else array
    locked = array.copy()
    locked.flags.writeable = False
    yield "not contiguous", twice, True
    yield "backwards", array[::-1].copy()[::-1], True
    yield "in Fortran's order", np.asfortranarray(array), True
    yield "read-only", locked, True
    yield "other bytes' order", array.astype(kind.newbyteorder()), True
    yield "a list", array.tolist(), True
    yield "complex", array.astype(complex) + 1j, False
    yield "objects", np.full(array.shape, None, object), False
    yield "texts", np.full(array.shape, "a"), False
    yield "dates", np.zeros(array.shape, "M8[s]"), False
    yield "records", np.zeros(array.shape, [("a", "f4"), ("b", "i4")]), False
    yield "empty", np.zeros(0, kind), False
    yield "no rows", array[:0], False
    yield "a number", np.array(1, kind), False
    yield "an axis more", array[None], False
    yield "a row less", array[:-1], False
    yield "a row more", np.concatenate([array, array[-1:]]) if array.ndim else array, False
    yield "transposed", array.T, False
    yield "five axes", np.zeros((2, 2, 2, 2, 2), kind), False
    yield "a column less", array[..., :-1], False
    for number in (-1, 2**31 - 1, -(2**31), 2**40, 2**63):
        yield f"all {number}", np.full(array.shape, number, float if number == 2**63 else np.int64), False
    for value in (np.nan, np.inf, -np.inf, 1e38, 1e307, -1e307, 5e-324, 0.0):
        yield f"all {value}", np.full(array.shape, value), False
    for other in (np.float16, np.longdouble, np.uint8, np.uint64, bool):
        yield f"as {np.dtype(other)}", array.astype(other), False


def spoilt(annotation: str, right: Any) -> Iterator[Spoilt]:
    """Values for a parameter: those of no kind, and those of its own."""
    for label, value in PLAIN:
        yield label, value, False
    if re.search(r"ndarray|NDArray|Floats|Doubles|Ints", annotation) or isinstance(right, np.ndarray):
        if isinstance(right, dict):
            for how, value, _ in spoilt_arrays(next(iter(right.values()))):
                yield f"{how}, in a dictionary", {0: value}, False
        elif right is None or not isinstance(right, (list, tuple)):
            yield from spoilt_arrays(np.ones((3, 3)) if right is None else right)
    if isinstance(right, (list, tuple)) and right:
        yield "one less", right[:-1], False
        yield "one more", [*right, right[0]], False
        for label, value in [*PLAIN, *WHOLE, *REAL]:
            yield f"{label}, in a list", type(right)([value, *right[1:]]), False
            if isinstance(right[0], (list, tuple)):
                yield f"{label}, in a list of lists", [type(right[0])([value, *right[0][1:]]), *right[1:]], False
    for label, value in [*WHOLE, *REAL, *[(f"text: {each}", value) for each, value in TEXT]]:
        yield label, value, False


def cases() -> Iterator[tuple[str, Callable[[], Any], bool]]:
    """Every call: its name, itself, and whether it must not fail."""
    for name, parameters in sorted(bound().items()):
        made = CALLS[name]
        yield name, lambda made=made: (lambda call: call[0](**call[1]))(made()), "_file" not in name
        right = made()[1]
        for parameter, annotation in parameters.items():
            for how, value, good in spoilt(annotation, right.get(parameter)):

                def call(made: Call = made, parameter: str = parameter, value: Any = value) -> Any:
                    function, arguments = made()
                    return function(**{**arguments, parameter: value})

                yield f"{name}, {parameter}: {how}", call, good and parameter in right
    for name, attributes in settable().items():
        for attribute in attributes:
            for how, value, _ in spoilt("", None):

                def assign(name: str = name, attribute: str = attribute, value: Any = value) -> Any:
                    target = settings() if name == "Settings" else getattr(_core, name)()
                    setattr(target, attribute, value)
                    if name == "Settings":
                        _core.Session(scene(), target)

                yield f"{name}.{attribute} = {how}", assign, False


def main(first: int) -> None:
    """Make the calls from one on; say what is not clean."""
    with contextlib.suppress(ImportError):
        import resource

        if "asan" not in os.environ.get("LD_PRELOAD", ""):  # the sanitizer maps terabytes
            resource.setrlimit(resource.RLIMIT_AS, (6 << 30, 6 << 30))
    for index, (name, call, must_hold) in enumerate(cases()):
        if index < first:
            continue
        print(f"{index}\t{name}", flush=True)
        signal.alarm(SECONDS)
        try:
            call()
        except CLEAN as error:
            if must_hold:
                print(f"UNCLEAN\t{name}: refused: {error!r:.500}", flush=True)
            if len(str(error)) > 20_000 and isinstance(error, _core.InputError):
                print(f"UNCLEAN\t{name}: a message of {len(str(error))} characters", flush=True)
        except BaseException as error:  # what is not clean is what is looked for
            print(f"UNCLEAN\t{name}: {error!r:.500}", flush=True)
    signal.alarm(0)
    print("END", flush=True)


if __name__ == "__main__":
    main(int(sys.argv[1]))
