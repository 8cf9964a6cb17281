"""The parser of one verb: its help ends with examples, and a mistake is one sentence."""

import argparse
import os
import re
from collections.abc import Callable, Sequence
from itertools import pairwise
from typing import Any, NoReturn

from skinnet.errors import InputError
from skinnet.inference._command.nearest import suggest
from skinnet.inference._messages import Verbosity

_EXAMPLES = "examples:\n"

_NOT_A_NUMBER = re.compile(r"argument (.+): invalid (\w+) value: (.+)")
_NO_VALUE = re.compile(r"argument (.+): expected (?:one|at least one) argument")
_FEW_VALUES = re.compile(r"argument (.+): expected (\d+) arguments")
_A_VALUE = re.compile(r"argument (.+): ignored explicit argument (.+)")
_BOTH = re.compile(r"argument (.+): not allowed with argument (.+)")
_MISSING = re.compile(r"the following arguments are required: (.+)")
_OTHER = re.compile(r"argument (.+?): (.+)")
_KINDS = {"int": "a whole number", "float": "a number"}

_LEVELS = {
    "-q": Verbosity.QUIET,
    "--quiet": Verbosity.QUIET,
    "-v": Verbosity.VERBOSE,
    "--verbose": Verbosity.VERBOSE,
}


class _HelpFormatter(argparse.RawDescriptionHelpFormatter):
    """Wraps the description, and leaves the lines of the examples as they are."""

    def _fill_text(self, text: str, width: int, indent: str) -> str:
        if text.startswith(_EXAMPLES):
            return super()._fill_text(text, width, indent)
        return argparse.HelpFormatter._fill_text(self, text, width, indent)


class VerbParser(argparse.ArgumentParser):
    """The parser of one verb, with the flags that all verbs have.

    Args:
        prog: The command, such as skinnet predict.
        description: What the verb does; a sentence.
        examples: Commands that its help shows, each with what it does.
        add: Adds the flags of the verb.

    Example:
        >>> parser = VerbParser("skinnet web", "Open a page.")
        >>> parser.parse(["--quit"])
        Traceback (most recent call last):
        ...
        skinnet.errors.InputError: web has no flag --quit. Did you mean --quiet? (skinnet web ...
    """

    def __init__(
        self,
        prog: str,
        description: str,
        examples: Sequence[tuple[str, str]] = (),
        add: Callable[[argparse.ArgumentParser], None] | None = None,
    ) -> None:
        super().__init__(
            prog=prog,
            description=description,
            epilog=_format_examples(examples),
            formatter_class=_HelpFormatter,
            allow_abbrev=False,
        )
        self.name = prog.removeprefix("skinnet ")
        self._given: list[str] = []
        if add is not None:
            add(self)
        add_verbosity(self)

    def parse(self, arguments: Sequence[str]) -> argparse.Namespace:
        """Parse the arguments of the verb.

        Args:
            arguments: What follows the verb.

        Returns:
            The options.

        Raises:
            InputError: For the first mistake, with the nearest valid word.
        """
        self.check_flags(arguments)
        self._given = list(arguments)
        options, others = self.parse_known_args(self._given)
        if others:
            flags = self._option_string_actions if others[0].startswith("-") else ()
            self.refuse(
                f"{self.name} does not know what {others[0]!r} is for.{suggest(others[0], flags)}"
            )
        return options

    def check_flags(self, arguments: Sequence[str]) -> None:
        """Refuse long flags that the verb does not have.

        Args:
            arguments: What follows the verb.

        Raises:
            InputError: For the first one.
        """
        for word in arguments:
            if word == "--":
                return
            flag = word.partition("=")[0]
            if flag.startswith("--") and flag not in self._option_string_actions:
                flags = (each for each in self._option_string_actions if each.startswith("--"))
                self.refuse(f"{self.name} has no flag {flag}.{suggest(flag, flags)}")

    def refuse(self, sentence: str) -> NoReturn:
        """Refuse the arguments, and name the help.

        Args:
            sentence: What is wrong.

        Raises:
            InputError: Always.
        """
        raise InputError(f"{sentence} ({self.prog} --help lists the flags)")

    def error(self, message: str) -> NoReturn:
        """Say in a sentence what argparse found.

        Args:
            message: What argparse says.

        Raises:
            InputError: Always.
        """
        self.refuse(self._describe(" ".join(message.split())))

    def _describe(self, message: str) -> str:
        if found := _MISSING.fullmatch(message):
            return f"{self.name} needs {found[1]}{self._describe_input(found[1])}."
        if found := _NOT_A_NUMBER.fullmatch(message):
            comma = " A point stands before decimals." if "," in found[3] else ""
            return f"{found[1]} is {_KINDS.get(found[2], found[2])}; got {found[3]}.{comma}"
        if found := _NO_VALUE.fullmatch(message):
            return f"{found[1]} needs a value, and none was given."
        if found := _FEW_VALUES.fullmatch(message):
            return f"{found[1]} needs {self._name_values(found[1], found[2])} after it."
        if found := _A_VALUE.fullmatch(message):
            return f"{found[1]} takes no value; got {found[2]}."
        if found := _BOTH.fullmatch(message):
            return f"{found[1]} and {found[2]} exclude each other; give one of them."
        if found := _OTHER.fullmatch(message):
            return found[2] if found[2].endswith((".", "?")) else f"{found[1]}: {found[2]}."
        return message if message.endswith((".", "?")) else f"{message}."

    def _name_values(self, flag: str, count: str) -> str:
        """The names of the values of a flag, as its help shows them."""
        action = self._option_string_actions.get(flag.partition("/")[0])
        names = action.metavar if action is not None else None
        return " and ".join(names) if isinstance(names, tuple) else f"{count} values"

    def _describe_input(self, names: str) -> str:
        """What the first missing input is, as its help says it."""
        name = names.partition(",")[0]
        found = [each for each in self._actions if name in (each.metavar, each.dest)]
        told = f": {found[0].help}" if found and found[0].help else ""
        return f"{told}.{self._find_lost_input()}".removesuffix(".")

    def _find_lost_input(self) -> str:
        """Where an input that was given may have gone."""
        for word, after in pairwise([*self._given, ""]):
            action = self._option_string_actions.get(word)
            if action is not None and action.nargs == "?" and after and after[0] != "-":
                return f" {word} has taken {after} as its own value; give the input first."
            if action is None and word[:1] == "-" and os.path.exists(word):
                return f" {word} begins as a flag does; give files after --, or as ./{word}."
        return ""

    def _check_value(self, action: argparse.Action, value: Any) -> None:
        if action.choices is not None and value not in action.choices:
            words = [str(each) for each in action.choices]
            name = argparse._get_action_name(action)
            known = f"{', '.join(words[:-1])} or {words[-1]}" if words[1:] else words[0]
            raise argparse.ArgumentError(
                None, f"{name} is {known}; got {value!r}.{suggest(str(value), words)}"
            )


