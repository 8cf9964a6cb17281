"""Exported graphs in a form that other tools of ONNX can read and rewrite."""

import string
from collections.abc import Iterator

import numpy as np
import onnx
from onnx import GraphProto, ModelProto, NodeProto, TensorProto, helper, numpy_helper

Shapes = dict[str, list[int | str]]
"""Number or name of each axis of each value."""

_LARGEST_FACTOR = 1e4
"""Larger constants are clipped by onnxruntime's conversion to half precision."""


def finish(model: ModelProto) -> None:
    """Remove what misleads other tools from an exported graph, in place; no output changes.

    A graph that is finished stays as it is.

    - The shapes of initializers are removed. They repeat the initializers, and they are stale as
      soon as a tool replaces one, as `quantize_dynamic` does when it transposes weights.
    - The origins of nodes are removed: a quarter of a small file, with local paths.
    - What the symbolic shape inference of onnxruntime does not know, or takes wrongly, is written
      in another way: a maximum over height and width, whether any of some values is true, the
      ellipsis of an Einstein sum, and sizes that are computed from the photograph's where a tensor
      of that size is at hand.
    - NaN is replaced by 0 in an operator that is not quantised, since NaN has no scale.
    - A factor above 10,000 becomes two, of which one is a power of two, so that products keep their
      bits. Conversion to half precision would clip it without a word.

    Args:
        model: The graph; its metadata stay.

    Raises:
        onnx.checker.ValidationError: The graph is not a valid one.
        onnx.shape_inference.InferenceError: Its shapes contradict one another.
    """
    graph = model.graph
    for part in (graph, *graph.node, *graph.value_info):
        part.ClearField("metadata_props")
        part.ClearField("doc_string")
    shapes = _read_shapes(graph)
    nodes = [new for node in graph.node for new in _rewrite(node, graph, shapes)]
    kept = _keep_used(nodes, {output.name for output in graph.output})
    _replace_nodes(graph, kept)
    onnx.checker.check_model(model, full_check=True)
    onnx.shape_inference.infer_shapes(model, check_type=True, strict_mode=True, data_prop=True)


def _read_shapes(graph: GraphProto) -> Shapes:
    values = (*graph.input, *graph.value_info, *graph.output)
    return {
        value.name: [dim.dim_value or dim.dim_param for dim in value.type.tensor_type.shape.dim]
        for value in values
    }


def _replace_nodes(graph: GraphProto, nodes: list[NodeProto]) -> None:
    """Set the nodes of a graph, and leave out initializers and shapes of which none has need."""
    used = {name for node in nodes for name in node.input}
    made = {name for node in nodes for name in node.output}
    shapes = [shape for shape in graph.value_info if shape.name in made]
    tensors = [tensor for tensor in graph.initializer if tensor.name in used]
    for field, content in ((graph.node, nodes), (graph.value_info, shapes)):
        del field[:]
        field.extend(content)
    del graph.initializer[:]
    graph.initializer.extend(tensors)


def _keep_used(nodes: list[NodeProto], needed: set[str]) -> list[NodeProto]:
    kept = []
    for node in reversed(nodes):
        if needed & set(node.output):
            needed |= set(node.input)
            kept.append(node)
    return kept[::-1]


def _rewrite(node: NodeProto, graph: GraphProto, shapes: Shapes) -> Iterator[NodeProto]:
    """The nodes that stand for one; most stand for themselves."""
    if node.op_type == "ReduceMax" and _is_pooling(node, graph, shapes):
        yield from _pool(node)
    elif node.op_type == "ReduceMax" and _is_any(node, graph):
        node.op_type = "ReduceSum"
        yield node
    elif node.op_type == "Where" and _is_fill(node, graph):
        yield _fill(node)
    elif node.op_type == "Resize" and (model := _find_model(node, graph, shapes)):
        yield from _resize_as(node, model)
    elif node.op_type == "Mul" and (factor := _find_large_factor(node, graph)) is not None:
        yield from _multiply_twice(node, factor, graph)
    else:
        if node.op_type == "Einsum":
            _name_axes(node, shapes)
        yield node


def _is_pooling(node: NodeProto, graph: GraphProto, shapes: Shapes) -> bool:
    """Whether a maximum is over height and width of [batch, channels, height, width]."""
    axes = [numpy_helper.to_array(one) for one in graph.initializer if one.name in node.input[1:]]
    return len(shapes.get(node.input[0], [])) == 4 and bool(axes) and sorted(axes[0] % 4) == [2, 3]


