"""The project's ONNX files: open them, check them, and read their metadata."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import onnxruntime
from numpy.typing import NDArray

from skinnet.errors import InputError, _clip, _name_error
from skinnet.files._content import explain_format
from skinnet.images._arguments import check_path
from skinnet.inference._onnx_header import Header
from skinnet.inference._onnx_session import (
    REMEDY,
    RUNTIME_ERRORS,
    check_threads,
    identify,
    name_versions,
    open_session,
)
from skinnet.inference._onnx_weights import check_weights
from skinnet.inference._providers import choose_providers, shorten
from skinnet.inference.capture import Capture

ONNX_FORMAT = "2"
"""Version of the inputs, outputs and metadata of a file."""

SHIPPED_ENCODER = Path(__file__).parent / "models" / "skin.onnx"
"""The encoder that comes with the package; its decoder is in the same folder."""

MAP_NAMES = ("melanin", "hemoglobin", "shading", "specular", "offset")
"""Maps that are outputs of the encoder and inputs of the decoder; `mask` is an output only."""

CAPTURE_NAMES = ("light", "temperature", "camera", "white_balance")
"""Light and camera of a photograph: outputs of the encoder and inputs of the decoder."""

_KNOWN_NAMES = tuple(f"known_{name}" for name in Capture._fields)
"""What may be known of a capture: optional inputs of the encoder; NaN is what is not known."""

_SD_NAMES = ("melanin_sd", "hemoglobin_sd")
"""Maps of the standard deviations of the pigments' natural logarithms."""

_INPUTS = {"encoder": {"image"}, "decoder": {*MAP_NAMES, *CAPTURE_NAMES}}
_OPTIONAL = {"encoder": set(_KNOWN_NAMES), "decoder": set[str]()}
_OUTPUTS = {
    "encoder": {*MAP_NAMES, *CAPTURE_NAMES, *_SD_NAMES, "mask", "face_sd"},
    "decoder": {"image"},
}


class OutputInfo(NamedTuple):
    """Unit, range and description of one output of the encoder.

    Attributes:
        unit: Unit of the values.
        range: Smallest and largest value.
        description: What the values measure.
    """

    unit: str
    range: tuple[float, float]
    description: str


@dataclass(frozen=True)
class OnnxModel:
    """An open encoder or decoder with its metadata.

    Attributes:
        path: The file.
        session: The onnxruntime session.
        version: Version of skinnet that exported the file.
        trained_on: What the weights were trained on.
        optics: Preset of the skin's constants to which the fractions belong.
        working_size: Longer side, in pixels, to which the encoder's photographs are resized.
        lights: Names of the lights that the output `light` weights.
        output_info: Unit, range and description of each map of the encoder; empty for a decoder.
        region_share: Of melanin and hemoglobin: how much of the variance that pixels have beyond
            that of the face remains in the mean of a region.

    Example:
        >>> import numpy as np
        >>> from skinnet.inference import SHIPPED_ENCODER, open_model
        >>> encoder = open_model(SHIPPED_ENCODER, "encoder", threads=1)
        >>> maps = encoder.run({"image": np.full((1, 64, 48, 3), 180, np.uint8)})
        >>> maps["melanin"].shape, encoder.output_info["melanin"].unit
        ((1, 64, 48), 'volume fraction')
    """

    path: Path
    session: onnxruntime.InferenceSession
    version: str
    trained_on: str
    optics: str
    working_size: int
    lights: tuple[str, ...]
    output_info: Mapping[str, OutputInfo]
    region_share: tuple[float, float]

    @property
    def provider(self) -> str:
        """Short name of the execution provider that runs it, such as cpu or cuda."""
        return shorten(self.session.get_providers()[0])

    def describe(self) -> dict[str, str]:
        """Describe the weights, as a `Decomposition` names its model.

        Returns:
            `version`, `trained_on` and `optics`.
        """
        return {"version": self.version, "trained_on": self.trained_on, "optics": self.optics}

    def run(self, inputs: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[np.float32]]:
        """Run the network.

        Args:
            inputs: `image`, uint8 sRGB [batch, h, w, 3], for an encoder, and optionally what is
                known of the capture, `known_light` and so on, NaN where it is not; `MAP_NAMES`,
                [batch, h, w] or [batch, h, w, 3], and `CAPTURE_NAMES` for a decoder.

        Returns:
            Outputs by name; the decoder's `image` is sRGB [batch, h, w, 3].

        Raises:
            InputError: The network cannot take these inputs.
        """
        names = [output.name for output in self.session.get_outputs()]
        try:
            values = self.session.run(names, dict(inputs))
        except RUNTIME_ERRORS as error:
            raise InputError(f"{self.path} failed on this photograph: {error}") from error
        for name, value in zip(names, values, strict=True):
            if not np.isfinite(value).all():
                raise InputError(
                    f"{self.path} gives numbers that are not finite ({name}); its weights are "
                    f"damaged: {REMEDY}."
                )
        return dict(zip(names, values, strict=True))


