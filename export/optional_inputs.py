"""Inputs of a graph that may be left out, because they have default values."""

from collections.abc import Mapping

import numpy as np
from onnx import GraphProto, TensorProto, helper, numpy_helper


def make_optional(graph: GraphProto, shapes: Mapping[str, tuple[int, ...]], image: str) -> None:
    """Give inputs a default, NaN, and let one row of them stand for a whole batch; in place.

    A graph's input that is an initializer too need not be fed (section "Graphs" of the ONNX IR).

    Args:
        graph: The graph; its inputs have one row for each photograph.
        shapes: Names of the inputs, and their shapes without the batch.
        image: Name of the input whose first axis is the batch.
    """
    nodes = [helper.make_node("Shape", [image], ["batch_size"], "batch_size", start=0, end=1)]
    for name, shape in shapes.items():
        rows = f"{name}_rows"
        _rename_uses(graph, name, rows)
        size = "batch_size"
        if shape:
            size = f"{name}_size"
            parts = ["batch_size", "one"]
            nodes.append(helper.make_node("Concat", parts, [size], size, axis=0))
        nodes.append(helper.make_node("Expand", [name, size], [rows], rows))
        _set_default(graph, name, np.full((1, *shape), np.nan, np.float32))
    graph.initializer.append(numpy_helper.from_array(np.array([1]), "one"))
    rest = list(graph.node)
    del graph.node[:]
    graph.node.extend([*nodes, *rest])


def _rename_uses(graph: GraphProto, name: str, new: str) -> None:
    for node in graph.node:
        for index, used in enumerate(node.input):
            if used == name:
                node.input[index] = new


def _set_default(graph: GraphProto, name: str, value: np.ndarray) -> None:
    """Make a value the default of an input, whose first axis becomes one of its own."""
    graph.initializer.append(numpy_helper.from_array(value, name))
    given = next(each for each in graph.input if each.name == name)
    axes = ["known", *value.shape[1:]]
    given.CopyFrom(helper.make_tensor_value_info(name, TensorProto.FLOAT, axes))
