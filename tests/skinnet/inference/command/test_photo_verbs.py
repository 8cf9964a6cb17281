"""Help, examples and flags of the verbs of photographs."""

import re
import shlex
import subprocess
import sys
from importlib import import_module

import pytest

from skinnet.cli import main
from skinnet.inference._command.photo_verbs import PHOTO_VERBS
from skinnet.inference._command.verb_parser import VerbParser

EXAMPLES = [(verb, command) for verb, each in PHOTO_VERBS.items() for command, _ in each.examples]

HEAVY = "{'torch', 'numpy', 'onnxruntime', 'PIL', 'skimage', 'scipy', 'jsonargparse', 'trimesh'}"


def make(verb: str) -> VerbParser:
    each = PHOTO_VERBS[verb]
    return VerbParser(f"skinnet {verb}", each.description, each.examples, each.add)


@pytest.mark.parametrize(("verb", "command"), EXAMPLES)
def test_an_example_is_a_command(verb: str, command: str) -> None:
    words = shlex.split(command)  # perhaps with a pipe before it and a redirection after it
    start = words.index("skinnet")
    end = words.index(">") if ">" in words else len(words)
    assert words[start + 1] == verb
    make(verb).parse(words[start + 2 : end])


@pytest.mark.parametrize("verb", PHOTO_VERBS)
def test_help_ends_with_examples(verb: str) -> None:
    text = make(verb).format_help()
    shown = re.findall(r"^  (.*skinnet .+)$", text.partition("examples:\n")[2], re.MULTILINE)
    assert shown == [command for each, command in EXAMPLES if each == verb]
    assert 2 <= len(shown) <= 5


@pytest.mark.parametrize("verb", PHOTO_VERBS)
def test_its_functions_are_there(verb: str) -> None:
    for place in filter(None, (PHOTO_VERBS[verb].run, PHOTO_VERBS[verb].prepare)):
        module, _, name = place.partition(":")
        assert callable(getattr(import_module(module), name))


@pytest.mark.parametrize("verb", PHOTO_VERBS)
def test_flags_have_hyphens_and_a_meaning(verb: str) -> None:
    for action in make(verb)._actions:
        assert action.help
        for flag in action.option_strings:
            assert re.fullmatch(r"--[a-z]+(-[a-z]+)*|-[a-z]", flag), flag


@pytest.mark.parametrize("order", [["predict", "--help"], ["help", "predict"], ["-h", "predict"]])
def test_help_is_found(order: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(order) == 0
    assert capsys.readouterr().out.startswith("usage: skinnet predict")


@pytest.mark.parametrize("arguments", [["--help"], *([verb, "--help"] for verb in PHOTO_VERBS)])
def test_help_imports_nothing_heavy(arguments: list[str]) -> None:
    code = (
        "import sys\n"
        "from skinnet.cli import main\n"
        f"main({arguments!r})\n"
        f"print('heavy:', *{HEAVY} & {{*sys.modules}})\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "heavy:"