def open_model(
    path: Path,
    kind: str,
    threads: int | None = None,
    providers: str | Sequence[str] | None = None,
) -> OnnxModel:
    """Open an encoder or a decoder.

    Args:
        path: The ONNX file.
        kind: "encoder" or "decoder".
        threads: Number of threads; None for all cores.
        providers: Execution providers, as for `Decomposer`; None for the CPU.

    Returns:
        The open model.

    Raises:
        InputError: The file is missing, damaged, not one of skinnet's, of another format, or of
            the other kind; or a provider is not installed, or does not start.

    Example:
        >>> from skinnet.inference import SHIPPED_ENCODER, open_model
        >>> open_model(SHIPPED_ENCODER, "encoder").working_size
        160
    """
    path, threads = check_path("A model", path), check_threads(threads)
    chosen = choose_providers(providers)
    header = identify(path, kind)
    # First, since a file that is newer than onnxruntime says so in its metadata too.
    _check_metadata(path, kind, header)
    check_weights(path, REMEDY)
    session = open_session(path, header, threads, chosen)
    _check_names(path, kind, session)
    return _read_metadata(path, session, header.metadata)


def _check_metadata(path: Path, kind: str, header: Header) -> None:
    metadata = header.metadata
    actual, found = metadata.get("skinnet.kind"), metadata.get("skinnet.format")
    if actual is None:
        raise InputError(
            f"{path} is an ONNX file, but not one of skinnet's (it has {name_versions(header)}); "
            f"{REMEDY}."
        )
    if found != ONNX_FORMAT:
        advice = explain_format(found, int(ONNX_FORMAT), metadata.get("skinnet.version"))
        raise InputError(
            f"{path} has format {_clip(found)}, and this skinnet reads format {ONNX_FORMAT}; "
            f"export it again with this version, or use the one that wrote it ({advice})."
        )
    if actual != kind:
        raise InputError(
            f"{path} is {_with_article(_clip(actual))}, but {_with_article(kind)} is needed; "
            f"{REMEDY}."
        )


def _check_names(path: Path, kind: str, session: onnxruntime.InferenceSession) -> None:
    try:
        inputs = {item.name for item in session.get_inputs()}
        outputs = {item.name for item in session.get_outputs()}
        optional = {item.name for item in session.get_overridable_initializers()}
    except UnicodeDecodeError as error:
        raise InputError(f"{path} is damaged: a name in it is not UTF-8; {REMEDY}.") from error
    is_complete = _OPTIONAL[kind] <= optional and _OUTPUTS[kind] <= outputs
    if inputs != _INPUTS[kind] or not is_complete:
        found = ", ".join(sorted(inputs | optional))
        raise InputError(
            f"{path} is labelled as {_with_article(kind)}, but its inputs are "
            f"{_clip(found, 300)} and its outputs {_clip(', '.join(sorted(outputs)), 300)}; "
            f"{REMEDY}."
        )


def _read_metadata(
    path: Path, session: onnxruntime.InferenceSession, metadata: Mapping[str, str]
) -> OnnxModel:
    try:
        outputs = json.loads(metadata["skinnet.outputs"])
        is_encoder = metadata["skinnet.kind"] == "encoder"
        maps = (*MAP_NAMES, "mask", *_SD_NAMES) if is_encoder else ()
        size = int(metadata["skinnet.working_size"])
        if size < 1:
            raise ValueError(f"working size {size}")
        return OnnxModel(
            path,
            session,
            metadata["skinnet.version"],
            metadata["skinnet.trained_on"],
            metadata["skinnet.optics"],
            size,
            _read_names(metadata["skinnet.lights"]),
            {name: _read_output_info(outputs[name]) for name in maps},
            _read_pair(metadata["skinnet.region_share"]),
        )
    except (KeyError, ValueError, TypeError, AttributeError) as error:
        raise InputError(
            f"The metadata of {path} is damaged ({_name_error(error)}); {REMEDY}."
        ) from error


def _read_output_info(entry: Mapping[str, Any]) -> OutputInfo:
    low, high = entry["range"]
    return OutputInfo(str(entry["unit"]), (float(low), float(high)), str(entry["description"]))


def _read_names(text: str) -> tuple[str, ...]:
    names = json.loads(text)
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        raise TypeError(f"the lights are {names!r:.60}")
    return tuple(names)


def _read_pair(text: str) -> tuple[float, float]:
    melanin, hemoglobin = map(float, json.loads(text))
    return melanin, hemoglobin


def _with_article(kind: str) -> str:
    return f"an {kind}" if kind[:1] in "aeiou" else f"a {kind}"
