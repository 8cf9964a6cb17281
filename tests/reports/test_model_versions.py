"""A model that cannot be used is named for what it is, with both versions and the remedy."""

import gzip
import io
import json
import pickle
import zipfile
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import onnx
import onnxruntime
import pytest
import torch
from onnx import ModelProto, helper
from PIL import Image
from safetensors import safe_open
from safetensors.torch import save_file

from skinnet import Decomposer
from skinnet._version import __version__
from skinnet.appearance._array_file import read_arrays, write_arrays
from skinnet.appearance.stack import open_stack
from skinnet.cli import main
from skinnet.errors import InputError
from skinnet.inference import SHIPPED_ENCODER, open_model
from skinnet.inference._onnx_pair import get_decoder_path
from skinnet.inference.onnx_model import ONNX_FORMAT
from skinnet.network import SkinAutoencoder
from skinnet.network._weights import SHIPPED_WEIGHTS, WEIGHTS_FORMAT
from skinnet.shape import load_shape_model

RUNTIME = f"onnxruntime {onnxruntime.__version__}"
UPGRADE = "pip install -U onnxruntime"
SHIPPED = SHIPPED_ENCODER.read_bytes()


def set_entry(name: str, value: str | None) -> Callable[[ModelProto], None]:
    def change(model: ModelProto) -> None:
        entries = {entry.key: entry.value for entry in model.metadata_props}
        entries[f"skinnet.{name}"] = value or ""
        del model.metadata_props[:]
        helper.set_model_props(model, {k: v for k, v in entries.items() if v})

    return change


def set_ir_version(number: int) -> Callable[[ModelProto], None]:
    return lambda model: setattr(model, "ir_version", number)


def set_opset(domain: str, number: int) -> Callable[[ModelProto], None]:
    def change(model: ModelProto) -> None:
        kept = [one for one in model.opset_import if one.domain != domain]
        del model.opset_import[:]
        model.opset_import.extend([*kept, helper.make_opsetid(domain, number)])

    return change


def set_operator(name: str, domain: str = "", imported: bool = True) -> Callable[..., None]:
    def change(model: ModelProto) -> None:
        node = next(node for node in model.graph.node if node.op_type == "Sigmoid")
        node.op_type, node.domain = name, domain
        if imported and domain:
            set_opset(domain, 1)(model)

    return change


def all_of(*changes: Callable[[ModelProto], None]) -> Callable[[ModelProto], None]:
    def change(model: ModelProto) -> None:
        for one in changes:
            one(model)

    return change


def forget_metadata(model: ModelProto) -> None:
    model.ClearField("metadata_props")


NEWER = {
    "IR version": (set_ir_version(99), ["IR version 99", RUNTIME, UPGRADE]),
    "opset": (set_opset("", 99), ["opset 99 of ai.onnx", RUNTIME, UPGRADE]),
    "opset of machine learning": (set_opset("ai.onnx.ml", 99), ["opset 99 of ai.onnx.ml", UPGRADE]),
    "opset of onnxruntime": (set_opset("com.microsoft", 9), ["opset 9 of com.microsoft", UPGRADE]),
    "operator": (set_operator("Frobnicate"), ["Frobnicate", "opset 20", RUNTIME, UPGRADE]),
    "operator of a later opset": (set_operator("Swish"), ["Swish", "opset 20", UPGRADE]),
    "operator of onnxruntime": (
        set_operator("Frobnicate", "com.microsoft"),
        ["com.microsoft:Frobnicate", RUNTIME, UPGRADE],
    ),
    "format": (
        all_of(set_entry("format", "3"), set_entry("version", "7.1")),
        ["has format 3", f"reads format {ONNX_FORMAT}", "skinnet 7.1", __version__, "-U skinnet"],
    ),
    "format and runtime": (
        all_of(set_entry("format", "12"), set_entry("version", "7.1"), set_ir_version(99)),
        ["has format 12", "skinnet 7.1", "pip install -U skinnet"],
    ),
}
OTHER = {
    "earlier format": (
        all_of(set_entry("format", "1"), set_entry("version", "0.0.7")),
        ["has format 1", "export it again", "skinnet 0.0.7", 'pip install "skinnet==0.0.7"'],
    ),
    "no format": (set_entry("format", None), ["has format None", "export it again"]),
    "format without a number": (set_entry("format", "new"), ["has format new"]),
    "operators of others": (
        set_operator("Frobnicate", "my.own"),
        ["my.own:Frobnicate", "no set of operators that onnxruntime brings", "python -m export"],
    ),
    "operators that are not named": (set_operator("Sigmoid", "my.own", False), ["of my.own"]),
    "another tool": (forget_metadata, ["not one of skinnet's", "pytorch 2.13", "opset 20"]),
    "another tool and newer": (
        all_of(forget_metadata, set_ir_version(99)),
        ["not one of skinnet's", "IR version 99"],
    ),
}


