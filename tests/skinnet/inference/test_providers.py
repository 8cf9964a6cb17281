"""Execution providers are found by name, and a missing one is named with what to install."""

from pathlib import Path
from typing import Any

import numpy as np
import onnxruntime
import pytest

from skinnet import Decomposer
from skinnet.errors import InputError
from skinnet.inference import _onnx_session, open_model
from skinnet.inference._providers import choose_providers, note_fallback

CPU, CUDA = "CPUExecutionProvider", "CUDAExecutionProvider"


@pytest.mark.parametrize(
    "providers", [None, "cpu", "CPU", CPU, "cpuexecutionprovider", ["cpu"], ("cpu", CPU)]
)
def test_the_processor_has_several_names(
    model_file: Path, astronaut: np.ndarray, providers: Any
) -> None:
    decomposer = Decomposer(model_file, threads=1, providers=providers)
    assert decomposer(astronaut, detail=False).provider == "cpu"
    assert decomposer.encoder.provider == decomposer.decoder.provider == "cpu"


@pytest.mark.parametrize(
    ("name", "remedy"),
    [
        ("cuda", r"cuda is not among .* cpu; .*pip install onnxruntime-gpu"),
        ("CUDAExecutionProvider", r"pip install onnxruntime-gpu, or take one of these"),
        ("directml", r"directml is not among .*pip install onnxruntime-directml"),
        ("dml", r"directml is not among"),
        ("coreml", r"coreml .* part of onnxruntime for macOS alone"),
        ("migraphx", r"migraphx is not among .* which are .*cpu; take one of these"),
    ],
)
def test_a_missing_one_is_named_with_its_package(
    monkeypatch: pytest.MonkeyPatch, name: str, remedy: str
) -> None:
    monkeypatch.setattr(onnxruntime, "get_available_providers", lambda: [CPU])
    for providers in (name, [name], ["cpu", name]):
        with pytest.raises(InputError, match=remedy):
            Decomposer(providers=providers)
    assert choose_providers([name, "cpu"]).installed == [CPU]


def test_other_names_are_refused() -> None:
    with pytest.raises(InputError, match=r"no execution provider 'gpu'; .* others are cpu, cuda"):
        Decomposer(providers="gpu")
    with pytest.raises(InputError, match=r"a list of names; got \[\]"):
        Decomposer(providers=[])


def test_the_fall_back_is_noted(model_file: Path, astronaut: np.ndarray) -> None:
    read = Decomposer(model_file, threads=1, providers=["cuda", "cpu"])(astronaut, detail=False)
    assert read.provider == "cpu"
    assert read.notes[0] == (
        "The networks ran on cpu, since the execution provider cuda is missing."
    )
    same = Decomposer(model_file, threads=1)(astronaut, detail=False)
    np.testing.assert_array_equal(read.melanin, same.melanin)


class Device(onnxruntime.InferenceSession):
    """A session that says that it runs on other devices."""

    pretended: list[str]

    def get_providers(self) -> list[str]:
        return self.pretended


@pytest.fixture
def pretend(monkeypatch: pytest.MonkeyPatch) -> Any:
    """Pretends that CUDA is installed, and that it runs, is passed over, or raises an error."""
    real = onnxruntime.InferenceSession

    def make(outcome: str) -> None:
        def open_(path: Path, options: Any, providers: list[str], **_: Any) -> Any:
            if CUDA not in providers:
                return real(path, options, providers=providers)
            if outcome == "raises":
                raise RuntimeError("CUDA failure 35: driver version is insufficient")
            names = [CUDA, CPU] if outcome == "runs" else [CPU]
            session = Device(path, options, providers=[CPU])
            session.pretended = names
            return session

        monkeypatch.setattr(onnxruntime, "get_available_providers", lambda: [CUDA, CPU])
        monkeypatch.setattr(_onnx_session.onnxruntime, "InferenceSession", open_)

    return make


def test_what_runs_is_said(pretend: Any, model_file: Path, astronaut: np.ndarray) -> None:
    pretend("runs")
    for providers in ("cuda", ["cuda", "cpu"]):
        read = Decomposer(model_file, threads=1, providers=providers)(astronaut, detail=False)
        assert read.provider == "cuda" and read.to_dict()["provider"] == "cuda"
        assert not any("cuda" in each.lower() for each in read.notes)


@pytest.mark.parametrize("outcome", ["raises", "passes over"])
def test_a_device_that_does_not_start_is_no_silent_fall_back(
    pretend: Any, model_file: Path, astronaut: np.ndarray, tmp_path: Path, outcome: str
) -> None:
    pretend(outcome)
    with pytest.raises(InputError, match="cuda is installed, but does not start on this computer"):
        Decomposer(model_file, providers="cuda").load()
    read = Decomposer(model_file, threads=1, providers=["cuda", "cpu"])(astronaut, detail=False)
    assert read.provider == "cpu"
    assert "provider cuda does not start here" in read.notes[0]


def test_a_damaged_file_is_not_the_devices_fault(
    pretend: Any, model_file: Path, tmp_path: Path
) -> None:
    pretend("raises")
    content = bytearray(model_file.read_bytes())
    content[60:90] = bytes(30)
    damaged = tmp_path / "a.onnx"
    damaged.write_bytes(content)
    with pytest.raises(InputError, match=r"a\.onnx"):
        open_model(damaged, "encoder", 1, "cuda")


def test_the_first_choice_needs_no_note() -> None:
    assert note_fallback(choose_providers("cpu"), "cpu") == ()
