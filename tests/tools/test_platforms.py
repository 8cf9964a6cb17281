"""Answers of pip are read, and the table and the exit code say what is missing."""

import json
import sys
from pathlib import Path
from subprocess import CompletedProcess

import pytest
from packaging.requirements import Requirement

from tools import platforms
from tools.platforms import PLATFORMS, Index, find_reason, format_table, main
from tools.requirement_closure import Release

AARCH64 = PLATFORMS["Linux aarch64"]


class FakePip:
    """Has a release of every name but `without` on Linux aarch64."""

    def __init__(self, *without: str) -> None:
        self.without, self.calls = without, 0

    def __call__(self, arguments: list[str]) -> CompletedProcess[str]:
        self.calls += 1
        lines = [one for one in arguments[1:] if one[0] != "-" and "/" not in one]
        names = [Requirement(line).name for line in lines]
        assert "--only-binary=:all:" in arguments and "--no-deps" in arguments
        if "--platform=manylinux2014_aarch64" in arguments and set(names) & set(self.without):
            error = "ERROR: No matching distribution found for x\n"
            return CompletedProcess(arguments, 1, "", error)
        found = [{"metadata": {"name": name, "version": "9999"}} for name in dict.fromkeys(names)]
        report = Path(arguments[arguments.index("--report") + 1])
        report.write_text(json.dumps({"install": found}), encoding="utf-8")
        return CompletedProcess(arguments, 0, "", "")


def test_missing_names_are_found_by_halving_and_answers_are_kept() -> None:
    pip = FakePip("c", "f")
    index = Index(pip, AARCH64, "3.12")
    lines = [f"{name}>=1" for name in "abcdefgh"]
    found = index.ask(lines)
    assert {name for name, one in found.items() if one == "no wheel"} == {"c", "f"}
    assert found["a"] == Release("9999", ())
    calls = pip.calls
    assert index.ask(lines) == found and pip.calls == calls
    assert index.ask(["a>=1", "a<2"])["a"] == Release("9999", ()) and pip.calls == calls + 1


def test_reasons_are_short() -> None:
    log = "WARNING: x\nERROR: Could not find a version\nERROR: No matching distribution found for x"
    assert find_reason(log) == "no wheel"
    assert find_reason("ERROR: Cannot connect") == "Cannot connect"
    assert find_reason("") == "pip failed without a word"


def test_the_table_has_a_line_for_each_extra_and_version() -> None:
    found = {
        "Linux x86_64": {"3.11": {"core": {}, "scans": {}}},
        "Linux aarch64": {"3.11": {"core": {}, "scans": {"embreex": "no wheel"}}},
    }
    assert [line.split() for line in format_table(found).splitlines()] == [
        ["extra", "Python", "Linux", "x86_64", "Linux", "aarch64"],
        ["core", "3.11", "yes", "yes"],
        ["scans", "3.11", "yes", "embreex"],
    ]


@pytest.mark.parametrize(("without", "code"), [((), 0), (("embreex",), 0), (("torch",), 1)])
def test_the_exit_code_says_whether_all_can_be_installed(
    without: tuple[str, ...],
    code: int,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    pip = FakePip(*without)
    monkeypatch.setattr(platforms, "find_pip", lambda: pip)
    assert main(["--json", "--python", "3.11", "--extra", "core", "--extra", "scans"]) == code
    found = json.loads(capsys.readouterr().out)
    assert set(found["platforms"]) == set(PLATFORMS) and found["missing"] == code
    missing = found["platforms"]["Linux aarch64"]["3.11"]
    assert missing == {"core": {}, "scans": {"torch": "no wheel"} if code else {}}


def test_an_old_pip_is_refused_in_words(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(platforms, "find_spec", lambda _: None)
    monkeypatch.setattr(
        platforms.subprocess, "run", lambda *_, **__: CompletedProcess([], 0, "pip 23.2 from x", "")
    )
    assert main([]) == 2
    assert "pip 25.0 or later is needed: pip install -U pip" in capsys.readouterr().err


def test_a_pip_is_run_without_the_settings_of_this_machine(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    seen = []

    def run(command: list[str], env: dict[str, str], **_: object) -> CompletedProcess[str]:
        seen.append((command, env))
        return CompletedProcess(command, 0, "pip 26.0 from x", "")

    monkeypatch.setenv("PIP_FIND_LINKS", "/somewhere")
    monkeypatch.setattr(platforms.subprocess, "run", run)
    platforms.find_pip()(["list"])
    command, environment = seen[-1]
    assert command == [sys.executable, "-m", "pip", "list"]
    assert "PIP_FIND_LINKS" not in environment and environment["PIP_CONFIG_FILE"]
