"""The shipped files, and any that export writes, go through the tools of onnxruntime and onnx.

Results open as models of skinnet, and give nearly the values of the file that they were made from.
"""

import logging
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import onnx
import pytest
from onnxruntime.quantization import (
    CalibrationDataReader,
    QuantFormat,
    QuantType,
    quant_pre_process,
    quantize_dynamic,
    quantize_static,
)
from skimage.data import astronaut

from export.quantisation import halve, quantise_dynamically, quantise_statically
from skinnet import Decomposer
from skinnet.inference import CAPTURE_NAMES, MAP_NAMES, SHIPPED_ENCODER, Capture, open_model
from skinnet.inference._onnx_pair import get_decoder_path

Feeds = list[dict[str, np.ndarray]]
CROPS = (np.s_[:160, 140:300], np.s_[:200:2, 120:300:2], np.s_[10:131, 160:280])
KNOWN = Capture({"D": 1.0}, 5500.0, white_balance=(0.1, -0.08), linear=False)
FILES = {"encoder": SHIPPED_ENCODER, "decoder": get_decoder_path(SHIPPED_ENCODER)}


class Reader(CalibrationDataReader):
    def __init__(self, feeds: Feeds) -> None:
        self.feeds = iter(feeds)

    def get_next(self) -> dict[str, np.ndarray] | None:
        return next(self.feeds, None)


@pytest.fixture(autouse=True)
def _quiet(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """Tools log advice, and leave files where they run."""
    monkeypatch.chdir(tmp_path)
    logging.disable(logging.WARNING)
    yield
    logging.disable(logging.NOTSET)


@pytest.fixture(scope="module")
def feeds() -> dict[str, Feeds]:
    images = [{"image": np.ascontiguousarray(astronaut()[crop])[None]} for crop in CROPS]
    outputs = [open_model(SHIPPED_ENCODER, "encoder", 1).run(image) for image in images]
    maps = [{name: one[name] for name in (*MAP_NAMES, *CAPTURE_NAMES)} for one in outputs]
    return {"encoder": images, "decoder": maps}


def dynamic(**options: object) -> Callable[[Path, Path, Feeds], None]:
    return lambda source, target, _: quantize_dynamic(source, target, **options)


def prepared(source: Path, target: Path, _: Feeds) -> None:
    """As the documentation of onnxruntime recommends it, all by default."""
    ready = target.with_name("ready.onnx")
    quant_pre_process(source, ready)
    quantize_dynamic(ready, target)


def static(**options: object) -> Callable[[Path, Path, Feeds], None]:
    return lambda source, target, feeds: quantize_static(source, target, Reader(feeds), **options)


U8S8 = {"activation_type": QuantType.QUInt8, "weight_type": QuantType.QInt8}
WAYS: dict[str, Callable[[Path, Path, Feeds], None]] = {
    "dynamic": dynamic(),
    "dynamic, text paths": lambda source, target, _: quantize_dynamic(str(source), str(target)),
    "dynamic, uint8": dynamic(weight_type=QuantType.QUInt8),
    "dynamic, per channel": dynamic(per_channel=True),
    "dynamic, reduced range": dynamic(reduce_range=True),
    "dynamic, matrices": dynamic(op_types_to_quantize=["MatMul", "Gemm"]),
    "dynamic after preparation": prepared,
    "static": static(),
    "static, u8s8": static(**U8S8),
    "static, u8s8 per channel": static(**U8S8, per_channel=True),
    # Without op_types onnxruntime fails on `Where` in this format, whatever the file.
    "static, operators": static(
        **U8S8,
        quant_format=QuantFormat.QOperator,
        op_types_to_quantize=["Conv", "MatMul", "Gemm"],
    ),
}


@pytest.mark.parametrize("kind", FILES)
def test_a_shipped_file_is_valid_in_every_respect(kind: str) -> None:
    model = onnx.load(FILES[kind])
    onnx.checker.check_model(model, full_check=True)
    onnx.shape_inference.infer_shapes(model, check_type=True, strict_mode=True, data_prop=True)
    stated = {value.name for value in model.graph.value_info}
    assert not stated & {tensor.name for tensor in model.graph.initializer}
    assert not any(node.metadata_props or node.doc_string for node in model.graph.node)


@pytest.mark.parametrize("kind", FILES)
def test_preparation_keeps_the_free_axes_and_the_bits(
    kind: str, feeds: dict[str, Feeds], tmp_path: Path
) -> None:
    ready = tmp_path / f"{kind}.onnx"
    quant_pre_process(FILES[kind], ready)
    before, after = open_model(FILES[kind], kind, 1), open_model(ready, kind, 1)
    axes = [output.shape for output in after.session.get_outputs()]
    assert axes == [output.shape for output in before.session.get_outputs()]
    for feed in feeds[kind]:
        for name, value in before.run(feed).items():
            assert np.array_equal(after.run(feed)[name], value), name


@pytest.mark.parametrize("kind", FILES)
@pytest.mark.parametrize("way", WAYS)
def test_a_file_is_quantised_and_opens(
    way: str, kind: str, feeds: dict[str, Feeds], tmp_path: Path
) -> None:
    target = tmp_path / "small.onnx"
    WAYS[way](FILES[kind], target, feeds[kind])
    before, after = open_model(FILES[kind], kind, 1), open_model(target, kind, 1)
    for field in ("version", "trained_on", "optics", "working_size", "lights", "output_info"):
        assert getattr(after, field) == getattr(before, field), field
    old, new = before.run(feeds[kind][0]), after.run(feeds[kind][0])
    for name in old:
        assert new[name].shape == old[name].shape and np.isfinite(new[name]).all(), name
    if kind == "encoder" and way != "dynamic, matrices":
        assert target.stat().st_size < 0.4 * FILES[kind].stat().st_size


@pytest.fixture(
    scope="module",
    params=[
        (lambda source, target, _: halve(source, target), 0.002),
        (lambda source, target, _: quantise_dynamically(source, target), 0.1),
        (lambda source, target, _: quantise_dynamically(source, target, False), 0.1),
        (quantise_statically, 0.05),
    ],
    ids=["half", "dynamic", "dynamic uint8", "static"],
)
def pair(
    request: pytest.FixtureRequest,
    feeds: dict[str, Feeds],
    tmp_path_factory: pytest.TempPathFactory,
) -> tuple[Path, float]:
    """A pair that is made in one of four ways, and the error that is allowed."""
    way, bound = request.param
    model = tmp_path_factory.mktemp("pair") / "skin.small.onnx"
    way(SHIPPED_ENCODER, model, feeds["encoder"])
    get_decoder_path(model).write_bytes(FILES["decoder"].read_bytes())
    if bound > 0.002:
        way(FILES["decoder"], get_decoder_path(model), feeds["decoder"])
    return model, bound


@pytest.mark.parametrize("capture", [None, KNOWN], ids=["nothing known", "known"])
def test_a_quantised_pair_reads_nearly_the_same_pigments(
    pair: tuple[Path, float], capture: Capture | None
) -> None:
    model, bound = pair
    before, after = (
        Decomposer(path, 1)(astronaut(), detail=False, capture=capture) for path in (None, model)
    )
    skin = before.mask > 0.5
    for pigment in ("melanin", "hemoglobin"):
        old, new = (getattr(one, pigment)[skin].mean() for one in (before, after))
        assert new == pytest.approx(old, rel=bound)
    assert after.model == before.model and after.capture_known == before.capture_known
    assert after.uncertainty.face == pytest.approx(before.uncertainty.face, rel=2 * bound)
    assert after.light["temperature_k"] == pytest.approx(before.light["temperature_k"], rel=0.02)
