"""Exported files are rewritten only if their outputs stay the same to the bit."""

from pathlib import Path

import numpy as np
import onnx
import pytest
from onnx import helper, numpy_helper

from export import rewrite as rewriting
from export.rewrite import main, rewrite
from skinnet.errors import InputError
from skinnet.inference import SHIPPED_ENCODER
from skinnet.inference._onnx_pair import get_decoder_path


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    path = tmp_path / "skin.onnx"
    for source, target in (
        (SHIPPED_ENCODER, path),
        (get_decoder_path(SHIPPED_ENCODER), get_decoder_path(path)),
    ):
        target.write_bytes(source.read_bytes())
    return path


def test_the_shipped_files_are_as_export_writes_them(copy: Path) -> None:
    before = [path.read_bytes() for path in (copy, get_decoder_path(copy))]
    assert [path.read_bytes() for path in rewrite(copy)] == before


def test_a_file_of_an_earlier_export_is_mended(
    copy: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    model = onnx.load(copy)
    stale = [
        helper.make_tensor_value_info(t.name, t.data_type, t.dims) for t in model.graph.initializer
    ]
    model.graph.value_info.extend(stale)
    onnx.save(model, copy)
    assert main([str(copy)]) == 0
    assert "the same outputs to the bit" in capsys.readouterr().out
    names = {value.name for value in onnx.load(copy).graph.value_info}
    assert not names & {value.name for value in stale}
    before, after = (
        [numpy_helper.to_array(tensor) for tensor in one.graph.initializer]
        for one in (model, onnx.load(copy))
    )
    for old, new in zip(before, after, strict=True):
        np.testing.assert_array_equal(old, new)


def test_a_changed_output_leaves_all_files_as_they_are(
    copy: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def change(model: onnx.ModelProto) -> None:
        node = next(node for node in model.graph.node if node.op_type == "Sigmoid")
        node.op_type = "HardSigmoid"

    monkeypatch.setattr(rewriting, "finish", change)
    before = copy.read_bytes()
    with pytest.raises(InputError, match="would change its outputs; it was left as it is"):
        rewrite(copy)
    assert copy.read_bytes() == before and len(list(copy.parent.iterdir())) == 2


def test_a_file_that_is_no_model_gets_a_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main([str(tmp_path / "absent.onnx")]) == 2
    assert "absent.onnx" in capsys.readouterr().err
