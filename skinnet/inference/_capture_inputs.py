"""What is known of a capture as inputs of the encoder, or a sentence on what is wrong with it."""

import difflib
from collections.abc import Mapping
from typing import Any, NamedTuple, Protocol, runtime_checkable

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images._raw.raw_file import FORMAT as RAW
from skinnet.images._shot import read_shot
from skinnet.images.picture import Picture
from skinnet.inference._light_names import LIGHT_WORDS, find_light
from skinnet.inference.capture import Capture
from skinnet.inference.onnx_model import OnnxModel

_KELVIN = 4000.0, 25000.0
"""Range of colour temperatures of daylight."""

_LARGEST = {
    "camera": ("coefficients in standard deviations of cameras", 10.0),
    "white_balance": ("natural logarithms of the errors in R/G and B/G", 2.0),
    "exposure": ("the natural logarithm of the luminance of white in the photograph", 4.0),
}
"""What parts are, and how far from 0 they may be: no camera and no photograph of skin is beyond."""


@runtime_checkable
class CaptureLike(Protocol):
    """What has the fields of `Capture`, as numbers, sequences, arrays or tensors."""

    @property
    def light(self) -> Any:
        """Weights of lights."""

    @property
    def temperature(self) -> Any:
        """Colour temperature in kelvin."""

    @property
    def camera(self) -> Any:
        """Coefficients of the camera basis."""

    @property
    def white_balance(self) -> Any:
        """Logarithms of the error in R/G and in B/G."""

    @property
    def linear(self) -> Any:
        """Whether the picture is in linear light."""

    @property
    def exposure(self) -> Any:
        """Logarithm of the luminance of white."""


Inputs = dict[str, NDArray[np.float32]]


class Joined(NamedTuple):
    """Inputs of the encoder, and what the user should read of them."""

    inputs: Inputs
    notes: tuple[str, ...]


def make_capture_inputs(capture: CaptureLike, encoder: OnnxModel) -> Inputs:
    """Make the optional inputs of an encoder, [1] or [1, n], of what is known of one capture.

    Raises:
        InputError: A part of it has another number of values, or values that cannot be.
    """
    if not isinstance(capture, CaptureLike):
        raise InputError(
            f"capture is a skinnet.inference.Capture; got a {type(capture).__name__}. "
            "Capture(temperature=5500.0) is one."
        )
    parts = {name: getattr(capture, name) for name in Capture._fields}
    parts["light"] = _order_lights(capture.light, encoder.lights)
    shapes = {one.name: one.shape[1:] for one in encoder.session.get_overridable_initializers()}
    inputs: Inputs = {}
    for name, part in parts.items():
        shape = shapes[f"known_{name}"]
        values = _read_numbers(name, part, shape[0] if shape else 1)
        if values is not None:
            inputs[f"known_{name}"] = values.reshape(1, *shape).astype(np.float32)
    return inputs


def join_captures(picture: Picture, capture: CaptureLike | None, encoder: OnnxModel) -> Joined:
    """Join what a RAW file tells of its capture with what is given, which comes first.

    Returns:
        The inputs, and a sentence if another camera was given than EXIF names.

    Raises:
        InputError: As `make_capture_inputs`.
    """
    told = Capture.from_photograph(picture)
    found = make_capture_inputs(told, encoder) if picture.format == RAW else {}
    given = {} if capture is None else make_capture_inputs(capture, encoder)
    inputs = found | given
    ordered = {f"known_{name}": inputs.get(f"known_{name}") for name in Capture._fields}
    known = {name: value for name, value in ordered.items() if value is not None}
    return Joined(known, _note_camera(picture, told, given.get("known_camera")))


def name_known(inputs: Inputs) -> tuple[str, ...]:
    """Name what is known, as the fields of `Capture` are named."""
    return tuple(name.removeprefix("known_") for name in inputs)


