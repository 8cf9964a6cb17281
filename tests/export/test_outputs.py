"""Exported files of another checkpoint, and a user's, are not replaced."""

import json
from pathlib import Path

import onnx
import pytest

from export.outputs import choose_output, describe_checkpoint
from skinnet.errors import InputError


@pytest.fixture
def checkpoints(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> list[Path]:
    """Two checkpoints; the first was exported as skin.onnx in the working folder."""
    monkeypatch.chdir(tmp_path)
    files = [tmp_path / name / "best.ckpt" for name in ("one", "two")]
    for file in files:
        file.parent.mkdir()
        file.write_text(str(file))
    write(Path("skin.onnx"), describe_checkpoint(files[0], Path("skin.onnx")))
    return files


def write(path: Path, origin: str) -> None:
    graph = onnx.helper.make_graph([], "empty", [], [])
    onnx.save(onnx.helper.make_model(graph, doc_string=origin), path)
    for end in (".decoder.onnx", ".safetensors"):
        path.with_suffix(end).write_bytes(b"")


def test_the_default_name_gets_a_number(checkpoints: list[Path]) -> None:
    assert choose_output(checkpoints[0], None) == Path("skin.onnx")
    assert choose_output(checkpoints[1], None) == Path("skin-2.onnx")
    write(Path("skin-2.onnx"), describe_checkpoint(checkpoints[1], Path("skin-2.onnx")))
    assert choose_output(checkpoints[1], None) == Path("skin-2.onnx")


def test_a_given_name_of_another_checkpoint_is_refused(checkpoints: list[Path]) -> None:
    given = Path("skin.onnx")
    assert choose_output(checkpoints[0], given) == given
    with pytest.raises(InputError, match=r"skin.onnx is there already and was not exported from"):
        choose_output(checkpoints[1], given)


def test_training_that_went_on_replaces_its_own_export(checkpoints: list[Path]) -> None:
    checkpoints[0].write_text("trained further")
    assert choose_output(checkpoints[0], Path("skin.onnx")) == Path("skin.onnx")


def test_a_checkpoint_that_was_moved_is_known_by_its_content(checkpoints: list[Path]) -> None:
    moved = checkpoints[0].rename(checkpoints[0].with_name("moved.ckpt"))
    assert choose_output(moved, Path("skin.onnx")) == Path("skin.onnx")


@pytest.mark.parametrize("name", ["mine.onnx", "mine.decoder.onnx", "mine.safetensors"])
@pytest.mark.parametrize("content", [b"", b"mine", json.dumps({"path": "x"}).encode()])
def test_a_file_of_the_user_is_not_replaced(
    checkpoints: list[Path], name: str, content: bytes
) -> None:
    Path(name).write_bytes(content)
    with pytest.raises(InputError, match=f"{name} is there already"):
        choose_output(checkpoints[0], Path("mine.onnx"))
