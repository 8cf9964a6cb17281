"""The guide is built strictly, has every public name, and loads nothing from elsewhere."""

import importlib
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest

from tools.guide import ROOT, turn_links

ROOMS = sorted(file.parent.name for file in (ROOT / "skinnet").glob("*/__init__.pyi"))
LOADED = re.compile(r"<(?:script|link|img|iframe|source)\b[^>]*\b(?:src|href)=\"(?:https?:)?//")


@pytest.mark.parametrize(
    ("place", "link", "turned"),
    [
        ("known.md", "reading.md", "reading.md"),
        ("known.md", "../demo/tones.png", "demo/tones.png"),
        ("api/index.md", "../known.md#numbers", "../known.md#numbers"),
        ("api/index.md", "../../CONTRIBUTING.md", "../contributing.md"),
        ("model-card.md", "CHANGELOG.md", "model-changes.md"),
    ],
)
def test_links_lead_to_pages_of_the_guide(place: str, link: str, turned: str) -> None:
    assert turn_links(f"[a]({link})", place) == f"[a]({turned})"


def test_other_links_and_code_stay() -> None:
    text = "[a](https://example.org/b) [c](#d)\n\n```python\nx[0](y)\n```\n"
    assert turn_links(text, "known.md") == text


@pytest.mark.slow
def test_the_guide_is_built(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--quiet", "-d", str(tmp_path)]
    environment = {**os.environ, "NO_MKDOCS_2_WARNING": "1", "PYTHONPATH": "."}
    done = subprocess.run(command, cwd=ROOT, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    for room in ROOMS:
        page = (tmp_path / "api" / f"{room}.html").read_text(encoding="utf-8")
        for name in importlib.import_module(f"skinnet.{room}").__all__:
            assert f'id="skinnet.{room}.{name}"' in page, name
    for file in tmp_path.rglob("*.html"):
        assert not LOADED.search(file.read_text(encoding="utf-8")), file
