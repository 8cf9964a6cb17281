"""Errors whose messages state what the user can do."""


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
