"""Melanin and hemoglobin maps of a photograph of skin."""

from typing import Any

import lazy_loader

from skinnet._version import __version__ as __version__
from skinnet.errors import _TORCH

_import_public, _, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    """Import a public name at its first use."""
    try:
        return _import_public(name)
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in _TORCH:
            raise
        raise ImportError(
            f'skinnet.{name} needs the torch extra: pip install "skinnet[torch]"', name=error.name
        ) from error


def __dir__() -> list[str]:
    """Public names and the version."""
    return [*__all__, "__version__"]
