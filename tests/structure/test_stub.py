"""The type stub python_addon/rayleaf/_core.pyi says what the built module holds, name by name."""

import ast
import inspect
import re
import types

import pytest
from structure.sources import ADDON

STUB = ast.parse((ADDON / "_core.pyi").read_text())

# A parameter as both sides show it: its name with stars, and whether it may be left out.
Parameter = tuple[str, bool]


def split_parameters(text: str) -> list[str]:
    """Split "a: int, b: List[int, int] = (1, 2)" at its outer commas."""
    parts, depth, start = [], 0, 0
    for position, character in enumerate(text):
        depth += (character in "([{<") - (character in ")]}>")
        if character == "," and depth == 0:
            parts.append(text[start:position])
            start = position + 1
    return [part.strip() for part in [*parts, text[start:]] if part.strip()]


def signatures_in(docstring: str, name: str) -> list[list[Parameter]]:
    """The signatures that pybind11 writes at the head of a docstring, without self."""
    found = []
    for match in re.finditer(rf"^(?:\d+\. )?{re.escape(name)}\((.*)\) -> ", docstring, re.MULTILINE):
        if match[1] == "*args, **kwargs":  # the heading above overloads
            continue
        parameters = []
        for part in split_parameters(match[1]):
            stars = len(part) - len(part.lstrip("*"))
            identifier = "*" * stars if stars else re.split(r"[:=]", part)[0].strip()
            if identifier != "self":
                parameters.append((identifier, stars > 0 or "=" in part))
        found.append(parameters)
    return found


def signature_of(function: ast.FunctionDef) -> list[Parameter]:
    """The same of a function in the stub."""
    arguments = function.args
    names = [argument.arg for argument in arguments.posonlyargs + arguments.args]
    optional = [False] * (len(names) - len(arguments.defaults)) + [True] * len(arguments.defaults)
    parameters = [(name, default) for name, default in zip(names, optional) if name not in ("self", "cls")]
    if arguments.vararg:
        parameters.append(("*", True))
    elif arguments.kwonlyargs:
        parameters.append(("*", True))
    parameters += [(a.arg, default is not None) for a, default in zip(arguments.kwonlyargs, arguments.kw_defaults)]
    if arguments.kwarg:
        parameters.append(("**", True))
    return parameters


def stub_members(body: list[ast.stmt]) -> dict[str, list[ast.stmt]]:
    """What a module or class of the stub declares; a name's overloads together. Plain assignments are type aliases."""
    members: dict[str, list[ast.stmt]] = {}
    for node in body:
        if isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            members.setdefault(node.name, []).append(node)
        elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name):
            members.setdefault(node.target.id, []).append(node)
    return members


def public(names: object) -> set[str]:
    """Names without underscores in front."""
    return {name for name in names if not name.startswith("_")}


def check_callable(where: str, real: object, declared: list[ast.stmt]) -> None:
    name = where.rsplit(".", 1)[-1]
    functions = [node for node in declared if isinstance(node, ast.FunctionDef)]
    assert functions, f"{where} is a function in the module and something else in the stub"
    real_signatures = signatures_in(inspect.getdoc(real) or "", name)
    assert real_signatures == [signature_of(function) for function in functions], where


def is_property(declared: list[ast.stmt]) -> bool:
    """Declared as `name: type`, or as a function with @property."""
    node = declared[0]
    decorators = node.decorator_list if isinstance(node, ast.FunctionDef) else []
    return isinstance(node, ast.AnnAssign) or any(ast.unparse(each) == "property" for each in decorators)


def check_class(name: str, real: type, declared: ast.ClassDef) -> None:
    members = stub_members(declared.body)
    if hasattr(real, "__members__"):  # an enum; what all of pybind11's have is not worth declaring
        assert list(members) == list(real.__members__), f"members of {name}"
        return
    assert public(members) == public(vars(real)), f"members of {name}"
    for member, nodes in members.items():
        where = f"{name}.{member}"
        assert hasattr(real, member), f"{where} is in the stub alone"
        value = inspect.getattr_static(real, member)
        if isinstance(value, property) or not (callable(value) or isinstance(value, (staticmethod, classmethod))):
            assert is_property(nodes), f"{where} is a property in the module and a function in the stub"
        elif not is_property(nodes):
            check_callable(where, getattr(real, member), nodes)


def test_the_stub_declares_exactly_the_names_of_the_module(core):
    assert public(stub_members(STUB.body)) == public(vars(core))


@pytest.mark.parametrize("name", sorted(stub_members(STUB.body)))
def test_what_the_stub_declares_is_what_the_module_holds(core, name):
    declared = stub_members(STUB.body)[name]
    real = getattr(core, name)
    if isinstance(real, type) and issubclass(real, BaseException):
        bases = [base.__name__ for base in real.__bases__]
        assert isinstance(declared[0], ast.ClassDef) and [ast.unparse(base) for base in declared[0].bases] == bases
    elif isinstance(real, type):
        assert isinstance(declared[0], ast.ClassDef)
        check_class(name, real, declared[0])
    elif isinstance(real, types.BuiltinFunctionType):
        check_callable(name, real, declared)
    else:
        assert isinstance(declared[0], ast.AnnAssign), f"{name} is a {type(real).__name__}"
