"""Execution providers of onnxruntime by short names, and what to install for those missing."""

from collections.abc import Sequence
from typing import NamedTuple

import onnxruntime

from skinnet.errors import InputError

CPU, DIRECTML = "CPUExecutionProvider", "DmlExecutionProvider"

_SHORT = {
    "cpu": CPU,
    "cuda": "CUDAExecutionProvider",
    "coreml": "CoreMLExecutionProvider",
    "directml": DIRECTML,
    "tensorrt": "TensorrtExecutionProvider",
    "openvino": "OpenVINOExecutionProvider",
}
"""Short names, in the order in which messages list them."""

_PACKAGES = {
    "cuda": "onnxruntime-gpu",
    "tensorrt": "onnxruntime-gpu",
    "directml": "onnxruntime-directml",
    "openvino": "onnxruntime-openvino",
}
"""Packages that bring a provider; that of CoreML is in onnxruntime for macOS."""


class Providers(NamedTuple):
    """Execution providers that are asked for.

    Attributes:
        wanted: Their names in onnxruntime, the first choice first.
        may_fall_back: Whether the CPU may run instead of the others.
    """

    wanted: tuple[str, ...]
    may_fall_back: bool

    @property
    def installed(self) -> list[str]:
        """Those of them that this onnxruntime has."""
        available = onnxruntime.get_available_providers()
        return [name for name in self.wanted if name in available]


def choose_providers(providers: str | Sequence[str] | None) -> Providers:
    """Choose execution providers by name.

    Args:
        providers: "cuda", "coreml", "directml", "cpu" and the like, names of onnxruntime such as
            "CUDAExecutionProvider", or several of them, of which the first that runs is taken if
            the last one is "cpu"; None for the CPU.

    Raises:
        InputError: A name is not known, or the provider is not installed and the CPU is not named
            last.
    """
    names = [providers] if isinstance(providers, str) else providers
    if names is None:
        return Providers((CPU,), False)
    if not isinstance(names, Sequence) or not names or any(not isinstance(n, str) for n in names):
        raise InputError(
            f'providers is a name such as "cuda", or a list of names; got {providers!r:.80}.'
        )
    wanted = tuple(dict.fromkeys(_find_name(name) for name in names))
    chosen = Providers(wanted, len(wanted) > 1 and wanted[-1] == CPU)
    missing = [name for name in wanted if name not in chosen.installed]
    if missing and not chosen.may_fall_back:
        raise InputError(describe_missing(missing[0]))
    return chosen


def shorten(name: str) -> str:
    """The short name of a provider, such as cuda."""
    by_name = {long: short for short, long in _SHORT.items()}
    return by_name.get(name, name.removesuffix("ExecutionProvider").lower())


def describe_missing(name: str) -> str:
    """Say which providers are installed, and how to get this one."""
    short = shorten(name)
    package = _PACKAGES.get(short)
    remedy = "take one of these"
    if short == "coreml":
        remedy = "it is part of onnxruntime for macOS alone; take one of these"
    elif package is not None:
        remedy = f"pip uninstall onnxruntime, then pip install {package}, or take one of these"
    return (
        f"{short} is not among the execution providers of this onnxruntime "
        f"({onnxruntime.__version__}), which are {_list_installed()}; {remedy}. A list that ends "
        f"in cpu falls back: {_ask(short)}."
    )


def describe_failed(name: str) -> str:
    """Say that a provider is installed, but does not start here."""
    return (
        f"{shorten(name)} is installed, but does not start on this computer: its device, driver or "
        f"libraries are missing. Check them, or fall back: {_ask(shorten(name))}."
    )


def note_fallback(providers: Providers, ran: str) -> tuple[str, ...]:
    """Note that not the first choice has run, but what `ran` names."""
    first = shorten(providers.wanted[0])
    if ran == first:
        return ()
    why = "does not start here" if providers.wanted[0] in providers.installed else "is missing"
    return (f"The networks ran on {ran}, since the execution provider {first} {why}.",)


def _find_name(name: str) -> str:
    known: list[str] = onnxruntime.get_all_providers()
    folded = {each.casefold(): each for each in known}
    folded |= {short: long for short, long in _SHORT.items()} | {"dml": DIRECTML}
    found = folded.get(name.casefold()) or folded.get(f"{name}ExecutionProvider".casefold())
    if found is None:
        raise InputError(
            f"There is no execution provider {name!r:.60}; this onnxruntime has "
            f"{_list_installed()}, and others are {', '.join(_SHORT)}."
        )
    return found


def _ask(short: str) -> str:
    """How a provider is asked for that the processor may stand in for."""
    return f'--provider {short},cpu (in Python providers=["{short}", "cpu"])'


def _list_installed() -> str:
    return ", ".join(shorten(name) for name in onnxruntime.get_available_providers())
