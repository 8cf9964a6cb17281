"""The parser of the commands that take settings from YAML and flags."""

import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from io import StringIO
from pathlib import Path
from typing import Any, NoReturn

import yaml
from jsonargparse import ArgumentParser, Namespace, get_loader, set_dumper, set_loader

from skinnet.errors import InputError, _clip, _name_error
from skinnet.files._reading import read_stream
from skinnet.files._settings import MOST_SETTINGS, check_yaml, parse_settings, read_settings
from skinnet.pipeline._sentences import write_sentence

_MODE = "bounded yaml"
_LONGEST = 800
_SETTINGS = (".yaml", ".yml", ".json")


def _load(text: str) -> Any:
    check_yaml(text)
    return get_loader("yaml")(text)


def _dump(data: Any) -> str:
    text: str = yaml.safe_dump(data, default_flow_style=False, allow_unicode=True, sort_keys=False)
    return text


set_loader(_MODE, _load, (yaml.YAMLError,))
set_dumper(_MODE, _dump)


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

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **{"parser_mode": _MODE} | kwargs)

    def parse_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, *more: Any, **kwargs: Any
    ) -> Any:
        """Parse arguments, whose files of settings are checked first.

        Args:
            args: The arguments; those of the process by default.
            *more: As jsonargparse takes them.
            **kwargs: As jsonargparse takes them.

        Raises:
            InputError: For an argument or a file that cannot be used.
        """
        for path in _list_settings(sys.argv[1:] if args is None else args):
            _check_stream() if path == "-" else _check_file(Path(path))
        try:
            return super().parse_args(args, *more, **kwargs)
        except UnicodeDecodeError as error:
            raise InputError(
                f"A file that the settings name is not text in UTF-8 ({error}); save it as UTF-8."
            ) from error
        except InputError:
            raise
        except (ValueError, OverflowError, RecursionError) as error:  # of a value, such as a path
            raise InputError(
                f"A value of the settings cannot be used ({_name_error(error)}); correct it."
            ) from error

    def instantiate(self, namespace: Namespace, *more: Any, **kwargs: Any) -> Namespace:
        """Make the objects that settings describe.

        Args:
            namespace: Parsed settings.
            *more: As jsonargparse takes them.
            **kwargs: As jsonargparse takes them.

        Raises:
            InputError: A setting has a value of another kind, such as a list where settings of a
                group are needed, or none.
        """
        self._check_given(namespace)
        try:
            made: Namespace = super().instantiate(namespace, *more, **kwargs)
            return made
        except TypeError as error:
            raise InputError(
                f"The settings cannot be used ({_name_error(error)}); compare them with what "
                f"{self.help_command or f'{self.prog} --help'} lists."
            ) from error

    def _check_given(self, namespace: Namespace) -> None:
        """Raise `InputError` for a setting without a value, which jsonargparse lets pass."""
        for key, usual in self.get_defaults().items():
            if usual is not None and namespace.get(key, usual) is None:
                raise InputError(
                    f"{key} has no value (null); give one, or leave it out for {_clip(usual)}."
                )

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
        sentence = _shorten(write_sentence(" ".join(message.split()), self.prog, keys))
        help_command = self.help_command or f"{self.prog} --help"
        raise InputError(f"{sentence} ({help_command} lists the flags)") from ex


def _shorten(sentence: str) -> str:
    """Shorten a sentence that repeats a value of any length."""
    return sentence if len(sentence) <= _LONGEST else f"{sentence[:200]} ... {sentence[-100:]}"


def _list_settings(arguments: Sequence[str]) -> Iterator[str]:
    """List the arguments that are files of settings: after --config, or by their ending."""
    before = ""
    for argument in arguments:
        option, equals, value = argument.partition("=")
        path = value if equals and option.startswith("-") else argument
        given = (option if equals else before) == "--config"
        if given and path == "-":
            yield path
        elif (given or path.lower().endswith(_SETTINGS)) and _exists(path):
            yield path
        before = argument


def _check_file(path: Path, outer: tuple[Path, ...] = ()) -> None:
    """Read a file of settings, and those that it names, as they are meant beside it."""
    if path.resolve() in outer:
        return
    for name in _list_words(read_settings(path)):
        beside = path.parent / name
        if name.lower().endswith(_SETTINGS) and _exists(str(beside)):
            _check_file(beside, (*outer, path.resolve()))


def _list_words(value: Any) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, dict | list):
        for inner in value.values() if isinstance(value, dict) else value:
            yield from _list_words(inner)


def _check_stream() -> None:
    """Read settings from standard input, which jsonargparse would read without an end."""
    if isinstance(sys.stdin, StringIO) or sys.stdin is None:
        return
    data = read_stream(sys.stdin.buffer, "standard input", MOST_SETTINGS)
    parse_settings(data, "standard input")
    sys.stdin = StringIO(data.decode("utf-8-sig"))


def _exists(path: str) -> bool:
    try:
        return Path(path).exists() and not Path(path).is_dir()
    except (OSError, ValueError):
        return False
