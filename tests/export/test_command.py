"""The flags of `python -m export`."""

import shlex

import pytest

from export.__main__ import _DESCRIPTION, _EXAMPLES, add_arguments, main
from skinnet.inference._command.verb_parser import VerbParser


@pytest.mark.parametrize("command", [command for command, _ in _EXAMPLES])
def test_an_example_is_a_command(command: str) -> None:
    words = shlex.split(command)
    assert words[:3] == ["python", "-m", "export"]
    VerbParser("python -m export", _DESCRIPTION, _EXAMPLES, add_arguments).parse(words[3:])


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([], "python -m export needs checkpoint: a .ckpt of training"),
        (["a.ckpt", "--hal"], "has no flag --hal. Did you mean --half?"),
        (["a.ckpt", "-o", "skin.txt"], "does not end in .onnx"),
    ],
)
@pytest.mark.filterwarnings("ignore")
def test_a_mistake_is_a_sentence(
    arguments: list[str], said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) == 2
    out, err = capsys.readouterr()
    assert said in err and out == "" and len(err.splitlines()) == 1
