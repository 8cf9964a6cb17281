"""Help of training: quick, complete, and with examples that hold."""

import re
import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from skinnet.errors import InputError
from train.usage import COMMANDS, EXAMPLES, TABLE, answer, make_parser

ROOT = Path(__file__).parents[2]
LINES = [(command, line) for command in COMMANDS for line, _ in EXAMPLES[command]]


def test_without_a_command_the_commands_are_listed() -> None:
    for arguments in ([], ["--help"], ["-h"], ["help"]):
        text = answer(arguments)
        assert text is not None and all(f"\n  {command} " in text for command in COMMANDS)


@pytest.mark.parametrize("arguments", [["fit", "--help"], ["help", "fit"], ["fit", "-h"]])
def test_help_lists_settings_and_examples(arguments: list[str]) -> None:
    text = answer(arguments)
    assert text is not None and text.startswith("usage: python -m train fit")
    assert "--model.losses.soft-iou X" in text and "--data.init-args.batch-size N" in text
    assert text.rstrip().endswith(EXAMPLES["fit"][-1][0])


def test_a_command_that_is_run_is_not_answered() -> None:
    assert answer(["fit", "--config", "configs/quick.yaml"]) is None
    assert answer(["--config", "configs/quick.yaml", "fit"]) is None
    with pytest.raises(InputError, match=r"no command ft\. Did you mean fit\?"):
        answer(["ft"])


@pytest.mark.parametrize(("command", "line"), LINES)
def test_an_example_has_flags_and_files_that_exist(command: str, line: str) -> None:
    words = shlex.split(line)
    assert words[:4] == ["python", "-m", "train", command]
    known = make_parser(command).format_help() + TABLE.read_text(encoding="utf-8")
    assert all(f"{word}" in known for word in words if word.startswith("--"))
    assert all((ROOT / word).is_file() for word in words if re.match("configs/", word))


def test_help_imports_nothing_heavy() -> None:
    code = (
        "import sys\nsys.argv = ['train', 'fit', '--help']\n"
        "from train.__main__ import run\n"
        "run()\n"
        "print('heavy:', *{'torch', 'numpy', 'lightning', 'jsonargparse'} & {*sys.modules})\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    assert done.stdout.splitlines()[-1] == "heavy:"


@pytest.mark.slow
def test_the_table_is_that_of_the_settings() -> None:
    from tools.flag_table import make_train_table, write_table

    current = TABLE.read_text(encoding="utf-8") == write_table(make_train_table())
    assert current, "run: python -m tools.flag_table"


@pytest.mark.slow
def test_hyphens_and_underscores_are_read(capsys: pytest.CaptureFixture[str]) -> None:
    from train.cli import main

    for flag in ("--ckpt-path", "--ckpt_path"):
        command = ["validate", "--config=configs/quick.yaml", f"{flag}=absent.ckpt", "--quiet"]
        assert main(command) == 2
        assert "absent.ckpt" in capsys.readouterr().err
