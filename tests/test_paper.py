"""Every row of docs/paper.md leads to code whose docstring cites the paper."""

import importlib
import inspect
import re
from functools import reduce
from pathlib import Path

import pytest

DOCUMENT = Path(__file__).parents[1] / "docs" / "paper.md"
ROW = re.compile(r"^\| (.+?) \| `(.+?)\.py` \| `(.+?)` \|$", re.MULTILINE)
ROWS = ROW.findall(DOCUMENT.read_text(encoding="utf-8"))


def test_every_equation_has_a_row() -> None:
    cited = {int(n) for part, _, _ in ROWS for n in re.findall(r"Equation (\d+)", part)}
    assert cited == set(range(1, 12))


@pytest.mark.parametrize(("part", "path", "name"), ROWS)
def test_the_code_cites_the_paper(part: str, path: str, name: str) -> None:
    module = importlib.import_module(path.replace("/", "."))
    found = reduce(getattr, name.split("."), module)
    text = " ".join((inspect.getdoc(found) or "").split())
    numbers = re.findall(r"(?:Equation|Section|Tables?|Figure) ([\d.]+)", part)
    assert any(re.search(rf"\b{re.escape(n.rstrip('.'))}\b", text) for n in numbers), text
    assert re.search(r"[Ee]quation|[Ss]ection|[Tt]able|[Ff]igure", text), text
