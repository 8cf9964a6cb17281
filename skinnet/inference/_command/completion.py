"""Completion of verbs, flags and their values by the shell, written by shtab."""

import argparse
import re
from collections.abc import Mapping
from typing import Any

from skinnet.errors import InputError
from skinnet.inference._command.verb_parser import VerbParser

SHELLS = ("bash", "zsh", "fish")

SUMMARY = "print a script with which a shell completes verbs, flags and their values"

EXAMPLES = (
    ('eval "$(skinnet completion bash)"', "bash: a line for ~/.bashrc"),
    ('eval "$(skinnet completion zsh)"', "zsh: a line for ~/.zshrc, after compinit"),
    ("skinnet completion fish | source", "fish: a line for ~/.config/fish/config.fish"),
)

_WORDS = {
    "light": ("daylight", "D65", "flash", "tungsten", "FL2", "FL7", "FL11", "LED-B1", "LED-B3"),
    "camera": ("exif",),
}
"""Values of flags that take others too."""

_ENDS = ".yaml", ".csv", ".onnx", ".npz"


def add_completion(parser: argparse.ArgumentParser) -> None:
    """Add the shell.

    Args:
        parser: The parser of `skinnet completion`.
    """
    parser.add_argument("shell", choices=SHELLS, help="the shell that you use")


def write_script(shell: str, verbs: Mapping[str, tuple[str, VerbParser]]) -> str:
    """Write the script of a shell.

    Args:
        shell: bash, zsh or fish.
        verbs: For each verb what it does, and a parser, which is changed.

    Returns:
        The script.

    Raises:
        InputError: shtab is not installed.
    """
    try:
        import shtab
    except ModuleNotFoundError as error:
        raise InputError(
            'skinnet completion needs the completion extra: pip install "skinnet[completion]"'
        ) from error
    script: str = shtab.complete(_join(verbs, shtab), shell)
    return script


def _join(verbs: Mapping[str, tuple[str, VerbParser]], shtab: Any) -> argparse.ArgumentParser:
    """Make one parser of all verbs."""
    parser = argparse.ArgumentParser(prog="skinnet")
    parser.add_argument("--version", action="version", help="show the version")
    into = parser.add_subparsers(metavar="VERB")
    for name, (summary, each) in verbs.items():
        for action in each._actions:
            _tell_values(action, shtab)
        into.add_parser(
            name, parents=[each], add_help=False, help=summary, description=each.description
        )
    helped = into.add_parser("help", help="show the flags of a verb")
    helped.add_argument("verb", choices=list(verbs))
    return parser


def _tell_values(action: Any, shtab: Any) -> None:
    """Tell the shell which words or files an argument takes."""
    metavar = str(action.metavar or "")
    words = [*_WORDS.get(action.dest, ()), *re.findall(r"(?<![.\w])[a-z]+\b", metavar)]
    if action.choices is not None or action.nargs == 0:
        return
    if words:
        action.choices = words
    elif "DIR" in metavar and "FILE" not in metavar:
        action.complete = shtab.DIRECTORY
    elif end := next((each for each in _ENDS if metavar.endswith(each)), None):
        action.complete = shtab.glob(f"*{end}")
    elif "FILE" in metavar or not action.option_strings:
        action.complete = shtab.FILE
