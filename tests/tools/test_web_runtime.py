"""The runtime of the page is fetched whole, or a sentence says why it is not."""

import io
import subprocess
import tarfile
from pathlib import Path
from typing import Any

import pytest

from tools import web_runtime


def test_without_npm_a_sentence_says_so(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(web_runtime, "TARGET", tmp_path / "runtime")
    monkeypatch.setattr(web_runtime.shutil, "which", lambda name: None)
    assert web_runtime.main() == 1
    assert "npm is not installed" in capsys.readouterr().err
    assert not (tmp_path / "runtime").exists()


def test_another_file_than_was_tried_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def pack(command: list[str], **options: Any) -> "subprocess.CompletedProcess[str]":
        with tarfile.open(Path(command[-1]) / "package.tgz", "w:gz") as archive:
            for path in web_runtime.PACKAGES[command[3]]:
                member = tarfile.TarInfo(f"package/{path}")
                member.size = 5
                archive.addfile(member, io.BytesIO(b"other"))
        return subprocess.CompletedProcess(command, 0, "", "")

    monkeypatch.setattr(web_runtime.shutil, "which", lambda name: "npm")
    monkeypatch.setattr(web_runtime.subprocess, "run", pack)
    with pytest.raises(web_runtime.FetchError, match="SHA-256"):
        web_runtime.fetch(tmp_path / "runtime")
    assert not (tmp_path / "runtime").exists()


def test_a_network_that_fails_is_a_sentence(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    failed = subprocess.CompletedProcess([], 1, "", "npm error network ENOTFOUND\n")
    monkeypatch.setattr(web_runtime.shutil, "which", lambda name: "npm")
    monkeypatch.setattr(web_runtime.subprocess, "run", lambda *args, **options: failed)
    with pytest.raises(web_runtime.FetchError, match="ENOTFOUND"):
        web_runtime.fetch(tmp_path)
