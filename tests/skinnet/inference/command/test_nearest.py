"""The nearest valid word."""

import pytest

from skinnet.inference._command.nearest import find_nearest, suggest


@pytest.mark.parametrize(
    ("word", "known", "nearest"),
    [
        ("predit", ["predict", "edit"], "predict"),
        ("PREDICT", ["predict", "edit"], "predict"),
        ("--white_colour", ["--white", "--white-colour"], "--white-colour"),
        ("--rec", ["--recursive", "--region"], "--recursive"),
        ("--re", ["--recursive", "--region"], None),
        ("paint", ["predict", "edit"], None),
        ("", ["predict"], None),
    ],
)
def test_the_nearest_word_is_found(word: str, known: list[str], nearest: str | None) -> None:
    assert find_nearest(word, known) == nearest
    assert (nearest or "") in suggest(word, known)