def add_verbosity(parser: argparse.ArgumentParser) -> None:
    """Add the flags for how much is said.

    Args:
        parser: The parser of a verb.
    """
    pair = parser.add_argument_group("messages").add_mutually_exclusive_group()
    pair.add_argument(
        "-q",
        "--quiet",
        action="store_true",
        help="print errors, and what was asked for, nothing else",
    )
    pair.add_argument(
        "-v",
        "--verbose",
        action="store_true",
        help="print what was assumed, versions and times too, and where an unexpected error arose",
    )


def read_verbosity(options: argparse.Namespace) -> Verbosity:
    """Read how much is to be said.

    Args:
        options: Parsed options of a verb.

    Returns:
        How much.
    """
    if options.quiet:
        return Verbosity.QUIET
    return Verbosity.VERBOSE if options.verbose else Verbosity.USUAL


def take_verbosity(arguments: Sequence[str]) -> tuple[Verbosity, list[str]]:
    """Take the flags for how much is said out of arguments that another parser reads.

    Args:
        arguments: What follows a verb.

    Returns:
        How much is to be said, and the other arguments.

    Raises:
        InputError: Both flags are given.
    """
    end = arguments.index("--") if "--" in arguments else len(arguments)
    levels = {_LEVELS[each] for each in arguments[:end] if each in _LEVELS}
    if len(levels) > 1:
        raise InputError("-v/--verbose and -q/--quiet exclude each other; give one of them.")
    others = [each for each in arguments[:end] if each not in _LEVELS]
    return next(iter(levels), Verbosity.USUAL), [*others, *arguments[end:]]


def _format_examples(examples: Sequence[tuple[str, str]]) -> str | None:
    if not examples:
        return None
    return _EXAMPLES + "\n".join(f"  # {meaning}\n  {command}" for command, meaning in examples)
