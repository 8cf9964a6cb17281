"""The astronaut, tiny ONNX files that skinnet can open, and seven small people in a stack."""

import json
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper
from skimage import data

from benchmarks.appearance import make_person
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack import SubjectStack
from skinnet.appearance.stack_writer import write_stack

LIGHTS = ("D", "A")
MAPS = ("melanin", "hemoglobin", "shading", "specular", "mask")
SDS = ("melanin_sd", "hemoglobin_sd", "face_sd")
OUTPUTS = {
    "melanin": ("melanosome volume fraction", 0.0, 0.6),
    "hemoglobin": ("blood volume fraction", 0.0, 0.3),
    "shading": ("relative to the light", 0.0, 4.0),
    "specular": ("relative to the light", 0.0, 1.0),
    "mask": ("probability", 0.0, 1.0),
    "offset": ("linear sRGB", -1.0, 1.0),
    "melanin_sd": ("natural logarithm", 0.0, 1.0),
    "hemoglobin_sd": ("natural logarithm", 0.0, 1.0),
    "face_sd": ("natural logarithm", 0.0, 1.0),
}
METADATA = {
    "format": "2",
    "version": "0.1.0",
    "trained_on": "nothing",
    "optics": "paper",
    "license": "MIT",
    "working_size": "64",
    "region_share": "[0.25, 0.5]",
    "lights": json.dumps(LIGHTS),
    "outputs": json.dumps(
        {
            name: {"unit": unit, "range": [low, high], "description": name}
            for name, (unit, low, high) in OUTPUTS.items()
        }
    ),
}

SaveModel = Callable[..., Path]


@pytest.fixture(scope="session")
def astronaut() -> np.ndarray:
    return np.array(data.astronaut())


@pytest.fixture(scope="session")
def model_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An encoder that takes bright red pixels as skin, and its decoder."""
    return save_models(tmp_path_factory.mktemp("models") / "tiny.onnx")


@pytest.fixture(scope="session")
def skinless_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An encoder that finds no skin anywhere."""
    return save_models(tmp_path_factory.mktemp("models") / "blind.onnx", skin_from=2.0)


@pytest.fixture
def save_model(tmp_path: Path) -> SaveModel:
    """Writes both files with changed metadata; entries that are None are left out."""

    def save(name: str = "changed.onnx", **metadata: str | None) -> Path:
        return save_models(tmp_path / name, **metadata)

    return save


def save_models(path: Path, skin_from: float = 0.5, **metadata: str | None) -> Path:
    for kind, graph, target in (
        ("encoder", encoder_graph(skin_from), path),
        ("decoder", decoder_graph(), path.with_name(f"{path.stem}.decoder.onnx")),
    ):
        opset = helper.make_opsetid("", 20)
        model = helper.make_model(graph, opset_imports=[opset], ir_version=10)
        merged: dict[str, str | None] = {"kind": kind} | METADATA | metadata
        kept = {f"skinnet.{key}": value for key, value in merged.items() if value is not None}
        helper.set_model_props(model, kept)
        onnx.checker.check_model(model)
        onnx.save(model, target)
    return path


def encoder_graph(skin_from: float) -> onnx.GraphProto:
    """Maps that are simple functions of a pixel; light and camera are constants, if not known."""
    nodes = [
        helper.make_node("Cast", ["image"], ["float"], to=TensorProto.FLOAT),
        helper.make_node("Div", ["float", "white"], ["unit"]),
        helper.make_node("ReduceMean", ["unit", "last"], ["grey"], keepdims=0),
        helper.make_node("Gather", ["unit", "first"], ["red"], axis=3),
        helper.make_node("Greater", ["red", "skin_from"], ["skin"]),
        helper.make_node("Cast", ["skin"], ["mask"], to=TensorProto.FLOAT),
        helper.make_node("Mul", ["grey", "fifth"], ["hemoglobin"]),
        helper.make_node("Sub", ["fifth", "hemoglobin"], ["melanin"]),
        helper.make_node("Add", ["grey", "fifth"], ["shading"]),
        helper.make_node("Mul", ["hemoglobin", "fifth"], ["specular"]),
        helper.make_node("Mul", ["unit", "fifth"], ["offset"]),
        helper.make_node("Identity", ["grey"], ["melanin_sd"]),
        helper.make_node("Mul", ["grey", "fifth"], ["hemoglobin_sd"]),
        helper.make_node("Identity", ["the_face_sd"], ["face_sd"]),
        *(
            helper.make_node(*node)
            for name in CAPTURE
            for node in (
                ("IsNaN", [f"known_{name}"], [f"no_{name}"]),
                ("Where", [f"no_{name}", f"the_{name}", f"known_{name}"], [name]),
            )
        ),
    ]
    constants = {
        "white": np.float32(255),
        "last": np.array([3]),
        "first": np.array(0),
        "skin_from": np.float32(skin_from),
        "fifth": np.float32(0.2),
        "the_face_sd": FACE_SD,
    } | {f"the_{name}": value for name, value in CAPTURE.items()}
    known = {f"known_{name}": np.full_like(value, np.nan) for name, value in CAPTURE.items()}
    known |= {f"known_{name}": np.full(1, np.nan, np.float32) for name in ("linear", "exposure")}
    outputs = [value_info(name) for name in (*OUTPUTS, *CAPTURE)]
    image = helper.make_tensor_value_info("image", TensorProto.UINT8, ["batch", "h", "w", 3])
    inputs = [
        helper.make_tensor_value_info(name, TensorProto.FLOAT, ["known", *value.shape[1:]])
        for name, value in known.items()
    ]
    return helper.make_graph(
        nodes, "encoder", [image, *inputs], outputs, initializers(constants | known)
    )


