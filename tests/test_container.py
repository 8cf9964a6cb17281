"""The Dockerfile copies what there is, runs as nobody in particular, and starts the command."""

import re
import shlex
import tomllib
from fnmatch import fnmatch
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]


def read_instructions() -> list[tuple[str, str]]:
    """The instructions of the Dockerfile, in order: name and arguments."""
    text = (ROOT / "Dockerfile").read_text(encoding="utf-8")
    lines = "\n".join(line for line in text.splitlines() if not line.startswith("#"))
    joined = lines.replace("\\\n", " ").splitlines()
    return [(name, rest) for name, _, rest in (line.partition(" ") for line in joined) if name]


INSTRUCTIONS = read_instructions()
LAST = max(at for at, (name, _) in enumerate(INSTRUCTIONS) if name == "FROM")


def list_copied() -> list[str]:
    """Files and folders that are copied from the checkout."""
    copies = [shlex.split(rest) for name, rest in INSTRUCTIONS if name == "COPY"]
    return [path for copy in copies if not copy[0].startswith("--from") for path in copy[:-1]]


def is_sent(path: str) -> bool:
    """Whether .dockerignore lets a file through; the last line that fits it decides."""
    sent = True
    for line in (ROOT / ".dockerignore").read_text(encoding="utf-8").splitlines():
        pattern = line.lstrip("!").removeprefix("**/")
        parents = [path, *(str(parent) for parent in Path(path).parents)]
        if line and not line.startswith("#") and any(fnmatch(each, pattern) for each in parents):
            sent = line.startswith("!")
    return sent


def test_what_is_copied_exists_and_is_sent() -> None:
    assert {"skinnet", "web", "pyproject.toml", "constraints.txt"} <= set(list_copied())
    for path in list_copied():
        found = [ROOT / path] if (ROOT / path).is_file() else list((ROOT / path).rglob("*"))
        assert any(is_sent(file.relative_to(ROOT).as_posix()) for file in found), path


@pytest.mark.parametrize(
    ("path", "sent"),
    [
        ("skinnet/inference/models/skin.onnx", True),
        ("web/runtime/ort.wasm.bundle.min.mjs", True),
        ("tools/web_runtime.py", True),
        ("tools/page_hook.py", True),
        ("runs/best.ckpt", False),
        (".git/config", False),
        (".venv/bin/python", False),
    ],
)
def test_the_checkout_alone_is_sent(path: str, sent: bool) -> None:
    assert is_sent(path) == sent


def test_what_the_wheel_needs_is_copied() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    hook = project["tool"]["hatch"]["build"]["targets"]["wheel"]["hooks"]["custom"]["path"]
    needed = [project["project"]["readme"], hook, *project["project"]["license-files"]]
    for path in needed:
        assert is_sent(path) and any(Path(path).is_relative_to(each) for each in list_copied())


def test_the_base_is_a_python_that_the_package_allows() -> None:
    bases = [rest.split()[0] for name, rest in INSTRUCTIONS if name == "FROM"]
    versions = [base for base in bases if base.startswith("python:")]
    assert versions == ["python:3.11-slim"] * 2


def test_it_runs_the_command_without_the_rights_of_root() -> None:
    last = dict(INSTRUCTIONS[LAST:])
    assert last["ENTRYPOINT"] == '["skinnet"]' and last["WORKDIR"] == "/work"
    assert int(last["USER"]) > 0
    assert last["EXPOSE"] == "8765"


def test_the_guide_names_the_commands() -> None:
    guide = (ROOT / "docs" / "install.md").read_text(encoding="utf-8")
    assert "docker build -t skinnet ." in guide
    assert re.search(r"docker run .*-v \"\$PWD:/work\" skinnet predict photo\.jpg", guide)
    assert "-p 127.0.0.1:8765:8765 skinnet web --host 0.0.0.0" in guide
