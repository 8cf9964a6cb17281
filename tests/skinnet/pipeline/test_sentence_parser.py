"""Errors of the command line in one sentence."""

import pytest

from skinnet.errors import InputError
from skinnet.pipeline._sentence_parser import SentenceParser


def test_an_error_is_one_line_that_names_the_help() -> None:
    parser = SentenceParser(prog="skinnet maps")
    with pytest.raises(InputError, match=r"--bogus.* \(skinnet maps --help lists the flags\)$"):
        parser.parse_args(["--bogus", "3"])


@pytest.mark.parametrize(
    "message",
    [
        "Option 'old.inner' is not accepted",
        "unrecognized arguments: --data.init_args.old.inner=3",
        "Expected an import path: old - Given value",
        "Given value: {'old': 3}",
    ],
)
def test_an_old_name_is_answered_with_the_new_one(message: str) -> None:
    parser = SentenceParser()
    parser.renamed = {"old": "new"}
    with pytest.raises(InputError, match=r"^'old' is now called 'new'; use the new name\.$"):
        parser.error(message)


@pytest.mark.parametrize("message", ["Option 'older' is not accepted", "an old value: 3"])
def test_other_words_are_left_alone(message: str) -> None:
    parser = SentenceParser()
    parser.renamed = {"old": "new"}
    with pytest.raises(InputError, match="lists the flags"):
        parser.error(message)
