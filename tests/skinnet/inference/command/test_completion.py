"""Shells complete verbs, flags and their values; each by a shell itself where it is installed."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from skinnet.cli import main
from skinnet.inference._command.completion import SHELLS

CASES = [
    ("pre", "predict"),
    ("predict --rec", "--recursive"),
    ("predict --region s", "skin"),
    ("predict --light fl", "flash"),
    ("maps --fit.map", "--fit.map-weight"),
    ("edit-maps --relight.shadows t", "true"),
    ("maps --config ma", "maps.yaml"),
    ("build-model --app", "--appearance.components"),
    ("completion f", "fish"),
    ("help fi", "fit-shape"),
]

BASH = """
source ./script
words=($1)
COMP_WORDS=(skinnet "${words[@]}")
COMP_CWORD=${#words[@]}
_shtab_skinnet skinnet "${words[-1]}" "${words[-2]}"
printf '%s\\n' "${COMPREPLY[@]}"
"""

ZSH = """
zmodload zsh/zpty
zpty shell zsh -f -i
zpty -w shell 'PS1=; autoload -Uz compinit; compinit -u -D; eval "$(<./script)"; echo re''ady'
while zpty -r shell out; do [[ $out = *ready* ]] && break; done
zpty -w -n shell "skinnet $1"$'\\t'
all=
for i in {1..600}; do
  sleep 0.05
  zpty -r -t shell out && print -r -- "$out" && all+=$out
  [[ $all = *$2* ]] && break
done
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    (tmp_path / "maps.yaml").write_text("warp: {size: 64}\n")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def write_script(shell: str, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    if shutil.which(shell) is None:
        pytest.skip(f"{shell} is not installed")
    assert main(["completion", shell]) == 0
    (folder / "script").write_text(capsys.readouterr().out)


def run(*command: str) -> list[str]:
    done = subprocess.run(command, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    return [line.partition("\t")[0].strip() for line in done.stdout.splitlines()]


@pytest.mark.parametrize("shell", SHELLS)
def test_a_script_is_written(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", shell]) == 0
    out, err = capsys.readouterr()
    assert "fit.map-weight" in out and "white-colour" in out and err == ""


@pytest.mark.parametrize(("typed", "completed"), CASES)
def test_bash_completes(
    typed: str, completed: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_script("bash", folder, capsys)
    assert completed in run("bash", "-c", BASH, "bash", typed)


@pytest.mark.parametrize(("typed", "completed"), CASES)
def test_fish_completes(
    typed: str, completed: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_script("fish", folder, capsys)
    assert completed in run("fish", "-N", "-c", f"source ./script; complete -C 'skinnet {typed}'")


@pytest.mark.slow
@pytest.mark.parametrize(("typed", "completed"), [CASES[0], CASES[1], CASES[8]])
def test_zsh_completes(
    typed: str, completed: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_script("zsh", folder, capsys)
    added = completed.removeprefix(typed.split()[-1])
    assert added in "".join(run("zsh", "-f", "-c", ZSH, "zsh", typed, added))


def test_an_unknown_shell_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", "fsh"]) == 2
    assert "shell is bash, zsh or fish; got 'fsh'. Did you mean fish?" in capsys.readouterr().err


def test_without_the_extra_it_is_named() -> None:
    code = (
        "import sys\nsys.modules['shtab'] = None\n"
        "from skinnet.cli import main\nsys.exit(main(['completion', 'bash']))\n"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.returncode == 2 and 'pip install "skinnet[completion]"' in done.stderr
