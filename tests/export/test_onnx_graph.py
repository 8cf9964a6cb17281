"""Finished graphs compute the same to the bit, in operators that other tools know."""

import numpy as np
import onnx
import onnxruntime
import pytest
from onnx import ModelProto, NodeProto, TensorProto, helper, numpy_helper

from export.onnx_graph import finish

SHAPE = ["batch", 3, "height", "width"]
RNG = np.random.default_rng(0)


def make_model(
    nodes: list[NodeProto], output: list[int | str], tensors: dict[str, np.ndarray]
) -> ModelProto:
    """A graph from x, [batch, 3, height, width], to y, with shapes of its initializers."""
    x = helper.make_tensor_value_info("x", TensorProto.FLOAT, SHAPE)
    y = helper.make_tensor_value_info("y", TensorProto.FLOAT, output)
    stated = [
        helper.make_tensor_value_info(name, helper.np_dtype_to_tensor_dtype(t.dtype), t.shape)
        for name, t in tensors.items()
    ]
    initializers = [numpy_helper.from_array(value, name) for name, value in tensors.items()]
    graph = helper.make_graph(nodes, "g", [x], [y], initializers, value_info=stated)
    opsets = [helper.make_opsetid("", 20)]
    return onnx.shape_inference.infer_shapes(
        helper.make_model(graph, opset_imports=opsets, ir_version=10)
    )


def run(model: ModelProto, x: np.ndarray) -> np.ndarray:
    session = onnxruntime.InferenceSession(model.SerializeToString())
    return session.run(None, {"x": x})[0]


def maximum(keepdims: int, axes: list[int]) -> ModelProto:
    node = helper.make_node("ReduceMax", ["x", "axes"], ["y"], "top", keepdims=keepdims)
    shape = [SHAPE[0], 3, 1, 1] if keepdims else SHAPE[:2]
    if 1 in axes:
        shape = ["batch", 1, "height", 1] if keepdims else ["batch", "height"]
    return make_model([node], shape, {"axes": np.array(axes)})


def product(constant: float) -> ModelProto:
    node = helper.make_node("Mul", ["x", "c"], ["y"], "scale")
    return make_model([node], SHAPE, {"c": np.array(constant, np.float32)})


def einsum(equation: str) -> ModelProto:
    node = helper.make_node("Einsum", ["x", "m"], ["y"], equation=equation)
    return make_model([node], ["batch", 3, "height", 5], {"m": np.ones((4, 5), np.float32)})


def resize() -> ModelProto:
    """A picture's half, enlarged to a size that is computed from the picture's, added to it."""
    pool = {"kernel_shape": [2, 2], "strides": [2, 2], "ceil_mode": 1}
    nodes = [
        helper.make_node("MaxPool", ["x"], ["half"], **pool),
        helper.make_node("Relu", ["x"], ["beside"]),
        helper.make_node("Shape", ["x"], ["size"], start=2),
        helper.make_node("Shape", ["half"], ["channels"], end=2),
        helper.make_node("Concat", ["channels", "size"], ["sizes"], axis=0),
        helper.make_node("Resize", ["half", "", "", "sizes"], ["large"], mode="linear"),
        helper.make_node("Add", ["large", "beside"], ["y"]),
    ]
    model = make_model(nodes, SHAPE, {})
    shape = next(one for one in model.graph.value_info if one.name == "large")
    shape.CopyFrom(helper.make_tensor_value_info("large", TensorProto.FLOAT, SHAPE))
    return model


def missing() -> ModelProto:
    """NaN by 0, and 1 more in the rows of pixels of which any is NaN."""
    nodes = [
        helper.make_node("IsNaN", ["x"], ["no"]),
        helper.make_node("Where", ["no", "zero", "x"], ["filled"]),
        helper.make_node("Cast", ["no"], ["number"], to=TensorProto.INT64),
        helper.make_node("ReduceMax", ["number", "last"], ["most"], keepdims=1),
        helper.make_node("Cast", ["most"], ["any"], to=TensorProto.BOOL),
        helper.make_node("Cast", ["any"], ["flag"], to=TensorProto.FLOAT),
        helper.make_node("Add", ["filled", "flag"], ["y"]),
    ]
    return make_model(nodes, SHAPE, {"zero": np.float32(0), "last": np.array([3])})


CASES = {
    "maximum": (maximum(0, [-2, -1]), {"GlobalMaxPool", "Squeeze"}),
    "maximum, axes kept": (maximum(1, [2, 3]), {"GlobalMaxPool"}),
    "maximum over channels": (maximum(0, [1, 3]), {"ReduceMax"}),
    "large factor": (product(1e6), {"Mul"}),
    "large negative factor": (product(-123456.7), {"Mul"}),
    "small factor": (product(300.0), {"Mul"}),
    "ellipsis": (einsum("...w,wk->...k"), {"Einsum"}),
    "letters": (einsum("bchw,wk->bchk"), {"Einsum"}),
    "missing values": (missing(), {"IsNaN", "ThresholdedRelu", "Cast", "ReduceSum", "Add"}),
    "resize": (resize(), {"MaxPool", "Relu", "Shape", "Concat", "Resize", "Add"}),
}


@pytest.mark.parametrize("case", CASES)
def test_a_finished_graph_computes_the_same(case: str) -> None:
    model, operators = CASES[case]
    x = RNG.normal(size=(2, 3, 5, 4)).astype(np.float32)
    if case == "missing values":
        x[:, :, 1:3, ::2] = np.nan
    before = run(model, x)
    done = ModelProto.FromString(model.SerializeToString())
    finish(done)
    assert np.array_equal(run(done, x), before)
    assert {node.op_type for node in done.graph.node} == operators
    again = ModelProto.FromString(done.SerializeToString())
    finish(again)
    assert again == done


def test_what_other_tools_take_wrongly_is_gone() -> None:
    for case in ("large factor", "ellipsis", "resize", "maximum"):
        finish(CASES[case][0])
    names = {tensor.name for tensor in CASES["maximum"][0].graph.initializer}
    assert not names & {value.name for value in CASES["maximum"][0].graph.value_info}
    factors = [float(numpy_helper.to_array(t)) for t in CASES["large factor"][0].graph.initializer]
    assert sorted(factors) == [128.0, 7812.5]
    (equation,) = CASES["ellipsis"][0].graph.node[0].attribute
    assert equation.s == b"abcw,wk->abck"
    (node,) = (node for node in CASES["resize"][0].graph.node if node.op_type == "Resize")
    assert node.input[3] == "large_shape"


def test_a_graph_that_contradicts_itself_is_refused() -> None:
    model = product(2.0)
    model.graph.node[0].input[0] = "absent"
    with pytest.raises(onnx.checker.ValidationError):
        finish(model)
