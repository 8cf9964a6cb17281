"""Writes what a plain install brings: `python -m tools.bill_of_materials FOLDER`.

`cyclonedx-py` describes the environment; what the plain install does not require is left out. To it
come the parts that the wheel has within it: the libraries of the web page. The result is
`skinnet-VERSION.cdx.json` in CycloneDX, with the version and licence of each package.
"""

import json
import subprocess
import sys
import tomllib
from collections.abc import Iterable, Mapping
from importlib.metadata import PackageNotFoundError, distribution, metadata
from pathlib import Path
from typing import Any

from packaging.markers import default_environment
from packaging.utils import canonicalize_name

from skinnet._version import __version__
from skinnet.files import make_folder, write_text
from tools.requirement_closure import select_requirements
from tools.web_runtime import MEDIABUNNY, ORT

ROOT = Path(__file__).parents[1]

_ROOT_REFERENCE = "root-component"

_LIBRARIES = (
    (ORT, "MIT", "Runs the networks"),
    (MEDIABUNNY, "MPL-2.0", "Takes videos apart"),
)
"""What the wheel has within it: packages of npm, their licences, and what they do."""


def main() -> int:
    """Write the bill of materials of the plain install, in the versions that are installed here."""
    folder = make_folder(Path(sys.argv[1] if len(sys.argv) > 1 else "dist"), "give another folder")
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    with_runtime = (ROOT / "web" / "runtime" / "package.txt").is_file()
    bill = select(describe_environment(), list_names(project["dependencies"]), with_runtime)
    path = folder / f"skinnet-{__version__}.cdx.json"
    write_text(path, json.dumps(bill, indent=2, sort_keys=True) + "\n")
    print(f"{path}: {len(bill['components'])} components")
    return 0


def describe_environment() -> dict[str, Any]:
    """Describe everything that is installed here, in CycloneDX."""
    flags = ("--pyproject", str(ROOT / "pyproject.toml"), "--mc-type", "library")
    command = ("cyclonedx_py", "environment", *flags, "--output-reproducible", sys.executable)
    done = subprocess.run([sys.executable, "-m", *command], check=True, stdout=subprocess.PIPE)
    bill: dict[str, Any] = json.loads(done.stdout)
    return bill


def list_names(lines: Iterable[str]) -> set[str]:
    """List the names of the packages that requirements bring here, without any extras of ours.

    Args:
        lines: Requirements, with markers.
    """
    environment = {name: str(value) for name, value in default_environment().items()}
    pending = select_requirements(lines, environment)
    found: set[str] = set()
    while pending:
        requirement = pending.pop()
        name = canonicalize_name(requirement.name)
        try:
            inner = distribution(name).requires or ()
        except PackageNotFoundError as error:
            raise SystemExit(f"{name} is not installed; make .venv/.ready installs it.") from error
        if name not in found or requirement.extras:
            pending += select_requirements(inner, environment, requirement.extras)
        found.add(name)
    return found


def select(bill: Mapping[str, Any], names: set[str], with_runtime: bool) -> dict[str, Any]:
    """Select what a plain install brings.

    Args:
        bill: The bill of materials of an environment.
        names: Names of the packages that stay.
        with_runtime: Whether the wheel has the runtime of the web page.

    Returns:
        A bill of materials with these packages, and the graph of their dependencies.
    """
    kept = [
        _name_licence(each)
        for each in bill["components"]
        if canonicalize_name(each["name"]) in names
    ]
    if with_runtime:
        kept += [_describe_library(*each) for each in _LIBRARIES]
    references = {_ROOT_REFERENCE, *(each["bom-ref"] for each in kept)}
    graph = [
        {**each, "dependsOn": sorted(references.intersection(each.get("dependsOn", ())))}
        for each in bill["dependencies"]
        if each["ref"] in references
    ]
    about = dict(bill["metadata"])
    about["component"] = {**about["component"], "version": __version__}
    return {**bill, "metadata": about, "components": kept, "dependencies": graph}


def _name_licence(component: dict[str, Any]) -> dict[str, Any]:
    """Take the licence that a package states in words, where there is no standard name."""
    stated = metadata(component["name"])["License"]
    if component.get("licenses") or not stated:
        return component
    name = {"acknowledgement": "declared", "name": stated.splitlines()[0]}
    return {**component, "licenses": [{"license": name}]}


def _describe_library(package: str, licence: str, task: str) -> dict[str, Any]:
    name, _, version = package.partition("@")
    return {
        "bom-ref": package,
        "description": f"{task} in the web page; it lies within the wheel.",
        "licenses": [{"license": {"acknowledgement": "declared", "id": licence}}],
        "name": name,
        "purl": f"pkg:npm/{package}",
        "type": "library",
        "version": version,
    }


if __name__ == "__main__":
    sys.exit(main())
