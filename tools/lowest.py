"""The lowest versions that pyproject.toml allows, as constraints: `python -m tools.lowest`.

`make test-lowest` installs them and runs the tests.
"""

import re
import tomllib
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[1]
_BOUND = re.compile(r"^([A-Za-z0-9_.-]+)(?:\[.*\])?>=([0-9][0-9A-Za-z.]*)")


def read_lowest_versions(project: Path) -> dict[str, str]:
    """Read the lower bound of every package that a pyproject.toml names, extras included."""
    settings = tomllib.loads(project.read_text(encoding="utf-8"))["project"]
    return dict(sorted(_bounds(settings)))


def _bounds(settings: dict[str, object]) -> Iterator[tuple[str, str]]:
    needed = settings["dependencies"]
    extras = settings["optional-dependencies"]
    assert isinstance(needed, list) and isinstance(extras, dict)
    for requirement in [*needed, *(one for extra in extras.values() for one in extra)]:
        if found := _BOUND.match(requirement):
            yield found[1], found[2]


def main() -> None:
    """Print one constraint a line."""
    for name, version in read_lowest_versions(ROOT / "pyproject.toml").items():
        print(f"{name}=={version}")


if __name__ == "__main__":
    main()
