"""The verbs of the classic pipeline: settings from YAML and flags."""

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import Any

from jsonargparse import ArgumentParser, Namespace

from skinnet.files import make_folder
from skinnet.pipeline.sentence_parser import SentenceParser


def run_verb(verb: str, arguments: Sequence[str], help_: str) -> int:
    """Run a verb; its module adds its arguments to a parser and takes what was parsed."""
    room: Any = import_module(f"skinnet.pipeline._{verb.replace('-', '_')}")
    parser = SentenceParser(prog=f"skinnet {verb}", description=f"{help_[0].upper()}{help_[1:]}.")
    parser.add_argument(
        "--config", action="config", help="YAML with any of these options, as in configs/."
    )
    room.add_arguments(parser)
    config: Namespace = parser.instantiate(parser.parse_args(list(arguments)))
    code: int = room.run(config)
    return code


def output_folder(folder: Path) -> Path:
    """The folder that a verb writes into, made if needed."""
    return make_folder(folder, "choose another folder with -o")


def add_output(parser: ArgumentParser, default: str) -> None:
    """The folder that a verb writes into."""
    parser.add_argument(
        "-o", "--output", type=Path | None, default=None, help=f"Folder; by default {default}."
    )