@pytest.mark.parametrize("case", [*NEWER, *OTHER])
def test_a_file_of_another_version_names_the_versions(case: str, tmp_path: Path) -> None:
    change, words = (NEWER | OTHER)[case]
    model = ModelProto.FromString(SHIPPED)
    change(model)
    path = tmp_path / "skin.onnx"
    path.write_bytes(model.SerializeToString())
    with pytest.raises(InputError) as caught:
        open_model(path, "encoder")
    message = str(caught.value)
    assert message.startswith(f"{path} ") and "\n" not in message
    assert all(word in message for word in words), message
    # What is newer is not called damaged.
    assert "complete" not in message and "damaged" not in message


def make_zip(*names: str) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        for name in names:
            archive.writestr(name, "x")
    return stream.getvalue()


def make_npz() -> bytes:
    stream = io.BytesIO()
    np.savez(stream, a=np.ones(3))
    return stream.getvalue()


POINTER = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 4777849\n"
CONTENTS = {
    "pointer of Git LFS": (POINTER, ["a pointer of Git LFS", "git lfs pull"]),
    "pointer of git-annex": (b"/annex/objects/SHA256E-s1--2.onnx\n", ["git annex get"]),
    "page": (b"\n<!DOCTYPE html>\n<html></html>", ["a web page", "download the file itself"]),
    "page, lower case": (b"\xef\xbb\xbf<html lang='en'>", ["a web page"]),
    "error of a store": (b'<?xml version="1.0"?><Error>', ["a web page"]),
    "answer of a server": (b'{"message": "Not Found"}', ["JSON", "download the file itself"]),
    "gzip": (gzip.compress(SHIPPED[:5000]), ["a gzip archive", "unpack it"]),
    "zip": (make_zip("skin.onnx"), ["a ZIP archive", "unpack it"]),
    "cut zip": (make_zip("skin.onnx")[:20], ["a ZIP archive that is cut short"]),
    "checkpoint": (make_zip("a/data.pkl", "a/version"), ["a checkpoint of torch", "-m export"]),
    "safetensors": (SHIPPED_WEIGHTS.read_bytes()[:9000], ["python -m export"]),
    "arrays": (make_npz(), ["an .npz archive of arrays"]),
    "pickle": (pickle.dumps({"a": 1}), ["a pickle"]),
    "Keras": (b"\x89HDF\r\n\x1a\n", ["HDF5"]),
    "TensorFlow Lite": (b"\x1c\0\0\0TFL3" + bytes(30), ["TensorFlow Lite"]),
    "ORT format": (b"\x1c\0\0\0ORTM" + bytes(30), ["ORT format"]),
    "picture": (b"\x89PNG\r\n\x1a\n", ["a picture", "as the input"]),
    "nothing": (b"", ["it is empty", "copy it again"]),
    "text": (b"hello", ["of another kind"]),
    "noise": (np.random.default_rng(0).bytes(999), ["of another kind"]),
    "half": (SHIPPED[: len(SHIPPED) // 2], ["cut short", "copy or download it again"]),
    "all but a byte": (SHIPPED[:-1], ["cut short", f"{len(SHIPPED):,}", f"{len(SHIPPED) - 1:,}"]),
    "two bytes": (SHIPPED[:2], ["names no set of operators"]),
    "graph overwritten": (SHIPPED[:300] + b"\xff" * 400 + SHIPPED[700:], ["damaged"]),
}


@pytest.mark.parametrize("case", CONTENTS)
def test_another_file_is_named_for_what_it_is(case: str, tmp_path: Path) -> None:
    content, words = CONTENTS[case]
    path = tmp_path / "skin.onnx"
    path.write_bytes(content)
    with pytest.raises(InputError) as caught:
        Decomposer(path).load()
    message = str(caught.value)
    assert (
        message.startswith(f"{path} is not a complete ONNX file (it is ") or "names no" in message
    )
    assert all(word in message for word in words) and "leave --model out" in message, message


def test_weights_in_another_file_are_missed_by_name(tmp_path: Path) -> None:
    path = tmp_path / "skin.onnx"
    model = ModelProto.FromString(SHIPPED)
    onnx.save(model, path, save_as_external_data=True, location="w.bin", size_threshold=1024)
    get_decoder_path(path).write_bytes(get_decoder_path(SHIPPED_ENCODER).read_bytes())
    Decomposer(path).load()
    weights = tmp_path / "w.bin"
    for content in (weights.read_bytes()[:100], None):
        weights.unlink()
        if content is not None:
            weights.write_bytes(content)
        with pytest.raises(InputError, match=r"keeps its weights in another file.*copy that file"):
            open_model(path, "encoder")


def write_pair(path: Path, change: Callable[[ModelProto], None]) -> Path:
    """The shipped encoder beside a changed decoder."""
    path.write_bytes(SHIPPED)
    decoder = onnx.load(get_decoder_path(SHIPPED_ENCODER))
    change(decoder)
    onnx.save(decoder, get_decoder_path(path))
    return path


@pytest.mark.parametrize(
    ("entry", "value", "word"),
    [
        ("optics", "calibrated", "preset of the skin"),
        ("version", "0.0.9", "version of skinnet"),
        ("lights", json.dumps(["D"]), "lights"),
        ("working_size", "128", "working size"),
        ("trained_on", "other faces", "training data"),
    ],
)
def test_a_decoder_of_another_export_is_refused(
    entry: str, value: str, word: str, tmp_path: Path
) -> None:
    path = write_pair(tmp_path / "skin.onnx", set_entry(entry, value))
    with pytest.raises(InputError, match=f"not exported together .*the {word} of the") as caught:
        Decomposer(path).load()
    assert str(path) in str(caught.value) and str(get_decoder_path(path)) in str(caught.value)
    with pytest.raises(InputError, match="not exported together"):
        _ = Decomposer(path).decoder


def test_a_missing_decoder_and_a_folder_are_named(tmp_path: Path) -> None:
    path = tmp_path / "skin.int8.onnx"
    path.write_bytes(SHIPPED)
    with pytest.raises(InputError, match=r"skin\.int8\.decoder\.onnx; copy the decoder that was"):
        Decomposer(path).load()
    with pytest.raises(InputError, match="is a folder; name the encoder file"):
        Decomposer(tmp_path).load()


def test_the_command_says_it_too(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    Image.new("RGB", (64, 64), (200, 150, 130)).save(tmp_path / "a.png")
    path = write_pair(tmp_path / "skin.onnx", set_opset("", 99))
    for verb in (["predict"], ["edit", "--melanin", "2"]):
        arguments = [*verb, str(tmp_path / "a.png"), "--model", str(path), "--whole-image"]
        assert main([*arguments, "-o", str(tmp_path / "out.png")]) == 2
        message = capsys.readouterr().err
        assert str(get_decoder_path(path)) in message and UPGRADE in message and RUNTIME in message
    assert not (tmp_path / "out.png").exists()


def write_weights(path: Path, **entries: str) -> Path:
    with safe_open(SHIPPED_WEIGHTS, framework="pt") as file:
        metadata, names = file.metadata(), list(file.keys())
        state = {name: file.get_tensor(name) for name in names}
    save_file(state, path, metadata | {f"skinnet.{name}": value for name, value in entries.items()})
    return path


def write_checkpoint(path: Path, **entries: object) -> Path:
    description = {"format": WEIGHTS_FORMAT, "version": __version__, **entries}
    torch.save({"skinnet": description, "state_dict": {}}, path)
    return path


NEXT = WEIGHTS_FORMAT + 1


@pytest.mark.parametrize(
    ("write", "name", "form"),
    [(write_weights, "a.safetensors", str), (write_checkpoint, "a.ckpt", int)],
)
def test_weights_of_another_version_name_both(
    write: Callable[..., Path], name: str, form: type, tmp_path: Path
) -> None:
    newer = write(tmp_path / name, format=form(NEXT), version="7.1")
    with pytest.raises(InputError) as caught:
        SkinAutoencoder.from_pretrained(newer)
    for word in (str(newer), f"format {NEXT}, this skinnet reads {WEIGHTS_FORMAT}", "skinnet 7.1"):
        assert word in str(caught.value)
    assert f"this is skinnet {__version__}: pip install -U skinnet" in str(caught.value)
    older = write(tmp_path / name, format=form(1), version="0.0.1")
    with pytest.raises(InputError, match=r'train it again.*pip install "skinnet==0\.0\.1"'):
        SkinAutoencoder.from_pretrained(older)


def test_weights_that_describe_something_new_name_their_version(tmp_path: Path) -> None:
    config = {"optics": "of 2030", "widths": [4, 8], "working_size": 32}
    path = write_weights(tmp_path / "a.safetensors", config=json.dumps(config), version="7.1")
    with pytest.raises(InputError, match=r"skinnet 7\.1 wrote it, and this is skinnet"):
        SkinAutoencoder.from_pretrained(path)
    path = write_checkpoint(tmp_path / "a.ckpt", version="7.1")
    with pytest.raises(InputError, match=r"skinnet 7\.1 wrote it, and this is skinnet"):
        SkinAutoencoder.from_pretrained(path)


@pytest.mark.parametrize("suffix", [".ckpt", ".safetensors"])
@pytest.mark.parametrize(
    ("content", "words"),
    [
        (POINTER, "git lfs pull"),
        (b"<!DOCTYPE html><html>", "a web page"),
        (SHIPPED[:5000], "a model in ONNX"),
        (b"", "it is empty"),
    ],
    ids=["pointer", "page", "onnx", "empty"],
)
def test_another_file_in_place_of_weights_is_named(
    content: bytes, words: str, suffix: str, tmp_path: Path
) -> None:
    path = tmp_path / f"a{suffix}"
    path.write_bytes(content)
    with pytest.raises(InputError, match=rf"a\{suffix} is not a complete .*{words}"):
        SkinAutoencoder.from_pretrained(path)


def test_weights_under_the_wrong_ending_are_told_the_right_one(tmp_path: Path) -> None:
    path = tmp_path / "a.ckpt"
    path.write_bytes(SHIPPED_WEIGHTS.read_bytes())
    with pytest.raises(InputError, match=r"in safetensors; give it a name that ends in \.safetens"):
        SkinAutoencoder.from_pretrained(path)
    path = write_checkpoint(tmp_path / "b.safetensors")
    with pytest.raises(InputError, match=r"of torch; give it a name that ends in \.ckpt"):
        SkinAutoencoder.from_pretrained(path)


def test_a_checkpoint_with_objects_of_another_program_is_not_called_damaged(tmp_path: Path) -> None:
    path = tmp_path / "a.ckpt"
    torch.save({"state_dict": {}, "arguments": SimpleNamespace(a=1)}, path)
    with pytest.raises(InputError, match=r"other objects than weights.*could run code"):
        SkinAutoencoder.from_pretrained(path)


@pytest.mark.parametrize(("form", "version"), [(2, "7.1"), ("two", None)])
def test_arrays_of_another_version_name_both(
    form: object, version: str | None, tmp_path: Path
) -> None:
    path = tmp_path / "model.npz"
    write_arrays(path, "HybridModel", {"format": form, "skinnet": version}, {"a": np.ones(2)})
    with pytest.raises(InputError, match=f"has format {form}, and this skinnet reads") as caught:
        read_arrays(path, "HybridModel", ("a",))
    assert ("skinnet 7.1 wrote it" in str(caught.value)) == (version == "7.1")
    assert ("pip install -U skinnet" in str(caught.value)) == (form == 2)
    path.write_bytes(POINTER)
    with pytest.raises(InputError, match=r"it is a pointer of Git LFS; .*git lfs pull"):
        read_arrays(path, "HybridModel", ("a",))


def test_a_shape_model_of_another_version_says_so(tmp_path: Path) -> None:
    path = tmp_path / "shape.npz"
    np.savez(path, skinnet_shape_model=np.array("2"))
    with pytest.raises(InputError, match=r"has version 2, .*reads version 1; .*-U skinnet"):
        load_shape_model(path)


def test_a_stack_of_another_version_says_so(tmp_path: Path) -> None:
    (tmp_path / "stack.json").write_text(json.dumps({"format": 2, "skinnet": "7.1"}))
    with pytest.raises(InputError, match=r"stack of format 2, .*skinnet 7\.1 .*-U skinnet"):
        open_stack(tmp_path)
