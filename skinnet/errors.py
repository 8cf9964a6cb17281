"""Errors whose messages state what the user can do."""

from skinnet._version import __version__


class InputError(ValueError):
    """An input cannot be used; the message names it, gives its value and states what to do.

    Example:
        >>> from skinnet.images import read_photo
        >>> read_photo("absent.jpg")
        Traceback (most recent call last):
        skinnet.errors.InputError: There is no file absent.jpg; check the path.
    """


class NoFaceError(InputError):
    """No face was found in a photograph."""


def _explain_format(found: object, known: int, version: object) -> str:
    """Say which skinnet wrote a file of another format, and how to get it.

    Args:
        found: The file's format.
        known: The format that is read here.
        version: The version that wrote the file; None where the file does not say.
    """
    who = f"skinnet {version}" if version else "another version of skinnet"
    wrote = f"{who} wrote it, and this is skinnet {__version__}"
    text = str(found)
    if text.isdecimal() and int(text) > known:
        return f"{wrote}: pip install -U skinnet"
    known_here = version in (None, __version__)
    return wrote if known_here else f'{wrote}: pip install "skinnet=={version}"'
