"""The text of a capture profile: YAML with a version, written and read strictly."""

import math
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import yaml

from skinnet._version import __version__
from skinnet.errors import InputError
from skinnet.files._content import explain_format
from skinnet.files._reading import read_file
from skinnet.files._settings import load_yaml
from skinnet.inference._references.shot_settings import ShotSettings
from skinnet.inference._references.spectral_camera import COMPONENTS, list_lights
from skinnet.inference._references.tone_curve import ToneCurve
from skinnet.inference.capture import Capture

_FORMAT = 1
"""Version of the file's content."""

_KIND = "skinnet capture profile"
_MOST_BYTES = 1 << 16

_HEAD = (
    "# Light, camera and tone curve of a session, for skinnet predict --capture. It holds for "
    "photographs\n# of the same camera with the same settings in the same light.\n"
)

_RANGES: Mapping[str, tuple[int, float, float]] = {
    "temperature": (1, 4000, 25000),
    "camera": (COMPONENTS, -10, 10),
    "white_balance": (2, -2, 2),
    "exposure": (1, -4, 4),
    "contrast": (1, -1, 1),
    "bend": (1, -1, 1),
    "flare": (1, 0, 0.2),
    "saturation": (1, -1, 1),
    "delta_e": (2, 0, 100),
    "exposure_value": (1, -60, 60),
}
"""Number of values of each part, and their range."""


class ProfileContent(NamedTuple):
    """What a file holds, as the attributes of `CaptureProfile`."""

    capture: Capture
    linear_capture: Capture | None
    tone: ToneCurve | None
    correction: tuple[tuple[float, ...], ...] | None
    delta_e: tuple[float, float] | None
    source: tuple[str, str]
    settings: ShotSettings
    format: str


class _FaultError(Exception):
    """What is wrong with a file, as the end of a sentence."""


def format_profile(content: ProfileContent) -> str:
    """Format a profile as YAML."""
    name, reference = content.source
    found: dict[str, Any] = {
        "kind": _KIND,
        "format": _FORMAT,
        "skinnet": __version__,
        "source": {"picture": name, "reference": reference, "format": content.format}
        | _drop_missing(content.settings._asdict()),
        "capture": _format_capture(content.capture),
    }
    if content.tone is not None and content.linear_capture is not None:
        found["tone"] = content.tone._asdict()
        found["linear_capture"] = _format_capture(content.linear_capture)
    if content.correction is not None:
        found["correction"] = [list(row) for row in content.correction]
    if content.delta_e is not None:
        found["delta_e"] = list(content.delta_e)
    text: str = yaml.safe_dump(found, sort_keys=False, default_flow_style=None, allow_unicode=True)
    return _HEAD + text


def parse_profile(path: Path) -> ProfileContent:
    """Read a profile.

    Raises:
        InputError: The file is missing, or is not a profile of this format, or has values that
            cannot be.
    """
    found = _read_yaml(path)
    version = found.get("format")
    if type(version) is not int or version != _FORMAT:
        advice = explain_format(version, _FORMAT, found.get("skinnet"))
        raise InputError(
            f"The capture profile {path} has format {version!r}, and this skinnet reads format "
            f"{_FORMAT} ({advice}). Make it again: skinnet capture."
        )
    try:
        return _parse(found)
    except _FaultError as fault:
        raise InputError(
            f"The capture profile {path} is damaged: {fault}. Make it again: skinnet capture."
        ) from fault


def _read_yaml(path: Path) -> dict[str, Any]:
    remedy = "give a file that `skinnet capture` has written"
    try:
        data = read_file(path)
    except FileNotFoundError:
        raise InputError(f"There is no capture profile {path}; {remedy}.") from None
    except OSError as error:
        raise InputError(f"{path} cannot be read ({error.strerror}); {remedy}.") from error
    try:
        if len(data) > _MOST_BYTES:
            raise ValueError("it is too large")
        found = load_yaml(data.decode("utf-8"))
    except (yaml.YAMLError, ValueError, RecursionError) as error:
        raise InputError(f"{path} is not a capture profile; {remedy}.") from error
    if not isinstance(found, dict) or found.get("kind") != _KIND:
        raise InputError(f"{path} is not a capture profile; {remedy}.")
    return found