def _is_any(node: NodeProto, graph: GraphProto) -> bool:
    """Whether a maximum is over truth values as integers, and a truth value again."""
    made = {name: one for one in graph.node for name in one.output}
    before = made.get(node.input[0])
    after = [one for one in graph.node if node.output[0] in one.input]
    to = [attribute.i for one in after for attribute in one.attribute if attribute.name == "to"]
    if before is None or before.op_type != "Cast" or to != [TensorProto.BOOL]:
        return False
    source = made.get(before.input[0])
    return source is not None and source.op_type in ("IsNaN", "Not")


def _is_fill(node: NodeProto, graph: GraphProto) -> bool:
    """Whether a choice is of 0 where the other value is NaN."""
    condition, zero, value = node.input
    zeros = (one for one in graph.initializer if one.name == zero)
    is_zero = any(not numpy_helper.to_array(one).any() for one in zeros)
    tests = [one for one in graph.node if one.op_type == "IsNaN" and one.output[0] == condition]
    return is_zero and [one.input[0] for one in tests] == [value]


def _fill(node: NodeProto) -> NodeProto:
    # It is x where x > alpha, which NaN is not, and 0 elsewhere.
    lowest = float(np.finfo(np.float32).min)
    return helper.make_node("ThresholdedRelu", node.input[2:], node.output, node.name, alpha=lowest)


def _pool(node: NodeProto) -> Iterator[NodeProto]:
    keeps = all(attribute.i for attribute in node.attribute if attribute.name == "keepdims")
    pooled = node.output[0] if keeps else f"{node.output[0]}_pooled"
    yield helper.make_node("GlobalMaxPool", node.input[:1], [pooled], f"{node.name}_pool")
    if not keeps:
        yield helper.make_node("Squeeze", [pooled, node.input[1]], node.output, node.name)


def _find_model(node: NodeProto, graph: GraphProto, shapes: Shapes) -> str | None:
    """A tensor that exists before `node`, is used together with its result and has its size."""
    resized = node.output[0]
    if node.input[3] == f"{resized}_shape":
        return None
    earlier = set()
    for one in graph.node:
        if one.output[0] == resized:
            break
        earlier |= set(one.output)
    beside = [name for one in graph.node if resized in one.input for name in one.input]
    size = shapes.get(resized, [])[2:]
    fit = (name for name in beside if name in earlier and shapes.get(name, [])[2:] == size)
    return next(fit, None) if size else None


def _resize_as(node: NodeProto, model: str) -> Iterator[NodeProto]:
    name = node.output[0]
    channels, size, both = (f"{name}_{part}" for part in ("channels", "size", "shape"))
    yield helper.make_node("Shape", node.input[:1], [channels], channels, start=0, end=2)
    yield helper.make_node("Shape", [model], [size], size, start=2, end=4)
    yield helper.make_node("Concat", [channels, size], [both], both, axis=0)
    node.input[3] = both
    yield node


def _find_large_factor(node: NodeProto, graph: GraphProto) -> TensorProto | None:
    """The scalar constant of a product, if it is too large for half precision."""
    scalars = (one for one in graph.initializer if one.name in node.input and not one.dims)
    large = (one for one in scalars if abs(numpy_helper.to_array(one)) > _LARGEST_FACTOR)
    return next(large, None)


def _multiply_twice(node: NodeProto, factor: TensorProto, graph: GraphProto) -> Iterator[NodeProto]:
    value = numpy_helper.to_array(factor)
    power = 2 ** np.ceil(np.log2(abs(value) / _LARGEST_FACTOR)).astype(value.dtype)
    parts = {f"{node.name}_power": power, f"{node.name}_factor": value / power}
    graph.initializer.extend(
        numpy_helper.from_array(np.asarray(part, value.dtype), name) for name, part in parts.items()
    )
    (other,) = (name for name in node.input if name != factor.name)
    first, second = parts
    scaled = f"{node.output[0]}_scaled"
    yield helper.make_node("Mul", [other, first], [scaled], first)
    yield helper.make_node("Mul", [scaled, second], node.output, node.name)


def _name_axes(node: NodeProto, shapes: Shapes) -> None:
    """Write letters for the axes that the ellipsis of an equation stands for."""
    equation = next(one for one in node.attribute if one.name == "equation")
    text = equation.s.decode()
    free = [letter for letter in string.ascii_lowercase if letter not in text]
    for term, name in zip(text.split("->")[0].split(","), node.input, strict=True):
        if "..." in term:
            count = len(shapes[name]) - len(term.replace("...", "").strip())
            equation.s = text.replace("...", "".join(free[:count])).encode()
            return
