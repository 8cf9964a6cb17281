"""Asks pip whether every extra can be installed on every platform, without installing anything.

    python -m tools.platforms [--json] [--extra NAME] [--python 3.12]

Platforms are Linux x86_64 and aarch64 (glibc 2.28 or later), macOS 14 or later on arm64, and
Windows x86_64, with Python 3.11 to 3.13. Only wheels count. Markers are evaluated for the platform
that is asked about; pip itself would take those of the machine that it runs on. The exit code is 1
if an extra cannot be installed somewhere, and 2 if pip cannot ask.
"""

import argparse
import json
import os
import subprocess
import sys
import tomllib
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

from tools.requirement_closure import Release, close, read_extras

ROOT = Path(__file__).parents[1]
PYTHONS = ("3.11", "3.12", "3.13")
_OLDEST_PIP = Version("25.0")
"""Earlier ones load whole wheels to read what these require: a gigabyte for torch."""


class Platform(NamedTuple):
    """A platform as pip names its wheels, and as markers name it."""

    tags: tuple[str, ...]
    sys_platform: str
    system: str
    machine: str

    def make_environment(self, python: str) -> dict[str, str]:
        """Make the values of markers for a version of Python, such as "3.12"."""
        return {
            "implementation_name": "cpython",
            "implementation_version": f"{python}.0",
            "os_name": "nt" if self.system == "Windows" else "posix",
            "platform_machine": self.machine,
            "platform_python_implementation": "CPython",
            "platform_release": "",
            "platform_system": self.system,
            "platform_version": "",
            "python_full_version": f"{python}.0",
            "python_version": python,
            "sys_platform": self.sys_platform,
        }


def _list_manylinux(machine: str) -> tuple[str, ...]:
    newest_first = (f"manylinux_2_{minor}_{machine}" for minor in range(28, 4, -1))
    return (*newest_first, f"manylinux2014_{machine}")


PLATFORMS = {
    "Linux x86_64": Platform(_list_manylinux("x86_64"), "linux", "Linux", "x86_64"),
    "Linux aarch64": Platform(_list_manylinux("aarch64"), "linux", "Linux", "aarch64"),
    "macOS arm64": Platform(("macosx_14_0_arm64",), "darwin", "Darwin", "arm64"),
    "Windows x86_64": Platform(("win_amd64",), "win32", "Windows", "AMD64"),
}

Pip = Callable[[list[str]], subprocess.CompletedProcess[str]]


def find_pip() -> Pip:
    """Find a pip that reads requirements without loading wheels: this one, or virtualenv's.

    Returns:
        A function that runs it with arguments.

    Raises:
        RuntimeError: There is none.
    """
    commands = [["-m", "pip"]]
    spec = find_spec("virtualenv")
    if spec is not None and spec.origin is not None:
        wheels = Path(spec.origin).parent.glob("seed/wheels/embed/pip-*.whl")
        commands += [[f"{wheel}/pip"] for wheel in sorted(wheels, reverse=True)]
    # Settings of this machine, such as an index of its own, say nothing about others.
    environment = {
        **os.environ,
        "PIP_CONFIG_FILE": os.devnull,
        "PIP_DISABLE_PIP_VERSION_CHECK": "1",
    }
    for setting in ("PIP_FIND_LINKS", "PIP_CONSTRAINT", "PIP_EXTRA_INDEX_URL"):
        environment.pop(setting, None)
    for command in commands:

        def run(arguments: list[str], command: list[str] = command) -> Any:
            full = [sys.executable, *command, *arguments]
            return subprocess.run(full, env=environment, capture_output=True, text=True)

        version = run(["--version"]).stdout.split()
        if len(version) > 1 and Version(version[1]) >= _OLDEST_PIP:
            return run
    raise RuntimeError(f"pip {_OLDEST_PIP} or later is needed: pip install -U pip")


