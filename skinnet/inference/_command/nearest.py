"""The nearest valid word to a mistaken one."""

from collections.abc import Iterable


def find_nearest(word: str, known: Iterable[str]) -> str | None:
    """Find the known word that was probably meant.

    Args:
        word: What was given.
        known: The words that are valid.

    Returns:
        The nearest word, None if none is near.

    Example:
        >>> find_nearest("predit", ["predict", "edit", "person"])
        'predict'
    """
    from difflib import get_close_matches  # imported for mistakes alone

    plain = {_simplify(each): each for each in known}
    found = get_close_matches(_simplify(word), plain, 1, 0.6)
    if found:
        return plain[found[0]]
    start = _simplify(word)
    beginnings = [each for name, each in plain.items() if start and name.startswith(start)]
    return beginnings[0] if len(beginnings) == 1 else None


def suggest(word: str, known: Iterable[str]) -> str:
    """Ask whether the nearest word was meant; empty if none is near.

    Args:
        word: What was given.
        known: The words that are valid.

    Returns:
        A question that begins with a blank.

    Example:
        >>> suggest("fce", ["face", "skin"])
        ' Did you mean face?'
    """
    nearest = find_nearest(word, known)
    return f" Did you mean {nearest}?" if nearest else ""


def _simplify(word: str) -> str:
    return word.lower().strip("-").replace("_", "-")