def _parse(found: dict[str, Any]) -> ProfileContent:
    known = {"kind", "format", "skinnet", "source", "capture"}
    optional = {"tone", "linear_capture", "correction", "delta_e"}
    _check_keys("the file", found, known, optional)
    source = found["source"]
    _check_keys("source", source, {"picture", "reference", "format"}, {"camera", "exposure_value"})
    for name in ("picture", "reference", "format", "camera"):
        if not isinstance(source.get(name, ""), str):
            raise _FaultError(f"{name} is text; got {source[name]!r:.40}")
    if ("tone" in found) != ("linear_capture" in found):
        raise _FaultError("tone and linear_capture belong together, and one is missing")
    tone = None
    if "tone" in found:
        _check_keys("tone", found["tone"], set(ToneCurve._fields), set())
        tone = ToneCurve(**{name: _read_number(name, found["tone"]) for name in ToneCurve._fields})
    linear = _parse_capture(found["linear_capture"]) if "linear_capture" in found else None
    delta_e = _read_numbers("delta_e", found["delta_e"]) if "delta_e" in found else None
    value = _read_number("exposure_value", source) if "exposure_value" in source else None
    return ProfileContent(
        _parse_capture(found["capture"]),
        linear,
        tone,
        _parse_correction(found["correction"]) if "correction" in found else None,
        None if delta_e is None else (delta_e[0], delta_e[1]),
        (source["picture"], source["reference"]),
        ShotSettings(source.get("camera"), value),
        source["format"],
    )


def _parse_capture(found: Any) -> Capture:
    _check_keys("capture", found, {"white_balance"}, set(Capture._fields))
    parts: dict[str, Any] = {}
    for name in ("temperature", "exposure"):
        if name in found:
            parts[name] = _read_number(name, found)
    for name in ("camera", "white_balance"):
        if name in found:
            parts[name] = _read_numbers(name, found[name])
    if "linear" in found:
        if not isinstance(found["linear"], bool):
            raise _FaultError(f"linear is true or false; got {found['linear']!r:.40}")
        parts["linear"] = found["linear"]
    if "light" in found:
        parts["light"] = _parse_light(found["light"])
    return Capture(**parts)


def _parse_light(found: Any) -> dict[str, float]:
    if not isinstance(found, dict) or not found or not set(found) <= set(list_lights()):
        raise _FaultError(f"light is weights of {', '.join(list_lights())}; got {found!r:.60}")
    for weight in found.values():
        if isinstance(weight, bool) or not isinstance(weight, int | float) or not 0 <= weight <= 1:
            raise _FaultError(f"a weight of a light is in [0, 1]; got {weight!r:.40}")
    if sum(found.values()) <= 0:
        raise _FaultError("all weights of lights are 0")
    return dict(found)


def _parse_correction(found: Any) -> tuple[tuple[float, ...], ...]:
    rows = found if isinstance(found, list) else []
    flat = [one for row in rows if isinstance(row, list) and len(row) == 3 for one in row]
    numbers = [one for one in flat if isinstance(one, int | float) and math.isfinite(one)]
    if len(rows) != 3 or len(numbers) != 9:
        raise _FaultError("correction is three rows of three numbers")
    return tuple(tuple(float(one) for one in row) for row in rows)


def _check_keys(where: str, found: Any, needed: set[str], optional: set[str]) -> None:
    if not isinstance(found, dict):
        raise _FaultError(f"{where} is not a list of names and values")
    if missing := needed - set(found):
        raise _FaultError(f"{where} has no {', '.join(sorted(missing))}")
    if unknown := set(map(str, found)) - needed - optional:
        raise _FaultError(f"{where} has the unknown {', '.join(sorted(unknown))}")


def _read_number(name: str, found: Mapping[str, Any]) -> float:
    return _read_numbers(name, [found[name]])[0]


def _read_numbers(name: str, found: Any) -> tuple[float, ...]:
    count, low, high = _RANGES[name]
    values = found if isinstance(found, list) else []
    fit = [
        isinstance(one, int | float) and not isinstance(one, bool) and low <= one <= high
        for one in values
    ]
    if len(values) != count or not all(fit):
        raise _FaultError(
            f"{name} is {count} number{'s' * (count > 1)} in [{low:g}, {high:g}]; got {found!r:.60}"
        )
    return tuple(float(one) for one in values)


def _format_capture(capture: Capture) -> dict[str, Any]:
    parts = _drop_missing(capture._asdict())
    # Copies, since YAML would refer from one to the other.
    return {
        name: dict(part)
        if isinstance(part, Mapping)
        else list(part)
        if isinstance(part, Sequence)
        else part
        for name, part in parts.items()
    }


def _drop_missing(parts: Mapping[str, Any]) -> dict[str, Any]:
    return {name: part for name, part in parts.items() if part is not None}