class Index:
    """Asks pip for releases for a platform and a version of Python; answers are remembered.

    Args:
        pip: Runs pip.
        platform: The platform.
        python: The version, such as "3.12".
    """

    def __init__(self, pip: Pip, platform: Platform, python: str) -> None:
        self.pip, self.platform, self.python = pip, platform, python
        self._known: dict[frozenset[str], Release | str] = {}

    def ask(self, lines: list[str]) -> dict[str, Release | str]:
        """Ask for requirements without markers; see `requirement_closure.Ask`."""
        by_name: dict[str, list[str]] = {}
        for line in lines:
            by_name.setdefault(canonicalize_name(Requirement(line).name), []).append(line)
        new = {n: each for n, each in by_name.items() if frozenset(each) not in self._known}
        for name, answer in self._ask_pip(new).items():
            self._known[frozenset(new[name])] = answer
        return {name: self._known[frozenset(each)] for name, each in by_name.items()}

    def _ask_pip(self, by_name: Mapping[str, list[str]]) -> dict[str, Release | str]:
        if not by_name:
            return {}
        with TemporaryDirectory() as folder:
            report = Path(folder) / "report.json"
            lines = [line for each in by_name.values() for line in each]
            done = self.pip([*self._options(folder, report), *lines])
            if done.returncode == 0:
                return read_report(json.loads(report.read_text(encoding="utf-8")))
        if len(by_name) > 1:
            # One that is missing fails all: it is found by halving.
            names = list(by_name)
            halves = names[: len(names) // 2], names[len(names) // 2 :]
            parts = [self._ask_pip({name: by_name[name] for name in half}) for half in halves]
            return parts[0] | parts[1]
        return dict.fromkeys(by_name, find_reason(done.stderr))

    def _options(self, folder: str, report: Path) -> list[str]:
        options = "install --dry-run --ignore-installed --no-deps --only-binary=:all: --quiet"
        lazily = ["--use-feature=fast-deps", "--report", str(report), "--target", folder]
        platforms = [f"--platform={tag}" for tag in self.platform.tags]
        return [*options.split(), *lazily, f"--python-version={self.python}", *platforms]


def read_report(report: Mapping[str, Any]) -> dict[str, Release | str]:
    """Read the releases in an installation report of pip."""
    metadata = [one["metadata"] for one in report["install"]]
    return {
        canonicalize_name(one["name"]): Release(one["version"], tuple(one.get("requires_dist", ())))
        for one in metadata
    }


def find_reason(log: str) -> str:
    """Find why pip found no release: no wheel, or its own last error."""
    errors = [line.removeprefix("ERROR: ") for line in log.splitlines() if "ERROR" in line]
    if any("No matching distribution" in line for line in errors):
        return "no wheel"
    return errors[-1] if errors else "pip failed without a word"


def measure(extras: Mapping[str, list[str]], pythons: tuple[str, ...], pip: Pip) -> dict[str, Any]:
    """Ask for each platform, version of Python and extra.

    Returns:
        What is missing, with the reason, by platform, version and extra.
    """
    # Most of the time pip waits for the index.
    with ThreadPoolExecutor(4) as pool:
        pending = {
            name: {
                python: pool.submit(_measure_one, extras, Index(pip, platform, python))
                for python in pythons
            }
            for name, platform in PLATFORMS.items()
        }
        return {
            name: {python: one.result() for python, one in each.items()}
            for name, each in pending.items()
        }


def _measure_one(extras: Mapping[str, list[str]], index: Index) -> dict[str, dict[str, str]]:
    environment = index.platform.make_environment(index.python)
    print(f"{index.platform.tags[0]}, Python {index.python}", file=sys.stderr, flush=True)
    return {name: close(lines, environment, index.ask).missing for name, lines in extras.items()}


def format_table(found: Mapping[str, Any]) -> str:
    """Format one line for each extra and version: "yes", or the names that are missing."""
    pythons = next(iter(found.values()))
    rows = [["extra", "Python", *found]]
    for extra in next(iter(pythons.values())):
        for python in pythons:
            cells = (", ".join(platform[python][extra]) or "yes" for platform in found.values())
            rows.append([extra, python, *cells])
    widths = [max(len(row[i]) for row in rows) for i in range(len(rows[0]))]
    return "\n".join(
        "  ".join(cell.ljust(width) for cell, width in zip(row, widths, strict=True)).rstrip()
        for row in rows
    )


def main(arguments: list[str] | None = None) -> int:
    """Print what can be installed where; return 1 if something cannot, 2 if pip cannot ask."""
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    extras = read_extras(settings["project"])
    parser = argparse.ArgumentParser(prog="python -m tools.platforms", description=__doc__)
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    parser.add_argument("--extra", choices=list(extras), action="append", help="all by default")
    parser.add_argument("--python", choices=PYTHONS, action="append", help="all by default")
    options = parser.parse_args(arguments)
    chosen = {name: extras[name] for name in options.extra or extras}
    try:
        found = measure(chosen, tuple(options.python or PYTHONS), find_pip())
    except RuntimeError as error:
        print(error, file=sys.stderr)
        return 2
    missing = [
        one for pythons in found.values() for each in pythons.values() for one in each.values()
    ]
    results = {"platforms": found, "missing": sum(map(len, missing))}
    print(json.dumps(results) if options.json else format_table(found))
    return int(any(missing))


if __name__ == "__main__":
    sys.exit(main())
