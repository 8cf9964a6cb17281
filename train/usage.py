"""Help of `python -m train`, without what is slow to import.

The settings are listed in a table that `python -m tools.flag_table` writes.
"""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from skinnet.errors import InputError
from skinnet.inference._command.nearest import suggest
from skinnet.inference._command.verb_parser import VerbParser

TABLE = Path(__file__).with_name("flags.json")
"""Groups of settings, each of a title and flags, as of `skinnet/pipeline/flags.json`."""

COMMANDS = {
    "fit": "train, and keep last.ckpt and best.ckpt in the folder of the run",
    "validate": "evaluate a checkpoint on the validation data",
    "test": "evaluate a checkpoint on the test data",
}

EXAMPLES = {
    "fit": (
        ("python -m train fit --config configs/quick.yaml", "a minute, on synthetic faces"),
        (
            "python -m train fit --config configs/portraits.yaml --data.init-args.folder PHOTOS",
            "your own photographs",
        ),
        (
            "python -m train fit --config runs/quick/config.yaml --ckpt-path runs/quick/last.ckpt",
            "go on with a run",
        ),
    ),
    "validate": (
        (
            "python -m train validate --config runs/quick/config.yaml "
            "--ckpt-path runs/quick/best.ckpt",
            "the best checkpoint of a run",
        ),
    ),
    "test": (
        (
            "python -m train test --config runs/quick/config.yaml --ckpt-path runs/quick/best.ckpt",
            "the best checkpoint of a run",
        ),
    ),
}

_ALL = "--help-all"
_MORE = (
    "Every setting is a key of YAML and a flag, whose hyphens may be underscores. The trainer has "
    f"more flags, those of Lightning; {_ALL} lists them, and takes ten seconds."
)


def answer(arguments: Sequence[str]) -> str | None:
    """Answer what needs no training.

    Args:
        arguments: What follows `python -m train`.

    Returns:
        A help text, None if the command is to be run.

    Raises:
        InputError: There is no such command.

    Example:
        >>> answer(["ft", "--config", "a.yaml"])
        Traceback (most recent call last):
        ...
        skinnet.errors.InputError: There is no command ft. Did you mean fit? (python -m train ...
    """
    words = [word for word in arguments if word != "help"]
    command = next((word for word in words if not word.startswith("-")), None)
    wanted = {"-h", "--help"} & {*words} or len(words) < len(arguments)
    if command is None and (wanted or not words):
        return _describe_commands()
    if command is not None and command == words[0] and command not in COMMANDS:
        raise InputError(
            f"There is no command {command}.{suggest(command, COMMANDS)} "
            "(python -m train --help lists the commands)"
        )
    return describe_command(command or "fit") if wanted else None


def describe_command(command: str) -> str:
    """Write the help of a command; kinds of data, which share flags, have a section each."""
    text = make_parser(command).format_help().rstrip()
    start, title, end = text.partition("\nmessages:\n")
    sections = "\n".join(_format_group(group) for group in _read_groups() if _is_data(group))
    return f"{start}\n{sections}\n{title.lstrip()}{end}"


def make_parser(command: str) -> VerbParser:
    """Make the parser of a command's help."""
    summary = COMMANDS[command]
    description = f"{summary[0].upper()}{summary[1:]}. {_MORE}"
    prog = f"python -m train {command}"
    parser = VerbParser(prog, description, EXAMPLES[command], _add_flags)
    parser.usage = f"{prog} --config FILE.yaml [flags]"
    return parser


def _add_flags(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(_ALL, action="store_true", help="list the flags of Lightning too; slow")
    for group in _read_groups():
        if not _is_data(group):
            _add_group(parser, group)


def _read_groups() -> list[dict[str, Any]]:
    groups: list[dict[str, Any]] = json.loads(TABLE.read_text(encoding="utf-8"))
    return groups


def _is_data(group: dict[str, Any]) -> bool:
    return bool(group["title"].startswith("data"))


def _format_group(group: dict[str, Any]) -> str:
    parser = argparse.ArgumentParser(add_help=False, usage=argparse.SUPPRESS)
    _add_group(parser, group)
    return parser.format_help()


def _add_group(parser: argparse.ArgumentParser, group: dict[str, Any]) -> None:
    into = parser.add_argument_group(group["title"]) if group["title"] else parser
    for flag in group["flags"]:
        settings = {key: value for key, value in flag.items() if key != "names"}
        into.add_argument(*flag["names"], **settings)


def _describe_commands() -> str:
    commands = "\n".join(f"  {name:10} {summary}" for name, summary in COMMANDS.items())
    examples = "\n".join(f"  # {meaning}\n  {line}" for line, meaning in EXAMPLES["fit"])
    return (
        "usage: python -m train COMMAND --config FILE.yaml [flags]\n\nTrain the network.\n\n"
        f"commands:\n{commands}\n\npython -m train COMMAND --help lists the flags.\n\n"
        f"examples:\n{examples}"
    )
