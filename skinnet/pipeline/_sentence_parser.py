"""The parser of the commands that take settings from YAML and flags."""

import re
from collections.abc import Mapping
from typing import NoReturn

from jsonargparse import ArgumentParser

from skinnet.errors import InputError
from skinnet.pipeline._sentences import write_sentence


class SentenceParser(ArgumentParser):
    """A parser that reports an error in one sentence, without listing all flags.

    `help_command` lists the flags; by default it is the parser's program with `--help`.
    `renamed` maps keys and class names of earlier versions to their present names. An error about
    an old name then gives the new one.

    Raises:
        InputError: Instead of a message on standard error and the end of the process.

    Example:
        >>> from skinnet.pipeline._sentence_parser import SentenceParser
        >>> parser = SentenceParser(prog="skinnet maps")
        >>> parser.renamed = {"colour": "color"}
        >>> parser.parse_args(["--colour=red"])
        Traceback (most recent call last):
        ...
        skinnet.errors.InputError: 'colour' is now called 'color'; use the new name.
    """

    help_command: str | None = None
    renamed: Mapping[str, str] = {}

    def error(self, message: str, ex: Exception | None = None) -> NoReturn:
        """Raise `InputError` with the message on one line.

        Args:
            message: What is wrong.
            ex: The exception behind it.

        Raises:
            InputError: Always.
        """
        for old, new in self.renamed.items():
            # A key stands after a quote, dashes or a colon, perhaps as the end of a longer path.
            if re.search(rf"""(?:['"]|--|: )(?:\w+\.)*{re.escape(old)}(?=[.'"=\s]|$)""", message):
                raise InputError(f"'{old}' is now called '{new}'; use the new name.") from ex
        keys = [each.dest for each in self._actions]
        sentence = write_sentence(" ".join(message.split()), self.prog, keys)
        help_command = self.help_command or f"{self.prog} --help"
        raise InputError(f"{sentence} ({help_command} lists the flags)") from ex
