"""Files of models that are damaged, of another kind or format are refused."""

import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.linear import LinearModel
from skinnet.appearance.stack import SubjectStack
from skinnet.errors import InputError


def spoilt(path: Path, change: Callable[[dict[str, Any], dict[str, Any]], None]) -> None:
    with np.load(path) as file:
        arrays: dict[str, Any] = dict(file)
    header = json.loads(str(arrays.pop("header")))
    change(header, arrays)
    np.savez(path, header=np.array(json.dumps(header)), **arrays)


def test_files_of_another_kind_or_format_are_named(stack: SubjectStack, tmp_path: Path) -> None:
    path = tmp_path / "model.npz"
    LinearModel.fit(stack).save(path)
    with pytest.raises(InputError, match="is a LinearModel, and a HybridModel is needed"):
        HybridModel.load(path)
    spoilt(path, lambda header, _: header.update(format=2))
    with pytest.raises(InputError, match="has format 2, and this skinnet reads format 1"):
        LinearModel.load(path)
    with pytest.raises(InputError, match="There is no file"):
        LinearModel.load(tmp_path / "none.npz")
    with pytest.raises(InputError, match=r"does not end in \.npz"):
        LinearModel.fit(stack).save(tmp_path / "model.npy")
    with pytest.raises(InputError, match="cannot be written"):
        LinearModel.fit(stack).save(tmp_path / "nowhere" / "model.npz")


CHANGES: list[Callable[[dict[str, Any], dict[str, Any]], object]] = [
    lambda header, _: header.pop("colour"),
    lambda header, _: header.pop("format"),
    lambda header, _: header["colour"].update(optics="none"),
    lambda header, _: header.update(total="much"),
    lambda _, arrays: arrays.pop("basis"),
    lambda _, arrays: arrays.update(basis=arrays["basis"][:, :, 1:]),
    lambda _, arrays: arrays.update(basis=arrays["basis"].astype(np.float64)),
    lambda _, arrays: arrays.update(mean=np.full_like(arrays["mean"], np.nan)),
    lambda _, arrays: arrays.update(mask=~arrays["mask"]),
    lambda _, arrays: arrays.update(mask=arrays["mask"].ravel()),
    lambda _, arrays: arrays.update(variances=np.array(["a"] * 6)),
    lambda _, arrays: arrays.update(scales=np.array([[1.0]])),
]


@pytest.mark.parametrize("change", CHANGES)
def test_damaged_files_are_refused(
    change: Callable[[dict[str, Any], dict[str, Any]], None], stack: SubjectStack, tmp_path: Path
) -> None:
    path = tmp_path / "model.npz"
    HybridModel.fit(stack).save(path)
    spoilt(path, change)
    with pytest.raises(InputError, match="is not a complete file of skinnet's"):
        HybridModel.load(path)


def test_files_cut_short_or_pickled_are_refused(stack: SubjectStack, tmp_path: Path) -> None:
    path = tmp_path / "model.npz"
    HybridModel.fit(stack).save(path)
    whole = path.read_bytes()
    np.savez(tmp_path / "pickled.npz", header=np.array({"kind": "HybridModel"}, object))
    with zipfile.ZipFile(tmp_path / "empty.npz", "w"):
        pass
    contents = [whole[: len(whole) // 2], whole[:100], b"", b"text", np.zeros(3).tobytes()]
    contents += [(tmp_path / name).read_bytes() for name in ("pickled.npz", "empty.npz")]
    flipped = bytearray(whole)
    flipped[len(whole) // 2] ^= 255
    for content in [*contents, bytes(flipped)]:
        path.write_bytes(content)
        with pytest.raises(InputError, match="is not a complete file of skinnet's"):
            HybridModel.load(path)