def _note_camera(
    picture: Picture, told: Capture, given: NDArray[np.float32] | None
) -> tuple[str, ...]:
    if given is None or told.camera is None or np.allclose(given[0], told.camera, atol=0.01):
        return ()
    camera = read_shot(picture.metadata["exif"]).camera
    return (f"{picture.name} is from a {camera} by its EXIF, and another camera was given.",)


def _order_lights(light: Any, names: tuple[str, ...]) -> Any:
    """Weights by name in the order of the encoder's lights; what is no mapping stays."""
    if not isinstance(light, Mapping):
        return light
    weights = dict.fromkeys(names, 0.0)
    for name, weight in light.items():
        weights[_find_lamp(str(name), names)] += weight
    return list(weights.values())


def _find_lamp(name: str, names: tuple[str, ...]) -> str:
    """The light of the encoder that a name in a mapping means."""
    light, temperature = find_light(name)
    if temperature is not None:
        raise InputError(
            f"light of a capture is weights of lights, and {name!r} is daylight of a temperature; "
            f"Capture.from_names(light={name!r}) has both."
        )
    folded = {each.casefold(): each for each in names}
    if light.casefold() not in folded:
        raise InputError(_describe_unknown_light(name, folded))
    return folded[light.casefold()]


def _describe_unknown_light(name: str, folded: Mapping[str, str]) -> str:
    """Say what lights there are; those of the encoder by their names in lower case."""
    close = difflib.get_close_matches(name.casefold(), folded, 1, 0.4)
    close = [folded[each] for each in close]
    close += difflib.get_close_matches(name.casefold(), LIGHT_WORDS, 1, 0.7)
    meant = f"; {close[0]} may be meant" if close else ""
    return (
        f"There is no light of the name {name!r}{meant}. Give daylight, flash, tungsten, or the "
        "temperature of daylight, such as D65 or 5500K (in Python by Capture.from_names), or a "
        f"light of the model: {', '.join(folded.values())}."
    )


def _read_numbers(name: str, part: Any, count: int) -> NDArray[np.float64] | None:
    """The values [count] of a part; None if it is not known."""
    if part is None:
        return None
    try:
        values = np.asarray(part, np.float64).ravel()
    except (TypeError, ValueError, RuntimeError) as error:
        raise InputError(f"{name} of a capture is numbers; got {part!r:.80}.") from error
    if np.isnan(values).all():
        return None
    if values.size != count:
        raise InputError(
            f"{name} of a capture has {count} value{'s' * (count > 1)}; got {values.size}."
        )
    if not np.isfinite(values).all():
        raise InputError(
            f"{name} of a capture has a value that is not finite ({part!r:.80}); give all of its "
            "values, or None for what is not known."
        )
    return _check_values(name, values)


def _check_values(name: str, values: NDArray[np.float64]) -> NDArray[np.float64]:
    if name == "light":
        return _normalise_weights(values)
    if name == "temperature" and not _KELVIN[0] <= values[0] <= _KELVIN[1]:
        raise InputError(
            f"temperature of a capture is that of daylight, {_KELVIN[0]:,.0f} to "
            f"{_KELVIN[1]:,.0f} K; got {values[0]:g}. Lamps are among the lights."
        )
    what, largest = _LARGEST.get(name, ("", np.inf))
    farthest = values[np.abs(values).argmax()]
    if abs(farthest) > largest:
        raise InputError(
            f"{name} of a capture is {what}, between -{largest:g} and {largest:g}; got "
            f"{farthest:g}."
        )
    if name == "linear" and values[0] not in (0, 1):
        raise InputError(
            f"linear of a capture is true, or false for a usual photograph; got {values[0]:g}."
        )
    return values


def _normalise_weights(values: NDArray[np.float64]) -> NDArray[np.float64]:
    if values.min() < 0 or values.sum() <= 0:
        raise InputError(
            f"light of a capture is weights that are not negative, and not all 0; got "
            f"{', '.join(f'{value:g}' for value in values)}."
        )
    weights: NDArray[np.float64] = values / values.sum()
    return weights
