"""The structure of `skinnet` in numbers: `python -m tools.house [--json]`.

Counted are the entries at the root (rooms and modules; `__init__.py` and `py.typed` aside), public
definitions (classes and functions at the top of a module whose path has no underscore), imports
that run upwards, cycles between rooms, lengths of files, and the shares of functions that are fully
annotated and of public definitions that have a docstring. The floors are those of the import
contract in pyproject.toml.
"""

import argparse
import ast
import json
import sys
import tomllib
from collections.abc import Iterator
from graphlib import CycleError, TopologicalSorter
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

ROOT = Path(__file__).parents[1]
PACKAGE = "skinnet"

Function = ast.FunctionDef | ast.AsyncFunctionDef
Definition = Function | ast.ClassDef


class Module(NamedTuple):
    """A source file: its path below the package, its room, syntax tree and number of lines."""

    path: Path
    room: str
    tree: ast.Module
    lines: int

    @property
    def public(self) -> bool:
        """Whether no part of the path has an underscore, `__init__` aside."""
        parts = [part for part in self.path.with_suffix("").parts if part != "__init__"]
        return not any(part.startswith("_") for part in parts)


def measure(package: Path, floors: dict[str, int]) -> dict[str, Any]:
    """The numbers of a package, given the floor of each of its rooms and root modules."""
    modules = read(package)
    public = [one for module in modules if module.public for one in list_definitions(module.tree)]
    functions = [one for module in modules for one in list_functions(module.tree)]
    documented = [ast.get_docstring(one) is not None for one in add_methods(public)]
    imports = {(a, b) for module in modules for a, b in list_imports(module) if a != b}
    lengths = sorted((module.lines, str(module.path)) for module in modules if module.lines)
    return {
        "entries": len(list_entries(package)),
        "public_definitions": len(public),
        "upward_imports": sum(floors[a] <= floors[b] for a, b in imports),
        "room_cycles": int(has_cycle(imports)),
        "files": len(lengths),
        "median_file": median(length for length, _ in lengths),
        "longest_file": {"lines": lengths[-1][0], "path": lengths[-1][1]},
        "fully_annotated_share": compute_share([is_annotated(one) for one in functions]),
        "docstring_share": compute_share(documented),
    }


def read(package: Path) -> list[Module]:
    """All source files of a package."""
    found = []
    for file in sorted(package.rglob("*.py")):
        path, text = file.relative_to(package), file.read_text(encoding="utf-8")
        room = "" if path.name == "__init__.py" and len(path.parts) == 1 else path.parts[0]
        found.append(
            Module(path, room.removesuffix(".py"), ast.parse(text), len(text.splitlines()))
        )
    return found


def list_entries(package: Path) -> list[str]:
    """Rooms and modules at the root of the package."""
    rooms = [file.parent.name for file in package.glob("*/__init__.py")]
    return sorted(rooms + [file.stem for file in package.glob("*.py") if file.stem != "__init__"])


def list_definitions(tree: ast.Module) -> list[Definition]:
    """Public classes and functions at the top of a module."""
    found = [one for one in tree.body if isinstance(one, Definition)]
    return [one for one in found if not one.name.startswith("_")]


def add_methods(found: list[Definition]) -> Iterator[Definition]:
    """Definitions, and the public methods of those that are classes; overloads are no methods."""
    for one in found:
        yield one
        if isinstance(one, ast.ClassDef):
            methods = (inner for inner in one.body if isinstance(inner, Function))
            named = (inner for inner in methods if not inner.name.startswith("_"))
            yield from (inner for inner in named if not is_overload(inner))


def is_overload(function: Function) -> bool:
    """Whether a function only states types; the one that follows has the docstring."""
    return any(
        isinstance(one, ast.Name) and one.id == "overload" for one in function.decorator_list
    )


def list_functions(tree: ast.Module) -> list[Function]:
    """All functions and methods of a module, private and inner ones too."""
    return [one for one in ast.walk(tree) if isinstance(one, Function)]


def is_annotated(function: Function) -> bool:
    """Whether every argument and the result has a type; self and cls need none."""
    given = function.args
    arguments = [*given.posonlyargs, *given.args, *given.kwonlyargs]
    arguments += [one for one in (given.vararg, given.kwarg) if one is not None]
    typed = all(one.annotation is not None or one.arg in ("self", "cls") for one in arguments)
    return typed and (function.returns is not None)


def list_imports(module: Module) -> Iterator[tuple[str, str]]:
    """Rooms from and to which a module imports; what the root hands out lazily is not counted."""
    for node in ast.walk(module.tree):
        names: list[str] = []
        if isinstance(node, ast.ImportFrom) and node.module is not None:
            full = (f"{node.module}.{alias.name}" for alias in node.names)
            names = list(full) if node.module == PACKAGE else [node.module]
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        for name in names:
            top, _, rest = name.partition(".")
            if top == PACKAGE and rest and module.room:
                yield module.room, rest.partition(".")[0]


def has_cycle(imports: set[tuple[str, str]]) -> bool:
    """Whether rooms import each other in a circle."""
    graph: dict[str, set[str]] = {}
    for source, target in imports:
        graph.setdefault(source, set()).add(target)
    try:
        TopologicalSorter(graph).prepare()
    except CycleError:
        return True
    return False


def read_floors() -> dict[str, int]:
    """The floor of each room, 0 the lowest, as the import contract has it."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    contracts = settings["tool"]["importlinter"]["contracts"]
    layers = next(one["layers"] for one in contracts if one["type"] == "layers")
    floors = enumerate(reversed(layers))
    return {room.strip(): floor for floor, layer in floors for room in layer.split("|")}


def compute_share(found: list[bool]) -> float:
    """The part that is true, to four digits."""
    return round(sum(found) / max(len(found), 1), 4)


def main(arguments: list[str] | None = None) -> int:
    """Print the numbers, as a table or as JSON."""
    parser = argparse.ArgumentParser(prog="python -m tools.house", description=__doc__)
    parser.add_argument("--json", action="store_true", help="one JSON object")
    options = parser.parse_args(arguments)
    found = measure(ROOT / PACKAGE, read_floors())
    if options.json:
        print(json.dumps(found))
        return 0
    for name, value in found.items():
        print(f"{name.replace('_', ' '):24}{value}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
