"""Exported files in 8-bit integers or half precision, by the tools of onnxruntime.

The card of the shipped model says what each gives. Metadata survive: `skinnet` opens the results.
"""

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import onnx
from numpy.typing import NDArray
from onnxruntime.quantization import (
    CalibrationDataReader,
    QuantFormat,
    QuantType,
    quant_pre_process,
    quantize_dynamic,
    quantize_static,
)
from onnxruntime.transformers.float16 import convert_float_to_float16

Feed = Mapping[str, NDArray[Any]]


def halve(model: Path, target: Path) -> None:
    """Convert a file to half precision; its inputs and outputs stay float32.

    Args:
        model: The exported file.
        target: The file to write.
    """
    halved = convert_float_to_float16(onnx.load(model), keep_io_types=True)
    onnx.save(halved, target)


def quantise_dynamically(model: Path, target: Path, signed: bool = True) -> None:
    """Quantise the weights of a file beforehand, and its activations anew on every run.

    Args:
        model: The exported file.
        target: The file to write.
        signed: Whether weights are int8, which is the tool's own choice, or uint8, for which
            onnxruntime has faster convolutions.
    """
    weights = QuantType.QInt8 if signed else QuantType.QUInt8
    quantize_dynamic(model, target, weight_type=weights, per_channel=not signed)


def quantise_statically(model: Path, target: Path, feeds: Iterable[Feed]) -> None:
    """Quantise weights, and activations by their ranges on given inputs (QDQ, u8s8, per channel).

    Of a network with convolutions these alone are quantised, less the first and the last. The
    first sees colours, and the last gives pigments: both need more than 256 levels.

    Args:
        model: The exported file.
        target: The file to write.
        feeds: Inputs by name, such as 32 photographs of faces at the working size.
    """
    with TemporaryDirectory() as folder:
        ready = Path(folder) / model.name
        quant_pre_process(model, ready)
        convolutions = [n.name for n in onnx.load(ready).graph.node if n.op_type == "Conv"]
        quantize_static(
            ready,
            target,
            _Reader(feeds),
            quant_format=QuantFormat.QDQ,
            activation_type=QuantType.QUInt8,
            weight_type=QuantType.QInt8,
            per_channel=True,
            op_types_to_quantize=["Conv"] if convolutions else ["MatMul", "Gemm"],
            nodes_to_exclude=[*convolutions[:1], *convolutions[-1:]],
        )


class _Reader(CalibrationDataReader):  # type: ignore[misc]
    def __init__(self, feeds: Iterable[Feed]) -> None:
        self._feeds: Iterator[Feed] = iter(feeds)

    def get_next(self) -> dict[str, NDArray[np.generic]] | None:
        feed = next(self._feeds, None)
        return None if feed is None else dict(feed)
