"""What -v says before a verb runs: versions, and the flags that were not given."""

import argparse
from collections.abc import Sequence

from skinnet._version import __version__

PHOTO_PACKAGES = ("numpy", "pillow", "onnxruntime", "scipy", "scikit-image", "imagecodecs")
SCAN_PACKAGES = ("numpy", "scipy", "torch", "trimesh", "embreex", "jsonargparse")

_SILENT = ("help", "quiet", "verbose")


def describe_versions(packages: Sequence[str] = ()) -> str:
    """Name the program and its version, and those of what it stands on.

    Args:
        packages: Packages whose versions are wanted too.

    Returns:
        A line.
    """
    if not packages:
        return f"skinnet {__version__}"
    import platform  # slow

    found = ", ".join(f"{name} {_find_version(name)}" for name in packages)
    system = f"Python {platform.python_version()} on {platform.platform()}"
    return f"skinnet {__version__}, {system}, {found}"


def describe_assumptions(parser: argparse.ArgumentParser, options: argparse.Namespace) -> str:
    """Describe the options that have their default.

    Args:
        parser: The parser of a verb.
        options: What it has parsed.

    Returns:
        A sentence.
    """
    usual: dict[str, object] = {}
    for action in parser._actions:
        if action.option_strings and action.dest not in _SILENT:
            usual.setdefault(action.dest, action.default)
    kept = [name for name, value in usual.items() if getattr(options, name, None) == value]
    words = [f"{name.replace('_', '-')} {_write(usual[name])}" for name in kept]
    return f"not given, and so assumed: {', '.join(words) or 'nothing'}."


def _write(value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    return "none" if value is None else str(value)


def _find_version(package: str) -> str:
    from importlib.metadata import PackageNotFoundError, version  # slow

    try:
        return version(package)
    except PackageNotFoundError:
        return "absent"
