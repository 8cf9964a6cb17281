"""Exported files have torch's numbers and their metadata; other files are refused."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import onnx
import onnxruntime
import pytest
import torch
from onnxruntime.quantization import quant_pre_process, quantize_dynamic
from safetensors import safe_open
from safetensors.torch import save_file

from export.__main__ import main
from export.graphs import KNOWN, OUTPUTS, EncoderGraph, describe_outputs, make_example, make_known
from skinnet.inference import CAPTURE_NAMES, MAP_NAMES, SHIPPED_ENCODER, open_model
from skinnet.network import AutoencoderConfig, SkinAutoencoder
from skinnet.network._tone_factors import find_factors
from skinnet.network._weights import WEIGHTS_FORMAT

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def exported(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("export")
    torch.manual_seed(0)
    model = SkinAutoencoder(AutoencoderConfig(widths=(8, 12, 16), working_size=48))
    model.trained_on = "nothing at all"
    for name, weights in model.named_parameters():
        if name.startswith("encoder.known"):  # their last layer begins at 0, without an effect
            torch.nn.init.normal_(weights, std=0.3)
    model.region_share.copy_(torch.tensor([0.25, 0.5]))
    model.save_pretrained(folder / "start.safetensors")
    # A process of its own: the checks of shapes under pytest would fix the batch in the graph.
    command = [sys.executable, "-m", "export", "start.safetensors", "-o", "skin.onnx"]
    environment = {**os.environ, "PYTHONPATH": str(Path.cwd())}
    subprocess.run(command, cwd=folder, env=environment, check=True)
    return folder / "skin.onnx"


def read_file(path: Path) -> tuple[dict[str, str], dict[str, torch.Tensor]]:
    """Metadata and tensors of a safetensors file."""
    with safe_open(path, framework="pt") as file:
        return file.metadata(), {name: file.get_tensor(name) for name in file.keys()}


def test_three_files_are_written_and_nothing_else(exported: Path) -> None:
    names = {path.name for path in exported.parent.iterdir()}
    assert names == {"start.safetensors", "skin.onnx", "skin.decoder.onnx", "skin.safetensors"}


@pytest.mark.parametrize("name", ["skin.onnx", "skin.decoder.onnx"])
def test_a_file_is_complete_and_has_its_metadata(exported: Path, name: str) -> None:
    file = onnx.load(exported.with_name(name), load_external_data=False)
    assert file.opset_import[0].version >= 18
    assert all(not tensor.external_data for tensor in file.graph.initializer)
    message = {entry.key: entry.value for entry in file.metadata_props}
    outputs = json.loads(message["skinnet.outputs"])
    assert [output.name for output in file.graph.output] == list(outputs)
    assert all({"unit", "range", "description"} <= set(output) for output in outputs.values())
    assert message["skinnet.working_size"] == "48" and message["skinnet.license"] == "MIT"
    assert message["skinnet.trained_on"] == "nothing at all"
    assert json.loads(message["skinnet.region_share"]) == [0.25, 0.5]


@pytest.mark.parametrize("name", ["skin.onnx", "skin.decoder.onnx"])
def test_metadata_have_the_keys_of_the_shipped_files(exported: Path, name: str) -> None:
    shipped = SHIPPED_ENCODER.with_name(name)
    keys = [
        {entry.key for entry in onnx.load(path).metadata_props}
        for path in (exported.with_name(name), shipped)
    ]
    assert keys[0] == keys[1]


@pytest.mark.parametrize("name", ["skin.onnx", "skin.decoder.onnx"])
def test_a_file_can_be_prepared_and_quantised(
    exported: Path, name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    onnx.checker.check_model(onnx.load(exported.with_name(name)), full_check=True)
    ready, target = tmp_path / "ready.onnx", tmp_path / name
    quant_pre_process(exported.with_name(name), ready)
    for source in (exported.with_name(name), ready):
        quantize_dynamic(source, target)
        kind = "decoder" if "decoder" in name else "encoder"
        assert open_model(target, kind).trained_on == "nothing at all"


def test_encoder_and_decoder_make_the_reconstruction_of_torch(exported: Path) -> None:
    from skinnet.physics import to_display

    model = SkinAutoencoder.from_pretrained(exported.with_suffix(".safetensors"))
    photograph = torch.randint(0, 256, (2, 37, 53, 3), dtype=torch.uint8)
    encoder = onnxruntime.InferenceSession(exported)
    decoder = onnxruntime.InferenceSession(exported.with_suffix(".decoder.onnx"))
    names = [output.name for output in encoder.get_outputs()]
    maps = dict(zip(names, encoder.run(None, {"image": photograph.numpy()}), strict=True))
    inputs = {name: maps[name] for name in (*MAP_NAMES, *CAPTURE_NAMES)}
    (image,) = decoder.run(None, inputs)
    with torch.no_grad():
        expected = to_display(model(photograph.movedim(-1, 1) / 255).reconstruction).movedim(1, -1)
    assert abs(image - expected.numpy()).max() < 1e-3


def test_what_is_known_may_be_left_out_or_given_once_or_for_each(exported: Path) -> None:
    session = onnxruntime.InferenceSession(exported)
    assert [given.name for given in session.get_inputs()] == ["image"]
    assert [given.name for given in session.get_overridable_initializers()] == list(KNOWN)
    photographs = {"image": make_example(3, 37, 53).numpy()}
    unknown, known = (
        {name: value.numpy() for name, value in make_known(3, is_known).items()}
        for is_known in (False, True)
    )
    once = {name: value[:1] for name, value in known.items()}
    each = {name: value[:1].repeat(3, 0) for name, value in known.items()}
    blind, nan, one, many, other = (
        session.run(None, photographs | feed) for feed in ({}, unknown, once, each, known)
    )
    for name, *values in zip(OUTPUTS, blind, nan, one, many, other, strict=True):
        assert np.array_equal(values[0], values[1]) and np.array_equal(values[2], values[3]), name
        assert np.array_equal(values[3][0], values[4][0]), name
        assert not np.array_equal(values[0], values[3]) or "sd" in name, name
        assert not np.array_equal(values[3][1:], values[4][1:]) or "sd" in name, name


@pytest.mark.parametrize("name", KNOWN)
def test_each_part_that_is_known_is_that_of_torch(exported: Path, name: str) -> None:
    model = SkinAutoencoder.from_pretrained(exported.with_suffix(".safetensors"))
    photograph, known = make_example(2, 40, 50), {name: make_known(2)[name]}
    session = onnxruntime.InferenceSession(exported)
    found, blind = (
        session.run(None, {"image": photograph.numpy(), **feed})
        for feed in ({name: known[name].numpy()}, {})
    )
    with torch.no_grad():
        expected = EncoderGraph(model)(photograph, **(make_known(2, False) | known))
    for output, value, right in zip(OUTPUTS.values(), found, expected, strict=True):
        low, high = output["range"]
        np.testing.assert_allclose(value, right, rtol=0, atol=3e-4 * (high - low))
    assert not np.array_equal(found[0], blind[0])


def test_ranges_of_standard_deviations_are_those_of_the_model() -> None:
    model = SkinAutoencoder(AutoencoderConfig(widths=(4, 8)))
    model.sd_scale.copy_(torch.tensor([[1.0, 2.0], [0.5, 3.0]]))
    described = describe_outputs(model)
    assert described["hemoglobin_sd"]["range"] == pytest.approx([0.02, 3.0])
    assert described["face_sd"]["range"] == pytest.approx([0.005, 4.5])
    assert described["melanin_sd"]["range"] == OUTPUTS["melanin_sd"]["range"]
    model.sd_by_tone[0, 0] = torch.tensor([0.5, -0.5])  # largest at a tone of .5
    low, high = describe_outputs(model)["melanin_sd"]["range"]
    tones = torch.linspace(-1.5, 1.6, 3101)
    factors = find_factors(tones, model.sd_scale, model.sd_by_tone)[0, 0]
    assert [low, high] == pytest.approx([0.01 * float(factors.min()), 1.5 * float(factors.max())])


def test_outputs_lie_in_their_stated_ranges(exported: Path) -> None:
    session = onnxruntime.InferenceSession(exported)
    message = json.loads(session.get_modelmeta().custom_metadata_map["skinnet.outputs"])
    noise = torch.randint(0, 256, (1, 64, 64, 3), dtype=torch.uint8).numpy()
    for (name, output), value in zip(
        message.items(), session.run(None, {"image": noise}), strict=True
    ):
        low, high = output["range"]
        assert low <= value.min() and value.max() <= high, name


@pytest.mark.parametrize("suffix", [".ckpt", ".safetensors"])
@pytest.mark.parametrize("content", [None, b"", b"not a model", "foreign"])
def test_a_file_without_a_model_is_refused(
    suffix: str, content: bytes | str | None, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / f"model{suffix}"
    if content == "foreign" and suffix == ".ckpt":
        torch.save({"state_dict": {}}, path)
    elif content == "foreign":
        save_file({"a": torch.zeros(1)}, path)
    elif isinstance(content, bytes):
        path.write_bytes(content)
    assert main([str(path), "-o", str(tmp_path / "out.onnx")]) == 2
    assert str(path) in capsys.readouterr().err
    assert not (tmp_path / "out.onnx").exists()


def test_another_format_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "model.ckpt"
    torch.save({"skinnet": {"format": 99, "version": "9.0"}, "state_dict": {}}, path)
    assert main([str(path)]) == 2
    assert "format 99" in capsys.readouterr().err


def test_weights_of_an_earlier_format_are_refused(
    exported: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    metadata, state = read_file(exported.with_suffix(".safetensors"))
    path = tmp_path / "old.safetensors"
    save_file(state, path, metadata | {"skinnet.format": "2"})
    assert main([str(path)]) == 2
    assert "format 2, this skinnet reads" in capsys.readouterr().err


def test_weights_that_are_not_those_described_are_refused(
    exported: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    metadata, state = read_file(exported.with_suffix(".safetensors"))
    path = tmp_path / "other.safetensors"
    for wrong in (
        (state, metadata | {"skinnet.config": "{}"}),
        (state, metadata | {"skinnet.config": "no json"}),
        ({"a": torch.zeros(1)}, metadata),
    ):
        save_file(wrong[0], path, wrong[1])
        assert main([str(path)]) == 2
        assert f"{path} does not hold the model" in capsys.readouterr().err


def test_a_checkpoint_without_its_model_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "model.ckpt"
    torch.save({"skinnet": {"format": WEIGHTS_FORMAT}, "state_dict": {}}, path)
    assert main([str(path), "-o", str(tmp_path / "out.onnx")]) == 2
    assert f"{path} does not hold the model" in capsys.readouterr().err


def test_the_weights_that_are_exported_are_not_overwritten(
    exported: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "mine.safetensors"
    path.write_bytes(exported.with_suffix(".safetensors").read_bytes())
    assert main([str(path), "-o", str(tmp_path / "mine.onnx"), "--half"]) == 2
    assert "would be overwritten" in capsys.readouterr().err
    assert path.read_bytes() == exported.with_suffix(".safetensors").read_bytes()


def test_a_truncated_weights_file_is_refused(
    exported: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "cut.safetensors"
    path.write_bytes(exported.with_suffix(".safetensors").read_bytes()[:-100])
    assert main([str(path)]) == 2
    assert "complete" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("output", "message"),
    [("skin.txt", ".onnx"), ("no/skin.onnx", "folder"), ("folder.onnx", "is a folder")],
)
def test_an_output_that_cannot_be_written_is_refused_first(
    output: str, message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "folder.onnx").mkdir()
    assert main(["absent.ckpt", "-o", str(tmp_path / output)]) == 2
    assert message in capsys.readouterr().err


def test_weights_survive_a_round_trip(tmp_path: Path) -> None:
    model = SkinAutoencoder(AutoencoderConfig(widths=(4, 8), working_size=32))
    path = tmp_path / "weights.safetensors"
    model.trained_on = "a test"
    model.save_pretrained(path)
    again = SkinAutoencoder.from_pretrained(path)
    assert again.config == model.config and again.trained_on == "a test"
    state = again.state_dict()
    assert all(torch.equal(value, state[name]) for name, value in model.state_dict().items())
