"""The project's ONNX files: opened, checked and described by their own metadata."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import onnxruntime
from numpy.typing import NDArray
from onnxruntime.capi import onnxruntime_pybind11_state as ort_errors

from skinnet.errors import InputError

ONNX_FORMAT = "1"
"""Version of the contract between the files and this code."""

SHIPPED_ENCODER = Path(__file__).parent / "models" / "skin.onnx"
"""The encoder that comes with the package; its decoder has its place in the same folder."""

MAP_NAMES = ("melanin", "hemoglobin", "shading", "specular", "offset")
CAPTURE_NAMES = ("light", "temperature", "camera", "white_balance")
_INPUTS = {"encoder": {"image"}, "decoder": {*MAP_NAMES, *CAPTURE_NAMES}}
_OUTPUTS = {"encoder": {*MAP_NAMES, *CAPTURE_NAMES, "mask"}, "decoder": {"image"}}
_REMEDY = "give a file made by `python -m export`, or leave --model out"
_REFUSED = (
    *(ort_errors.Fail, ort_errors.InvalidArgument, ort_errors.InvalidGraph),
    *(ort_errors.InvalidProtobuf, ort_errors.NoSuchFile, ort_errors.NotImplemented),
    *(ort_errors.RuntimeException, RuntimeError, ValueError),
)


class OutputInfo(NamedTuple):
    """What an output means: its unit, its least and greatest value, and a line about it."""

    unit: str
    range: tuple[float, float]
    description: str


@dataclass(frozen=True)
class OnnxModel:
    """An open ONNX file of the project, with the metadata that is needed to use it."""

    path: Path
    session: onnxruntime.InferenceSession
    version: str
    trained_on: str
    working_size: int
    lights: tuple[str, ...]
    outputs: Mapping[str, OutputInfo]

    def run(self, inputs: Mapping[str, NDArray[Any]]) -> dict[str, NDArray[np.float32]]:
        """Outputs by name. Raises `InputError` if the network cannot take these inputs."""
        names = [output.name for output in self.session.get_outputs()]
        try:
            values = self.session.run(names, dict(inputs))
        except _REFUSED as error:
            raise InputError(f"{self.path} failed on this photograph: {error}") from error
        return dict(zip(names, values, strict=True))


def get_decoder_path(encoder: Path) -> Path:
    """The decoder beside an encoder: X.decoder.onnx beside X.onnx."""
    return encoder.with_name(f"{encoder.stem}.decoder.onnx")


def open_model(path: Path, kind: str, threads: int | None = None) -> OnnxModel:
    """Open an encoder or a decoder (`kind`), run on `threads` threads (None: all cores).

    Raises `InputError` if the file is missing, damaged, not the project's, of another format, or of
    the other kind.
    """
    if not path.is_file():
        raise InputError(f"There is no {kind} file {path}; {_REMEDY}.")
    options = onnxruntime.SessionOptions()
    options.log_severity_level = 4  # what goes wrong is raised, and said once
    if threads is not None:
        options.intra_op_num_threads = threads
    try:
        session = onnxruntime.InferenceSession(path, options, providers=["CPUExecutionProvider"])
    except _REFUSED as error:
        raise InputError(
            f"{path} is not a whole ONNX file (damaged, cut short, or something else); {_REMEDY}."
        ) from error
    notes = session.get_modelmeta().custom_metadata_map
    _check(path, kind, session, notes)
    return _described(path, session, notes)


def _check(
    path: Path, kind: str, session: onnxruntime.InferenceSession, notes: Mapping[str, str]
) -> None:
    found = notes.get("skinnet.kind")
    if found is None:
        raise InputError(f"{path} is an ONNX file, but not one of skinnet's; {_REMEDY}.")
    if notes.get("skinnet.format") != ONNX_FORMAT:
        raise InputError(
            f"{path} has format {notes.get('skinnet.format')}, and this skinnet reads format "
            f"{ONNX_FORMAT}; export it again, or install the skinnet that made it."
        )
    if found != kind:
        raise InputError(f"{path} is {_a(found)}, and {_a(kind)} is wanted; {_REMEDY}.")
    inputs = {item.name for item in session.get_inputs()}
    outputs = {item.name for item in session.get_outputs()}
    if inputs != _INPUTS[kind] or not _OUTPUTS[kind] <= outputs:
        raise InputError(
            f"{path} says that it is {_a(kind)} but takes {', '.join(sorted(inputs))} and gives "
            f"{', '.join(sorted(outputs))}; {_REMEDY}."
        )


def _described(
    path: Path, session: onnxruntime.InferenceSession, notes: Mapping[str, str]
) -> OnnxModel:
    try:
        notes_on = json.loads(notes["skinnet.outputs"])
        named = (*MAP_NAMES, "mask") if notes["skinnet.kind"] == "encoder" else ()
        size = int(notes["skinnet.working_size"])
        if size < 1:
            raise ValueError(f"working size {size}")
        return OnnxModel(
            path,
            session,
            notes["skinnet.version"],
            notes["skinnet.trained_on"],
            size,
            tuple(json.loads(notes["skinnet.lights"])),
            {name: _output(notes_on[name]) for name in named},
        )
    except (KeyError, ValueError, TypeError, AttributeError) as error:
        raise InputError(f"The metadata of {path} is damaged ({error!r}); {_REMEDY}.") from error


def _output(note: Mapping[str, Any]) -> OutputInfo:
    low, high = note["range"]
    return OutputInfo(str(note["unit"]), (float(low), float(high)), str(note["description"]))


def _a(kind: str) -> str:
    return f"an {kind}" if kind[:1] in "aeiou" else f"a {kind}"
