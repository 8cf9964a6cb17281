"""What a list of requirements brings on a given platform, without installing any of it."""

from collections.abc import Callable, Iterable, Iterator, Mapping
from typing import NamedTuple

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

Environment = Mapping[str, str]
"""Values of the markers of PEP 508, such as `platform_machine`."""


class Release(NamedTuple):
    """A release that an index offers for a platform: its version and its own requirements."""

    version: str
    requirements: tuple[str, ...]


Ask = Callable[[list[str]], Mapping[str, Release | str]]
"""From requirements without markers to the release of each name, or to why there is none."""


class Closure(NamedTuple):
    """All releases by name, and the names that cannot be had, with the reason."""

    releases: dict[str, Release]
    missing: dict[str, str]


def read_extras(project: Mapping[str, object]) -> dict[str, list[str]]:
    """Read the requirements of each extra, and as `core` those that are always there.

    Args:
        project: The table [project] of a pyproject.toml.

    Returns:
        Requirements by extra; those of other extras of the project are written out.
    """
    core, extras = project["dependencies"], project.get("optional-dependencies", {})
    assert isinstance(core, list) and isinstance(extras, dict)
    name = canonicalize_name(str(project["name"]))
    return {"core": core, **{one: [*core, *_expand(one, extras, name)] for one in extras}}


def _expand(extra: str, extras: Mapping[str, list[str]], project: str) -> Iterator[str]:
    for line in extras[extra]:
        requirement = Requirement(line)
        if canonicalize_name(requirement.name) == project:
            for inner in sorted(requirement.extras):
                yield from _expand(inner, extras, project)
        else:
            yield line


def select_requirements(
    lines: Iterable[str], environment: Environment, extras: Iterable[str] = ()
) -> list[Requirement]:
    """Select the requirements whose markers hold on a platform.

    Args:
        lines: Requirements, with markers.
        environment: Values of the markers; pip would take those of the running interpreter.
        extras: Extras of the package that requires them.

    Returns:
        The requirements, without their markers.
    """
    selected = []
    for requirement in map(Requirement, lines):
        marker = requirement.marker
        values = [{**environment, "extra": extra} for extra in ("", *extras)]
        if marker is None or any(marker.evaluate(one) for one in values):
            requirement.marker = None
            selected.append(requirement)
    return selected


def close(lines: Iterable[str], environment: Environment, ask: Ask) -> Closure:
    """Find the releases that requirements bring, and those that these bring.

    Args:
        lines: Requirements, with markers.
        environment: Values of the markers on the platform.
        ask: Asks an index for releases for the platform.

    Returns:
        The releases, and what is missing. The newest release that fits is taken; if a requirement
        that is met later excludes it, the index is asked again with both.
    """
    wanted: dict[str, list[Requirement]] = {}
    releases: dict[str, Release] = {}
    missing: dict[str, str] = {}
    pending = select_requirements(lines, environment)
    while pending:
        changed = [name for name in _add(pending, wanted) if _is_open(name, wanted, releases)]
        asked = [name for name in changed if name not in missing]
        found = ask([str(each) for name in asked for each in wanted[name]]) if asked else {}
        for name in asked:
            answer = found.get(name, "the index did not answer")
            if isinstance(answer, str):
                releases.pop(name, None)
                missing[name] = answer
            else:
                releases[name] = answer
        pending = [
            requirement
            for name in changed
            if name in releases
            for requirement in select_requirements(
                releases[name].requirements, environment, _list_extras(wanted[name])
            )
        ]
    return Closure(releases, missing)


def _add(pending: Iterable[Requirement], wanted: dict[str, list[Requirement]]) -> list[str]:
    """Add requirements; the names of those that are new."""
    names = []
    for requirement in pending:
        name = canonicalize_name(requirement.name)
        if requirement not in wanted.setdefault(name, []):
            wanted[name].append(requirement)
            names.append(name)
    return list(dict.fromkeys(names))


def _is_open(
    name: str, wanted: Mapping[str, list[Requirement]], releases: Mapping[str, Release]
) -> bool:
    """Whether the release is not known, excluded by the newest requirement, or gets an extra."""
    if name not in releases:
        return True
    newest = wanted[name][-1]
    known = _list_extras(wanted[name][:-1])
    fits = all(one.specifier.contains(releases[name].version, True) for one in wanted[name])
    return not fits or not newest.extras <= known


def _list_extras(requirements: Iterable[Requirement]) -> set[str]:
    return {extra for requirement in requirements for extra in requirement.extras}
