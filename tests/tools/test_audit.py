"""The audit finds, is skipped in words, and never passes for lack of an answer in silence."""

import json
import subprocess
from collections.abc import Callable

import pytest

from tools import audit

CLEAN = {"name": "a", "version": "1", "vulns": []}
BAD = {"name": "b", "version": "2", "vulns": [{"id": "CVE-1", "fix_versions": ["2.1"]}]}
UNKNOWN = {"name": "c", "version": "3", "skip_reason": "not found"}


def answer(**found: object) -> Callable[..., "subprocess.CompletedProcess[str]"]:
    """A pip-audit that knows some packages by service, and fails for other services."""

    def run(command: list[str], **_: object) -> "subprocess.CompletedProcess[str]":
        service = command[command.index("-s") + 1]
        said = json.dumps({"dependencies": found[service]}) if service in found else ""
        return subprocess.CompletedProcess(command, 0 if said else 1, said, "ConnectionError")

    return run


@pytest.mark.parametrize(
    ("found", "code", "said"),
    [
        ({"pypi": [CLEAN, UNKNOWN]}, 0, "pypi knows 1 packages, 0 vulnerabilities; 1 are not in"),
        ({"pypi": [CLEAN, BAD]}, 1, "b 2 has CVE-1: raise it to 2.1."),
        ({"pypi": [UNKNOWN], "osv": [BAD]}, 1, "osv knows 1 packages, 1 vulnerabilities."),
        ({"pypi": [UNKNOWN]}, 0, "Skipped, since no database"),
        ({}, 0, "Skipped, since no database"),
    ],
)
def test_what_a_database_says(
    found: dict[str, object],
    code: int,
    said: str,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setattr(subprocess, "run", answer(**found))
    assert audit.main() == code
    printed = capsys.readouterr()
    assert said in printed.out + printed.err
