"""The table of flags: it is that of the settings, and help needs nothing else."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from skinnet.cli import main
from skinnet.errors import InputError
from skinnet.pipeline._flag_table import TABLE, check_flags, make_parser
from skinnet.pipeline._verbs import PIPELINE_VERBS

EXAMPLES = [
    (verb, command) for verb, each in PIPELINE_VERBS.items() for command, _ in each.examples
]


@pytest.mark.slow
def test_the_table_is_that_of_the_settings() -> None:
    from tools.flag_table import make_table, write_table

    current = TABLE.read_text(encoding="utf-8") == write_table(make_table())
    assert current, "run: python -m tools.flag_table"


@pytest.mark.slow
@pytest.mark.parametrize(("verb", "command"), EXAMPLES)
def test_an_example_is_a_command(verb: str, command: str) -> None:
    from importlib import import_module

    from skinnet.inference._command.spelling import spell_keys
    from skinnet.pipeline._command import make_settings_parser

    program, name, *arguments = shlex.split(command)
    assert (program, name) == ("skinnet", verb)
    checked = check_flags(make_parser(verb), verb, arguments)
    module = import_module(f"skinnet.pipeline._{verb.replace('-', '_')}")
    make_settings_parser(verb, module).parse_args(spell_keys(checked))


@pytest.mark.parametrize("verb", PIPELINE_VERBS)
def test_help_imports_nothing_heavy(verb: str) -> None:
    code = (
        "import sys\n"
        "from skinnet.cli import main\n"
        f"main([{verb!r}, '--help'])\n"
        "heavy = {'torch', 'numpy', 'jsonargparse', 'scipy', 'trimesh'}\n"
        "print('heavy:', *heavy & {*sys.modules})\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.splitlines()[-1] == "heavy:"
    assert len(re.findall(r"^  skinnet ", done.stdout, re.MULTILINE)) in (2, 3)


@pytest.mark.parametrize("verb", PIPELINE_VERBS)
def test_flags_have_hyphens(verb: str) -> None:
    for action in make_parser(verb)._actions:
        for flag in action.option_strings:
            assert re.fullmatch(r"--[a-z.]+(-[a-z.]+)*|-[a-z]", flag), flag


def test_underscores_are_read_and_said(capsys: pytest.CaptureFixture[str]) -> None:
    parser = make_parser("maps")
    given = ["--fit.map_weight=0.5", "--shape_landmarks", "a_b.json"]
    checked = check_flags(parser, "maps", given)
    assert checked == ["--fit.map-weight=0.5", "--shape-landmarks", "a_b.json"]
    said = "skinnet: --shape_landmarks is now written --shape-landmarks.\n"
    assert capsys.readouterr().err == said


@pytest.mark.parametrize(
    ("verb", "given", "now"),
    [
        ("maps", "--model=x", "--model of skinnet maps is now called --shape;"),
        ("fit-shape", "--model_landmarks", "is now called --shape-landmarks;"),
        ("build-model", "--model.components=3", "is now called --appearance.components;"),
        ("maps", "--fit.kep", "maps has no flag --fit.kep. Did you mean --fit.kept?"),
        ("sample", "--cont=3", "Did you mean --count?"),
    ],
)
def test_an_old_or_mistaken_flag_is_answered_with_the_right_one(
    verb: str, given: str, now: str
) -> None:
    with pytest.raises(InputError, match=re.escape(now)):
        check_flags(make_parser(verb), verb, [given, "3"])


@pytest.mark.parametrize(
    ("given", "checked"),
    [
        (["--joint", "skinmaps"], ["--joint=true", "skinmaps"]),
        (["--joint", "false"], ["--joint", "false"]),
        (["skinmaps", "--joint"], ["skinmaps", "--joint=true"]),
        (["--joint=false"], ["--joint=false"]),
    ],
)
def test_a_switch_takes_no_input(given: list[str], checked: list[str]) -> None:
    assert check_flags(make_parser("build-model"), "build-model", given) == checked


def test_quiet_and_verbose_exclude_each_other(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["sample", "-q", "--verbose"]) == 2
    assert "exclude each other" in capsys.readouterr().err


@pytest.mark.parametrize("verb", PIPELINE_VERBS)
def test_a_verb_alone_is_answered(
    verb: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main([verb]) == 2
