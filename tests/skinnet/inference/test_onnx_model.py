from collections.abc import Callable
from pathlib import Path

import onnx
import pytest
from onnx import TensorProto, helper

from skinnet import Decomposer
from skinnet.errors import InputError

SaveModel = Callable[..., Path]


@pytest.mark.parametrize("content", [b"", b"onnx?" * 50, "truncated"])
def test_damaged_model_files_are_refused(save_model: SaveModel, content: bytes | str) -> None:
    path = save_model()
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2] if isinstance(content, str) else content)
    with pytest.raises(InputError, match=r"changed\.onnx is not a complete ONNX file .*python -m"):
        Decomposer(path).load()


def test_missing_model_files_are_named(save_model: SaveModel, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"There is no encoder file .*none\.onnx; give"):
        Decomposer(tmp_path / "none.onnx").load()
    path = save_model()
    path.with_name("changed.decoder.onnx").unlink()
    with pytest.raises(InputError, match=r"There is no decoder file .*changed\.decoder\.onnx"):
        Decomposer(path).load()


@pytest.mark.parametrize(
    ("metadata", "words"),
    [
        ({"kind": None}, "is an ONNX file, but not one of skinnet's"),
        ({"format": "1"}, "has format 1, and this skinnet reads format 2; export it again"),
        ({"format": "3"}, "has format 3, .* pip install -U skinnet"),
        ({"format": None}, "has format None"),
        ({"kind": "decoder"}, "is a decoder, but an encoder is needed"),
        ({"lights": "D, A"}, "The metadata of .* is damaged"),
        ({"working_size": "large"}, "The metadata of .* is damaged"),
        ({"working_size": "0"}, "The metadata of .* is damaged"),
        ({"outputs": "{}"}, "The metadata of .* is damaged"),
        ({"region_share": "[1]"}, "The metadata of .* is damaged"),
        ({"outputs": None}, "The metadata of .* is damaged"),
    ],
)
def test_other_metadata_are_refused(
    save_model: SaveModel, metadata: dict[str, str | None], words: str
) -> None:
    with pytest.raises(InputError, match=words):
        Decomposer(save_model(**metadata)).load()


def test_a_file_with_other_outputs_is_refused(tmp_path: Path) -> None:
    value = helper.make_tensor_value_info("x", TensorProto.FLOAT, [1])
    other = helper.make_tensor_value_info("y", TensorProto.FLOAT, [1])
    graph = helper.make_graph([helper.make_node("Neg", ["x"], ["y"])], "g", [value], [other])
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", 20)], ir_version=10)
    helper.set_model_props(model, {"skinnet.kind": "encoder", "skinnet.format": "2"})
    onnx.save(model, tmp_path / "a.onnx")
    with pytest.raises(
        InputError, match="is labelled as an encoder, but its inputs are x and its outputs y"
    ):
        Decomposer(tmp_path / "a.onnx").load()
