"""The steps that make the networks of faces, on small graphs."""

import numpy as np
import onnx
import onnxruntime
from onnx import TensorProto, helper, numpy_helper

from export.face_models import GRID_SHAPE, centre_samples, expand_prelu, store_half


def make_model(
    nodes: list[onnx.NodeProto], weights: dict[str, np.ndarray], shapes: dict[str, list[int]]
) -> onnx.ModelProto:
    values = {
        name: helper.make_tensor_value_info(name, TensorProto.FLOAT, shape)
        for name, shape in shapes.items()
    }
    output = values.pop("y")
    tensors = [numpy_helper.from_array(value, name) for name, value in weights.items()]
    graph = helper.make_graph(nodes, "small", list(values.values()), [output], tensors)
    return helper.make_model(
        graph, opset_imports=[helper.make_opsetid("", 18)], ir_version=onnx.IR_VERSION_2023_5_5
    )


def run(model: onnx.ModelProto, **feed: np.ndarray) -> np.ndarray:
    onnx.checker.check_model(model)
    (y,) = onnxruntime.InferenceSession(model.SerializeToString()).run(None, feed)
    return y


def test_prelu_stays_the_same() -> None:
    rng = np.random.default_rng(0)
    slope = rng.normal(0, 2, (1, 32, 1, 1)).astype(np.float16).astype(np.float32)
    x = rng.normal(size=(1, 32, 4, 4)).astype(np.float32)
    model = make_model(
        [helper.make_node("PRelu", ["x", "slope"], ["y"])],
        {"slope": slope},
        {"x": [1, 32, 4, 4], "y": [1, 32, 4, 4]},
    )
    before = run(model, x=x)
    expand_prelu(model)
    store_half(model)
    assert {node.op_type for node in model.graph.node} == {"Cast", "Relu", "Sub", "Mul", "Add"}
    assert np.array_equal(run(model, x=x), before)


def test_samples_are_at_the_centres_of_pixels() -> None:
    grid = np.stack(np.meshgrid(np.arange(16), np.arange(16)), -1).astype(np.float32)[None]
    model = make_model(
        [
            helper.make_node("MatMul", ["grid", "matrix"], ["scaled"]),
            helper.make_node("Add", ["scaled", "shift"], ["y"]),
        ],
        {"grid": grid},
        {"matrix": [1, 2, 2], "shift": [1, 1, 1, 2], "y": list(GRID_SHAPE)},
    )
    matrix = np.array([[[0.5, 0.1], [-0.1, 0.25]]], np.float32)
    shift = np.array([7, 9], np.float32).reshape(1, 1, 1, 2)
    centre_samples(model)
    expected = (grid + 0.5) @ matrix + shift - 0.5
    assert np.allclose(run(model, matrix=matrix, shift=shift), expected)
