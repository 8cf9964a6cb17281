"""Errors that are sentences for the person who ran the command."""


class InputError(ValueError):
    """An input that cannot be used; the message names it and says what to do."""


class NoFaceError(InputError):
    """A photograph in which no face was found."""
