"""Encoders and decoders in ONNX: damaged, with other graphs, weights and metadata."""

import json
from functools import cache
from pathlib import Path
from random import Random

import numpy as np
from skimage.data import astronaut

from benchmarks.fuzzing.case import Case
from benchmarks.fuzzing.changes import change_bytes, change_text, change_value
from benchmarks.fuzzing.protobuf import change_message, read_fields, write_fields
from skinnet.inference import SHIPPED_ENCODER, Decomposer
from skinnet.inference._onnx_header import read_header

_METADATA = 14


def make(rng: Random) -> Case:
    """Make an encoder and a decoder, one of which is changed, and read a photograph by them."""
    files = dict(_read_shipped())
    name = rng.choice(("skin.onnx", "skin.onnx", "skin.decoder.onnx"))
    change = rng.choice(
        (change_message, change_message, change_message, _change_metadata, change_bytes)
    )
    for _ in range(rng.choice((1, 1, 1, 3))):
        files[name] = change(files[name], rng)
    if rng.random() < 0.02:
        return Case(_read_header, {"skin.onnx": rng.randbytes(200)}, "noise")
    return Case(_read_photo, files, name)


def _read_photo(folder: Path) -> None:
    decomposer = Decomposer(folder / "skin.onnx", threads=1)
    result = decomposer(_get_photo(), region="skin")
    for name in ("melanin", "hemoglobin", "shading", "mask"):
        values = getattr(result, name)
        assert np.isfinite(values).all() and values.min() >= 0, name
    assert result.melanin.max() <= 1 and result.hemoglobin.max() <= 1
    json.dumps(result.to_dict(), allow_nan=False)
    result.edit(melanin=1.3)


def _read_header(folder: Path) -> None:
    assert read_header(folder / "skin.onnx") is None


@cache
def _get_photo() -> np.ndarray:
    return np.ascontiguousarray(astronaut()[60:188:4, 170:298:4])


@cache
def _read_shipped() -> dict[str, bytes]:
    names = ("skin.onnx", "skin.decoder.onnx")
    return {name: SHIPPED_ENCODER.with_name(name).read_bytes() for name in names}


def _change_metadata(data: bytes, rng: Random) -> bytes:
    """Change an entry that skinnet writes and reads."""
    fields = read_fields(data)
    places = [at for at, (number, _, _) in enumerate(fields) if number == _METADATA]
    if not places:
        return change_bytes(data, rng)
    at = rng.choice(places)
    content = fields[at][2]
    assert isinstance(content, bytes)
    pair = {number: value for number, _, value in read_fields(content)}
    key, value = pair.get(1, b""), pair.get(2, b"")
    new = _change_entry(value if isinstance(value, bytes) else b"", rng)
    fields[at] = (_METADATA, 2, write_fields([(1, 2, key), (2, 2, new)]))
    return write_fields(fields)


def _change_entry(value: bytes, rng: Random) -> bytes:
    try:
        document = json.loads(value)
    except ValueError:
        return change_text(value, rng)
    for _ in range(rng.choice((1, 1, 2))):
        document = change_value(document, rng)
    return json.dumps(document).encode()
