"""Public names are documented for a reader, and what their examples print is true."""

import doctest
import importlib
import inspect
import warnings
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NoReturn

import numpy as np
import pytest

from tools.house import ROOT, list_definitions, read

ROOMS = sorted(file.parent.name for file in (ROOT / "skinnet").glob("*/__init__.py"))


def public(room: str) -> list[str]:
    return sorted(importlib.import_module(f"skinnet.{room}").__all__)


NAMES = [(room, name) for room in ROOMS for name in public(room)]


def test_every_public_definition_is_handed_out_by_its_room() -> None:
    modules = list(read(ROOT / "skinnet"))
    for room in ROOMS:
        found = {
            one.name
            for module in modules
            if module.room == room and module.public
            for one in list_definitions(module.tree)
        }
        assert found <= set(public(room)), (room, found - set(public(room)))


@pytest.mark.parametrize(("room", "name"), NAMES)
def test_arguments_and_results_are_described(room: str, name: str) -> None:
    found = getattr(importlib.import_module(f"skinnet.{room}"), name)
    for path, one in documented(name, found):
        text = inspect.getdoc(one) or ""
        assert text, f"{path} has no docstring"
        assert text.partition("\n")[0].rstrip().endswith((".", ":")), f"{path}: {text[:80]}"
        for argument in arguments(one):
            assert f"{argument}:" in text or f"{argument} (" in text, f"{path}: {argument}"
        if returns(one):
            assert "Returns:" in text or "Yields:" in text, f"{path} does not say what it returns"


@pytest.mark.slow
@pytest.mark.parametrize("room", ROOMS)
def test_examples_print_what_they_say(room: str, tmp_path: Path, monkeypatch: Any) -> None:
    monkeypatch.chdir(tmp_path)
    examples, runner = 0, doctest.DocTestRunner(optionflags=doctest.NORMALIZE_WHITESPACE)
    for name in public(room):
        found = getattr(importlib.import_module(f"skinnet.{room}"), name)
        tests = [
            test
            for one in [found, *list_bases(found)]
            for test in doctest.DocTestFinder().find(one, name)
        ]
        for test in tests:
            examples += len(test.examples)
            # Another test may import colour-science, which changes how NumPy prints arrays.
            with warnings.catch_warnings(), np.printoptions(legacy=False):
                runner.run(test)
    assert runner.failures == 0 and examples > 0


def list_bases(found: Any) -> list[type]:
    """The private classes whose methods a public class hands on."""
    bases = inspect.getmro(found)[1:] if inspect.isclass(found) else ()
    own = [base for base in bases if base.__module__.startswith("skinnet.")]
    return [base for base in own if "._" in base.__module__]


def documented(name: str, found: Any) -> Iterator[tuple[str, Any]]:
    """A function, or a class and its public methods."""
    if not (inspect.isfunction(found) or inspect.isclass(found)):
        return
    yield name, found
    for one in [found, *list_bases(found)] if inspect.isclass(found) else []:
        for method, value in vars(one).items():
            value = getattr(value, "__func__", value)
            if inspect.isfunction(value) and not method.startswith("_"):
                yield f"{name}.{method}", value


def arguments(one: Any) -> list[str]:
    """Names of what a caller hands in."""
    if inspect.isclass(one) and not hasattr(one, "_fields"):
        if getattr(one, "_is_protocol", False):
            return []
        # What another library's constructor takes is described there.
        if not one.__init__.__module__.startswith("skinnet"):
            return []
    try:
        given = inspect.signature(one).parameters.values()
    except ValueError:
        return []
    return [p.name for p in given if p.name not in ("self", "cls") and not p.name.startswith("_")]


def returns(one: Any) -> bool:
    """Whether a function gives something back."""
    if inspect.isclass(one):
        return False
    return inspect.signature(one).return_annotation not in (
        None,
        "None",
        NoReturn,
        inspect.Signature.empty,
    )