CAPTURE = {
    "light": np.array([[0.75, 0.25]], np.float32),
    "temperature": np.array([6504], np.float32),
    "camera": np.array([[0.5, -0.5, 0.0]], np.float32),
    "white_balance": np.log(np.array([[1.02, 0.97]], np.float32)),
}
FACE_SD = np.array([[0.1, 0.2]], np.float32)


def decoder_graph() -> onnx.GraphProto:
    """Absorption by melanin, and by blood most in green: signs are right, values are not."""
    nodes = [
        helper.make_node("Unsqueeze", [name, "last"], [f"{name}3"])
        for name in MAPS
        if name != "mask"
    ] + [
        helper.make_node("Mul", ["melanin3", "by_melanin"], ["dark"]),
        helper.make_node("Mul", ["hemoglobin3", "by_blood"], ["flush"]),
        helper.make_node("Add", ["dark", "flush"], ["density"]),
        helper.make_node("Neg", ["density"], ["negative"]),
        helper.make_node("Exp", ["negative"], ["skin"]),
        helper.make_node("Mul", ["skin", "shading3"], ["shaded"]),
        helper.make_node("Add", ["shaded", "specular3"], ["glossy"]),
        helper.make_node("Add", ["glossy", "offset"], ["whole"]),
        helper.make_node("Clip", ["whole", "zero", "one"], ["image"]),
    ]
    constants = {
        "last": np.array([3]),
        "by_melanin": np.array([2, 3, 5], np.float32),
        "by_blood": np.array([1, 6, 4], np.float32),
        "zero": np.float32(0),
        "one": np.float32(1),
    }
    names = [name for name in (*OUTPUTS, *CAPTURE) if name not in ("mask", *SDS)]
    image = helper.make_tensor_value_info("image", TensorProto.FLOAT, ["batch", "h", "w", 3])
    return helper.make_graph(
        nodes, "decoder", [value_info(n) for n in names], [image], initializers(constants)
    )


def value_info(name: str) -> onnx.ValueInfoProto:
    axes: dict[str, list[Any]] = {
        "offset": ["batch", "h", "w", 3],
        "temperature": ["batch"],
        "face_sd": ["batch", 2],
    }
    shape = ["batch", f"{name}s"] if name in CAPTURE else ["batch", "h", "w"]
    return helper.make_tensor_value_info(name, TensorProto.FLOAT, axes.get(name, shape))


def initializers(constants: dict[str, Any]) -> list[onnx.TensorProto]:
    return [numpy_helper.from_array(np.asarray(v), name) for name, v in constants.items()]


COUNT, SIZE = 7, 20


@pytest.fixture(scope="session")
def colour() -> SkinColour:
    """A small table, under a calibration that is not the identity."""
    calibration = np.array([[0.9, 0.05, 0.0], [0.0, 1.1, -0.05], [0.02, 0.0, 0.95]])
    return SkinColour(calibration=calibration, nodes=(24, 16), light="LED-B3", camera="D200")


@pytest.fixture(scope="session")
def persons() -> dict[str, Callable[[], SkinTexture]]:
    return {f"person {seed}": partial(make_person, SIZE, seed) for seed in range(COUNT)}


@pytest.fixture(scope="session")
def stack(
    tmp_path_factory: pytest.TempPathFactory,
    persons: dict[str, Callable[[], SkinTexture]],
    colour: SkinColour,
) -> SubjectStack:
    folder: Path = tmp_path_factory.mktemp("stack")
    return write_stack(folder, persons, colour, "people")
