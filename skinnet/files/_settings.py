"""Settings in YAML: text in UTF-8 that stays small when its aliases are written out."""

from pathlib import Path
from typing import Any

import yaml

from skinnet.errors import InputError
from skinnet.files._reading import read_file

MOST_SETTINGS = 1_000_000
"""Largest file of settings, in bytes."""

_MOST_VALUES = 100_000
"""Values of a file with each alias written out; nine levels of aliases make a billion of 1 KB."""

_DEEPEST = 50

_Loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)


def read_settings(path: str | Path) -> Any:
    """Read a YAML or JSON file of settings.

    Args:
        path: The file.

    Returns:
        What it holds, in dictionaries, lists, numbers and text.

    Raises:
        InputError: It is no file, too large, not UTF-8, or not YAML that can be read.
        OSError: As `open`.
    """
    return parse_settings(read_file(path, MOST_SETTINGS), path)


def parse_settings(data: bytes, path: str | Path) -> Any:
    """Parse the content of a file of settings; see `read_settings`."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data.count(b"\n", 0, error.start) + 1
        raise InputError(
            f"{path} is not text in UTF-8: line {line} has the byte 0x{data[error.start]:02x}; "
            "save it as UTF-8."
        ) from error
    try:
        return load_yaml(text)
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        reason = " ".join(str(error).split())
        raise InputError(f"{path} cannot be read as YAML: {reason}; correct it.") from error


def load_yaml(text: str) -> Any:
    """Load YAML whose values, with all aliases written out, are not too many or too deep.

    Raises:
        YAMLError: It is not YAML, or too large or too deep.
    """
    check_yaml(text)
    return yaml.load(text, Loader=_Loader)


def check_yaml(text: str) -> None:
    """Raise `YAMLError` if the values of a text are too many or too deep, with aliases written out.

    Nothing is composed before that is known.
    """
    sizes: dict[str, int] = {}
    opened: list[tuple[str | None, int]] = [(None, 0)]
    for event in yaml.parse(text, Loader=_Loader):
        anchor, size = getattr(event, "anchor", None), 1
        if isinstance(event, yaml.CollectionStartEvent):
            opened.append((anchor, 1))
            if len(opened) > _DEEPEST:
                raise yaml.YAMLError(f"its lists and mappings are more than {_DEEPEST} deep")
            continue
        if isinstance(event, yaml.CollectionEndEvent):
            anchor, size = opened.pop()
        elif isinstance(event, yaml.AliasEvent):
            if any(anchor == name for name, _ in opened):
                raise yaml.YAMLError(f"*{anchor} stands inside of &{anchor}")
            anchor, size = None, sizes.get(event.anchor, 1)
        elif not isinstance(event, yaml.ScalarEvent):
            continue
        if anchor is not None:
            sizes[anchor] = size
        outer, known = opened.pop()
        opened.append((outer, known + size))
        if known + size > _MOST_VALUES:
            raise yaml.YAMLError(f"it has more than {_MOST_VALUES:,} values")
