"""The flags of the pipeline's verbs, for their help and for shells, without what is slow to import.

The table is written by `python -m tools.flag_table` from the settings of the verbs.
"""

import argparse
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from skinnet.errors import InputError
from skinnet.inference._command.spelling import spell_flag, spell_flags
from skinnet.inference._command.verb_parser import VerbParser
from skinnet.inference._messages import note
from skinnet.pipeline._verbs import PIPELINE_VERBS

TABLE = Path(__file__).with_name("flags.json")
"""For each verb, `renamed` (old keys and the new ones) and `groups`, each of a title and flags."""

SWITCH = "true|false"
"""How help names the values of a switch."""


def make_parser(verb: str) -> VerbParser:
    """Make a parser that knows the flags of a verb, and not which values they take."""
    summary, examples = PIPELINE_VERBS[verb]
    description = f"{summary[0].upper()}{summary[1:]}."
    parser = VerbParser(
        f"skinnet {verb}", description, examples, lambda parser: _add_flags(parser, verb)
    )
    inputs = (each for each in parser._actions if not each.option_strings)
    parser.usage = f"{parser.prog} [flags] {' '.join(map(_name_input, inputs))}"
    return parser


def check_flags(parser: VerbParser, verb: str, arguments: Sequence[str]) -> list[str]:
    """Check the names of flags, and spell them with hyphens.

    Args:
        parser: The parser of the verb.
        verb: The verb.
        arguments: What a user gives.

    Returns:
        The arguments, with hyphens in flags.

    Raises:
        InputError: A flag is unknown, or has another name now.
    """
    spelled = spell_flags(arguments)
    for given, word in zip(arguments, spelled, strict=True):
        if word == "--":
            break
        if word.startswith("--"):
            _check_old_name(verb, word.partition("=")[0])
            if given != word and "." not in word.partition("=")[0]:
                old, new = (each.partition("=")[0] for each in (given, word))
                note(f"{old} is now written {new}.")
    parser.check_flags(spelled)
    return _complete_switches(parser, spelled)


def _complete_switches(parser: VerbParser, arguments: list[str]) -> list[str]:
    """Give switches that stand alone their value, so that they do not take the next input."""
    switches = {
        flag
        for action in parser._actions
        for flag in action.option_strings
        if action.nargs == "?" and action.metavar == SWITCH
    }
    following = [*arguments, ""][1:]
    return [
        f"{word}=true" if word in switches and after not in ("true", "false") else word
        for word, after in zip(arguments, following, strict=True)
    ]


def _check_old_name(verb: str, flag: str) -> None:
    for old, new in _read_table()[verb]["renamed"].items():
        if flag == spell_flag(old) or flag.startswith(spell_flag(f"{old}.")):
            flag_now = spell_flag(new) + flag.removeprefix(spell_flag(old))
            raise InputError(f"{flag} of skinnet {verb} is now called {flag_now}; use that name.")


def _name_input(action: argparse.Action) -> str:
    name = {"*": "[{0} ...]", "+": "{0} [{0} ...]", "?": "[{0}]"}.get(str(action.nargs), "{0}")
    return name.format(action.dest)


def _read_table() -> dict[str, Any]:
    table: dict[str, Any] = json.loads(TABLE.read_text(encoding="utf-8"))
    return table


def _add_flags(parser: argparse.ArgumentParser, verb: str) -> None:
    for group in _read_table()[verb]["groups"]:
        title = group["title"]
        into = parser.add_argument_group(title) if title else parser
        for flag in group["flags"]:
            _add_flag(into, flag)


def _add_flag(into: "argparse._ActionsContainer", flag: Mapping[str, Any]) -> None:
    settings = {key: value for key, value in flag.items() if key != "names"}
    if settings.get("help") is None:
        settings["help"] = argparse.SUPPRESS
    into.add_argument(*flag["names"], **settings)
