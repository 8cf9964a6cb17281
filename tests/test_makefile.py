"""Every target of the Makefile is explained."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]


def test_every_target_is_in_the_guide_for_contributors() -> None:
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    (phony,) = re.findall(r"^\.PHONY: (.+)$", makefile, re.MULTILINE)
    targets = re.findall(r"^([a-z][\w-]*):", makefile, re.MULTILINE)
    guide = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `make ([\w-]+)` \| \w", guide, re.MULTILINE)
    assert sorted(phony.split()) == sorted(targets) == sorted(rows)
