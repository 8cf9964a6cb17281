"""The parser's messages in plain words."""

import pytest

from skinnet.pipeline._sentences import write_sentence

KEYS = ["shape", "fit.kept", "colour.white", "config"]


@pytest.mark.parametrize(
    ("message", "sentence"),
    [
        (
            "Group 'fit' does not accept option 'keep'",
            "There is no setting fit.keep. Did you mean fit.kept?",
        ),
        ("Option 'zzz' is not accepted", "There is no setting zzz."),
        ("unrecognized arguments: --shap=3 x", "There is no flag --shap. Did you mean --shape?"),
        (
            "Parser key \"fit.kept\": Expected a <class 'float'>. Got value: abc",
            "fit.kept is a number; got abc.",
        ),
        (
            'Parser key "colour.white": Does not validate against any of the Union subtypes '
            "Subtypes: [] Errors: - Expected Given value type: <class 'str'> Given value: 3",
            "colour.white cannot be 3; look at what it takes.",
        ),
        (
            "Parser key \"config\": File does not exist: '/a/b.yaml'",
            "There is no file /a/b.yaml; check the path.",
        ),
        ("the following arguments are required: scan", "skinnet maps needs scan."),
        (
            "argument --fit.normals: invalid choice: 'tru' (choose from 'true', 'false')",
            "--fit.normals is one of true, false; got tru. Did you mean true?",
        ),
        ("something else", "something else"),
    ],
)
def test_a_message_is_a_sentence(message: str, sentence: str) -> None:
    assert write_sentence(message, "skinnet maps", KEYS) == sentence
