"""The steps that make the networks of faces, on small graphs."""

import numpy as np
import onnx
import onnxruntime
from onnx import TensorProto, helper, numpy_helper
from scipy.ndimage import map_coordinates

from export.face_models import expand_prelu, sample_features, store_half


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


def test_features_are_read_at_the_centres_of_pixels() -> None:
    rng = np.random.default_rng(0)
    grid = np.stack(np.meshgrid(np.arange(16), np.arange(16)), -1).astype(np.float32)[None]
    model = make_model(
        [
            helper.make_node("Transpose", ["x"], ["last"], perm=[0, 2, 3, 1]),
            helper.make_node("MatMul", ["grid", "matrix"], ["scaled"]),
            helper.make_node("Add", ["scaled", "shift"], ["place"]),
            helper.make_node("Floor", ["place"], ["corner"]),
            helper.make_node("Cast", ["corner"], ["whole"], to=TensorProto.INT64),
            helper.make_node("Concat", ["first", "whole"], ["index"], axis=3),
            helper.make_node("GatherND", ["last", "index"], ["read"]),
            helper.make_node("Sum", ["read"] * 4, ["y"]),
        ],
        {"grid": grid, "first": np.zeros((1, 16, 16, 1), np.int64)},
        {"x": [1, 3, 48, 48], "matrix": [1, 2, 2], "shift": [1, 1, 1, 2], "y": [1, 16, 16, 3]},
    )
    x = rng.normal(size=(1, 3, 48, 48)).astype(np.float32)
    matrix = np.array([[[2.5, 0.1], [-0.1, 0.25]]], np.float32)
    shift = np.array([17, -1], np.float32).reshape(1, 1, 1, 2)
    sample_features(model)
    assert "GatherND" not in {node.op_type for node in model.graph.node}
    places = ((grid + 0.5) @ matrix + shift - 0.5)[0]
    expected = [
        map_coordinates(one, [places[..., 1], places[..., 0]], order=1, mode="nearest")
        for one in x[0]
    ]
    found = run(model, x=x, matrix=matrix, shift=shift)
    assert np.allclose(found[0], np.stack(expected, -1), atol=1e-4)
