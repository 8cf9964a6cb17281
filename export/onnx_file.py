"""Writes ONNX files with their metadata, and compares them with torch."""

import json
import logging
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
import onnx
import onnxruntime
import torch
from torch import Tensor, nn
from torch.export import Dim

from export.graphs import (
    DECODED,
    KNOWN,
    OUTPUTS,
    DecoderGraph,
    EncoderGraph,
    Output,
    describe_outputs,
    make_example,
    make_known,
    select_decoder_inputs,
)
from export.onnx_graph import finish
from export.optional_inputs import make_optional
from skinnet._version import __version__
from skinnet.errors import InputError
from skinnet.files import write_together
from skinnet.inference import MAP_NAMES, ONNX_FORMAT
from skinnet.inference._onnx_pair import get_decoder_path
from skinnet.network import SkinAutoencoder
from skinnet.physics import LIGHTS

OPSET = 20
LICENSE = "MIT"
SIZES = ((1, 64, 64), (2, 97, 65), (1, 128, 128), (3, 33, 201), (1, 256, 256))
"""Batch, height and width of the photographs on which files are compared with torch."""


@dataclass(frozen=True)
class Report:
    """Measurements of an exported file.

    Attributes:
        path: The file.
        megabytes: Its size.
        difference: Largest difference from torch, as a share of an output's range, by output.
        milliseconds: Time to run the largest example once.
    """

    path: Path
    megabytes: float
    difference: dict[str, float]
    milliseconds: float


def export_model(
    model: SkinAutoencoder,
    path: Path,
    half: bool = False,
    origin: str = "",
) -> list[Report]:
    """Write the encoder to `path`, and the decoder and the weights beside it.

    Args:
        model: Model to export; its `trained_on` is written into the files.
        path: The encoder's .onnx file.
        half: Whether to round the encoder's weights to half precision; .safetensors stores them so.
        origin: What the ONNX files state of their origin (`doc_string`).

    Returns:
        Measurements of encoder and decoder.

    Raises:
        InputError: If an ONNX file differs from torch by more than 1e-3 of an output's range. Then
            nothing is written.
    """
    model = model.eval()
    if half:
        # Rounded before any file is written, so that all files hold the same weights. The
        # constants of the physics need float32.
        model.encoder.half().float()
    inputs = {"image": make_example(2, 64, 80), **make_known(2)}
    maps = dict(zip(OUTPUTS, EncoderGraph(model)(**inputs), strict=True))
    maps = select_decoder_inputs(maps)
    jobs = [
        ("encoder", EncoderGraph(model), inputs, describe_outputs(model), path),
        ("decoder", DecoderGraph(model.decoder), maps, DECODED, get_decoder_path(path)),
    ]
    with write_together() as temporary:
        reports = []
        for kind, graph, inputs, outputs, target in jobs:
            part = temporary(target)
            _write(graph, inputs, outputs, part)
            _describe(part, kind, model, outputs, origin)
            reports.append(_compare(model, part, target, outputs))
        if half:
            model.encoder.half()
        model.save_pretrained(temporary(path.with_suffix(".safetensors")))
    return reports


def _write(
    graph: nn.Module, inputs: dict[str, Tensor], outputs: dict[str, Output], path: Path
) -> None:
    batch, height, width = Dim("batch"), Dim("height"), Dim("width")
    pixels = {0: batch, 1: height, 2: width}
    shapes = {name: pixels if name in (*MAP_NAMES, "image") else {0: batch} for name in inputs}
    with _silence_exporter():
        program = torch.onnx.export(
            graph.eval(),
            tuple(inputs.values()),
            dynamo=True,
            opset_version=OPSET,
            input_names=list(inputs),
            output_names=list(outputs),
            dynamic_shapes=shapes,
            external_data=False,
            verbose=False,
        )
        assert program is not None
        program.save(path, external_data=False)


@contextmanager
def _silence_exporter() -> Iterator[None]:
    """Silence the exporter's remarks on torchvision, deprecations and repeated axes."""
    logger = logging.getLogger("torch.onnx")
    level = logger.level
    logger.setLevel(logging.ERROR)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            yield
    finally:
        logger.setLevel(level)


def _describe(
    path: Path,
    kind: str,
    model: SkinAutoencoder,
    outputs: dict[str, Output],
    origin: str,
) -> None:
    file = onnx.load(path)
    metadata = {
        "skinnet.kind": kind,
        "skinnet.format": ONNX_FORMAT,
        "skinnet.version": __version__,
        "skinnet.outputs": json.dumps(outputs),
        "skinnet.lights": json.dumps(LIGHTS),
        "skinnet.optics": model.config.optics,
        "skinnet.working_size": str(model.config.working_size),
        "skinnet.region_share": json.dumps(model.region_share.tolist()),
        "skinnet.trained_on": model.trained_on,
        "skinnet.license": LICENSE,
    }
    onnx.helper.set_model_props(file, metadata)
    file.doc_string = origin
    if kind == "encoder":
        make_optional(file.graph, KNOWN, "image")
    try:
        finish(file)
    except (onnx.checker.ValidationError, onnx.shape_inference.InferenceError) as error:
        raise InputError(
            f"The {kind} was not written: its graph is not valid ({error}). Try the versions in "
            "constraints.txt."
        ) from error
    onnx.save(file, path)


def _compare(
    model: SkinAutoencoder, part: Path, target: Path, outputs: dict[str, Output]
) -> Report:
    """Compare a file with torch, at all sizes, with nothing known of a capture and everything."""
    options = onnxruntime.SessionOptions()
    options.log_severity_level = 3  # inputs with a default value are warned of
    session = onnxruntime.InferenceSession(part, options, providers=["CPUExecutionProvider"])
    worst = dict.fromkeys(outputs, 0.0)
    for size, is_known in product(SIZES, (False, True)):
        found, expected, elapsed = _run_both(model, session, size, is_known)
        for name, a, b in zip(outputs, found, expected, strict=True):
            low, high = outputs[name]["range"]
            worst[name] = max(worst[name], float(np.abs(a - b).max()) / (high - low))
    for name, difference in worst.items():
        if not difference <= 1e-3:
            raise InputError(
                f"{target} was not written: its {name} differs from torch by {difference:.2g} of "
                "its range. Try the versions in constraints.txt."
            )
    return Report(target, part.stat().st_size / 1e6, worst, elapsed * 1e3)


@torch.no_grad()
def _run_both(
    model: SkinAutoencoder,
    session: onnxruntime.InferenceSession,
    size: tuple[int, int, int],
    is_known: bool,
) -> tuple[list[np.ndarray], list[np.ndarray], float]:
    inputs, known = {"image": make_example(*size)}, make_known(size[0], is_known)
    expected: tuple[Tensor, ...] = EncoderGraph(model)(**inputs, **known)
    if len(session.get_inputs()) > 1:
        inputs = select_decoder_inputs(dict(zip(OUTPUTS, expected, strict=True)))
        expected = (DecoderGraph(model.decoder)(**inputs),)
    elif is_known:
        inputs |= known
    feed = {name: value.contiguous().numpy() for name, value in inputs.items()}
    started = time.perf_counter()
    found = session.run(None, feed)
    return found, [value.numpy() for value in expected], time.perf_counter() - started
