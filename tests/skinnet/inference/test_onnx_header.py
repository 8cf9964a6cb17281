"""The header of an ONNX file is read as the library of ONNX reads it."""

from pathlib import Path

import onnx
import pytest
from onnx import TensorProto, helper

from skinnet.inference import SHIPPED_ENCODER
from skinnet.inference._onnx_header import Header, read_header
from skinnet.inference._onnx_pair import get_decoder_path


@pytest.mark.parametrize("path", [SHIPPED_ENCODER, get_decoder_path(SHIPPED_ENCODER)])
def test_a_shipped_file_is_read_as_onnx_reads_it(path: Path) -> None:
    header, model = read_header(path), onnx.load(path)
    assert header is not None and header.missing_bytes == 0
    assert header.ir_version == model.ir_version
    assert header.opsets == {one.domain: one.version for one in model.opset_import}
    assert header.metadata == {entry.key: entry.value for entry in model.metadata_props}
    assert header.producer == f"{model.producer_name} {model.producer_version}"


def test_long_numbers_texts_and_absent_fields(tmp_path: Path) -> None:
    value = helper.make_tensor_value_info("x", TensorProto.FLOAT, [1])
    graph = helper.make_graph([helper.make_node("Neg", ["x"], ["y"])], "g", [value], [value])
    opsets = [helper.make_opsetid("", 300), helper.make_opsetid("a.b", 2**40)]
    model = helper.make_model(graph, opset_imports=opsets, ir_version=2**33, doc_string="d" * 999)
    model.ClearField("producer_name")
    model.model_version = 2**62
    helper.set_model_props(model, {"é": "ü" * 200, "empty": ""})
    path = tmp_path / "a.onnx"
    path.write_bytes(model.SerializeToString())
    expected = Header(2**33, "", {"": 300, "a.b": 2**40}, {"é": "ü" * 200, "empty": ""}, 0)
    assert read_header(path) == expected


def test_any_cut_is_seen_or_leaves_no_set_of_operators(tmp_path: Path) -> None:
    whole = get_decoder_path(SHIPPED_ENCODER).read_bytes()
    path = tmp_path / "a.onnx"
    for length in [*range(60), *range(len(whole) - 2200, len(whole), 7)]:
        path.write_bytes(whole[:length])
        header = read_header(path)
        complete = header is not None and header.missing_bytes == 0 and header.opsets
        # Between two fields nothing shows; then what is missing is metadata.
        assert not complete or len(header.metadata) < 9, length


def test_a_few_bytes_are_no_onnx_file(tmp_path: Path) -> None:
    path = tmp_path / "a.onnx"
    for content in (b"", b"\x08", b"\x08\x00", b"\xff" * 99, b"\x12\x03abc", b"\x0a\x00"):
        path.write_bytes(content)
        assert read_header(path) is None
