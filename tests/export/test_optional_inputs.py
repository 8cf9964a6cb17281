"""Inputs with a default may be left out, given once for a batch, or for each photograph."""

import numpy as np
import onnx
import onnxruntime
import pytest
from onnx import TensorProto, helper

from export.optional_inputs import make_optional

IMAGE = np.arange(12, dtype=np.float32).reshape(3, 4)


@pytest.fixture
def session() -> onnxruntime.InferenceSession:
    """Image [batch, 4] times a, [batch, 4], plus b, [batch]."""
    shapes = {"image": ["batch", 4], "a": ["batch", 4], "b": ["batch"]}
    inputs = [
        helper.make_tensor_value_info(name, TensorProto.FLOAT, shape)
        for name, shape in shapes.items()
    ]
    nodes = [
        helper.make_node("Mul", ["image", "a"], ["product"]),
        helper.make_node("Unsqueeze", ["b", "last"], ["column"]),
        helper.make_node("Add", ["product", "column"], ["y"]),
    ]
    output = helper.make_tensor_value_info("y", TensorProto.FLOAT, ["batch", 4])
    last = helper.make_tensor("last", TensorProto.INT64, [1], [1])
    graph = helper.make_graph(nodes, "g", inputs, [output], [last])
    make_optional(graph, {"a": (4,), "b": ()}, "image")
    opset = helper.make_opsetid("", 20)
    model = helper.make_model(graph, opset_imports=[opset], ir_version=10)
    onnx.checker.check_model(model, full_check=True)
    options = onnxruntime.SessionOptions()
    options.log_severity_level = 3
    return onnxruntime.InferenceSession(model.SerializeToString(), options)


def test_what_is_left_out_is_nan(session: onnxruntime.InferenceSession) -> None:
    assert [one.name for one in session.get_inputs()] == ["image"]
    assert [one.name for one in session.get_overridable_initializers()] == ["a", "b"]
    a = np.ones((1, 4), np.float32)
    for feed in ({}, {"a": a}, {"b": np.ones(1, np.float32)}):
        assert np.isnan(session.run(None, {"image": IMAGE, **feed})[0]).all()


@pytest.mark.parametrize("rows", [1, 3])
def test_a_row_stands_for_all_or_for_one(rows: int, session: onnxruntime.InferenceSession) -> None:
    a = np.random.default_rng(0).random((rows, 4), np.float32)
    b = np.arange(rows, dtype=np.float32)
    (found,) = session.run(None, {"image": IMAGE, "a": a, "b": b})
    np.testing.assert_allclose(found, IMAGE * a + b[:, None], rtol=1e-6)


def test_another_number_of_rows_is_refused(session: onnxruntime.InferenceSession) -> None:
    with pytest.raises(Exception, match="invalid expand shape"):
        session.run(None, {"image": IMAGE, "b": np.ones(2, np.float32)})
