"""The study of `examples.lightstage` with three people, which several examples start from."""

from pathlib import Path
from typing import NamedTuple

from pipeline_scans import FAST

from skinnet.cli import main as skinnet

PEOPLE, TEXELS = "3", "32"
QUICK = {"maps": FAST, "build-model": ("--appearance.samples=3",)}


class Studied(NamedTuple):
    """A folder of the study, and what the study printed."""

    folder: Path
    printed: str


def run_quickly(words: list[str]) -> int:
    """Run a command with settings that make it quick."""
    return skinnet([*words, *QUICK.get(words[0], ())])
