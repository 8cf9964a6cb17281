"""What requirements bring is found for the platform that is asked about."""

import tomllib
from collections.abc import Mapping

import pytest
from packaging.requirements import Requirement
from packaging.version import Version

from tools.platforms import PLATFORMS, ROOT
from tools.requirement_closure import Release, close, read_extras, select_requirements

LINUX = PLATFORMS["Linux aarch64"].make_environment("3.12")
WINDOWS = PLATFORMS["Windows x86_64"].make_environment("3.12")

INDEX = {
    "a": {"1.0": ("b>=2", "c; sys_platform == 'win32'", "plot; extra == 'draw'")},
    "b": {"1.0": (), "2.0": ("d<3",), "3.0": ("d",)},
    "c": {"1.0": ()},
    "d": {"2.5": (), "3.1": ("new",)},
    "new": {"1.0": ()},
    "plot": {"1.0": ("a",)},
    "pinned": {"1.0": ("b<3", "gone")},
}


def ask(lines: list[str]) -> Mapping[str, Release | str]:
    """The newest release of each name that fits all of its lines."""
    by_name: dict[str, list[Requirement]] = {}
    for requirement in map(Requirement, lines):
        assert requirement.marker is None
        by_name.setdefault(requirement.name, []).append(requirement)
    found: dict[str, Release | str] = {}
    for name, requirements in by_name.items():
        fit = [
            version
            for version in INDEX.get(name, {})
            if all(version in requirement.specifier for requirement in requirements)
        ]
        newest = max(fit, key=Version, default=None)
        found[name] = "no wheel" if newest is None else Release(newest, INDEX[name][newest])
    return found


def test_everything_that_is_required_is_found() -> None:
    found = close(["a"], LINUX, ask)
    assert {name: one.version for name, one in found.releases.items()} == {
        **{"a": "1.0", "b": "3.0"},
        **{"d": "3.1", "new": "1.0"},
    }
    assert not found.missing


def test_markers_are_those_of_the_platform_that_is_asked_about() -> None:
    assert "c" in close(["a"], WINDOWS, ask).releases
    assert "c" not in close(["a"], LINUX, ask).releases
    assert not close(["gone; sys_platform == 'darwin'"], LINUX, ask).missing


def test_extras_bring_their_requirements_even_late_and_in_a_circle() -> None:
    assert "plot" in close(["a[draw]"], LINUX, ask).releases
    assert "plot" in close(["a", "a[draw]"], LINUX, ask).releases
    assert "plot" not in close(["a"], LINUX, ask).releases


def test_a_later_bound_asks_again_with_all_bounds() -> None:
    found = close(["a", "pinned"], LINUX, ask)
    assert found.releases["b"].version == "2.0" and found.releases["d"].version == "2.5"
    assert found.missing == {"gone": "no wheel"}
    assert close(["b>=3", "b<2"], LINUX, ask).missing == {"b": "no wheel"}


def test_a_name_that_the_index_passes_over_is_missing() -> None:
    assert close(["a"], LINUX, lambda _: {}).missing == {"a": "the index did not answer"}


def test_selected_requirements_have_no_markers() -> None:
    lines = ["x>1; python_version >= '3.12'", "y; extra == 'm'", "z; extra == 'n'", "w"]
    assert [str(one) for one in select_requirements(lines, LINUX, ["m"])] == ["x>1", "y", "w"]


def test_extras_of_the_project_itself_are_written_out() -> None:
    project = {
        "name": "Skin_Net",
        "dependencies": ["numpy"],
        "optional-dependencies": {
            "one": ["x"],
            "two": ["skin-net[one]", "y"],
            "all": ["skin-net[two,one]"],
        },
    }
    assert read_extras(project) == {
        "core": ["numpy"],
        "one": ["numpy", "x"],
        "two": ["numpy", "x", "y"],
        "all": ["numpy", "x", "x", "y"],
    }


@pytest.mark.parametrize("extra", ["scans", "train", "dev"])
@pytest.mark.parametrize("platform", PLATFORMS)
def test_embree_is_asked_for_only_where_it_has_wheels(extra: str, platform: str) -> None:
    settings = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    lines = read_extras(settings["project"])[extra]
    environment = PLATFORMS[platform].make_environment("3.12")
    names = {requirement.name for requirement in select_requirements(lines, environment)}
    assert ("embreex" in names) == (platform != "Linux aarch64")
    assert {"numpy", "trimesh", "torch"} <= names
