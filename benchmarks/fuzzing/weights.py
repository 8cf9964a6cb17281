"""Weights in safetensors: damaged, and with headers that state something else."""

import json
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

import torch
from safetensors.torch import load, save

from benchmarks.fuzzing.case import Case
from benchmarks.fuzzing.changes import EXTREME_VALUES, change_bytes, change_value
from skinnet.network import AutoencoderConfig, SkinAutoencoder

_DTYPES = ("F16", "BF16", "F32", "F64", "I64", "U8", "BOOL", "F8_E4M3", "F4", "C64", "", "X")


def make(rng: Random) -> Case:
    """Make weights, which are loaded and run."""
    change = rng.choice((_change_header, _change_header, change_bytes, _change_state))
    return Case(load_and_run("a.safetensors"), {"a.safetensors": change(make_weights(), rng)})


def load_and_run(name: str) -> Any:
    """An action that loads a model of that name, and runs it."""

    def run(folder: Path) -> None:
        model = SkinAutoencoder.from_pretrained(folder / name).eval()
        with torch.no_grad():
            reading, image = model(torch.full((1, 3, 16, 16), 0.5))[:2]
        assert reading is not None and image is not None

    return run


@cache
def make_model() -> SkinAutoencoder:
    """A small network with random weights."""
    torch.manual_seed(0)
    return SkinAutoencoder(AutoencoderConfig(widths=(4, 6, 8), working_size=32))


@cache
def make_weights() -> bytes:
    """The file of the small network."""
    from tempfile import TemporaryDirectory

    with TemporaryDirectory() as folder:
        path = Path(folder, "a.safetensors")
        make_model().save_pretrained(path)
        return path.read_bytes()


def change_tensors(state: dict[str, Any], rng: Random) -> dict[str, Any]:
    """Change a tensor of a state: its values, type, shape, or that it is there."""
    name, changed = rng.choice(list(state)), dict(state)
    value = state[name]
    match rng.randrange(9):
        case 0:
            del changed[name]
        case 1:
            changed[rng.choice(("x", "encoder.x", name + "x"))] = value
        case 2:
            changed[name] = state[rng.choice(list(state))]
        case 3:
            changed[name] = value.to(
                rng.choice((torch.float16, torch.float64, torch.int64, torch.bool))
            )
        case 4:
            changed[name] = value.flatten()
        case 5:
            changed[name] = value[..., :0] if value.ndim else value.reshape(1, 1)
        case 6:
            changed[name] = torch.full_like(value, rng.choice((0, 1, -1, 7)))
        case _:
            changed[name] = _set_number(value, rng)
    return changed


def _set_number(value: torch.Tensor, rng: Random) -> torch.Tensor:
    if not value.is_floating_point():
        return value
    flat = value.detach().clone().flatten()
    number = rng.choice((float("nan"), float("inf"), -1e38, 1e30, 1e5, 1e4, -1e4, 100.0, -1.0, 0.0))
    flat[slice(None) if rng.random() < 0.4 else rng.randrange(max(len(flat), 1))] = number
    return flat.reshape(value.shape)


def _change_state(data: bytes, rng: Random) -> bytes:
    (length,) = (int.from_bytes(data[:8], "little"),)
    metadata = json.loads(data[8 : 8 + length])["__metadata__"]
    state = change_tensors(load(data), rng)
    return save({name: each.contiguous().clone() for name, each in state.items()}, metadata)


def _change_header(data: bytes, rng: Random) -> bytes:
    length = int.from_bytes(data[:8], "little")
    header = json.loads(data[8 : 8 + length])
    for _ in range(rng.choice((1, 1, 2))):
        header = _change_entry(header, rng)
    text = json.dumps(header).encode()
    stated = rng.choice((len(text),) * 20 + (0, 2**63, len(data), len(text) + 1))
    return stated.to_bytes(8, "little") + text + data[8 + length :]


def _change_entry(header: dict[str, Any], rng: Random) -> Any:
    """Change what the header states of a tensor, or of the model."""
    if rng.random() < 0.4 and isinstance(header.get("__metadata__"), dict):
        metadata = dict(header["__metadata__"])
        name = rng.choice(("skinnet.config", *metadata))
        metadata[name] = _change_text_entry(metadata.get(name), rng)
        return {**header, "__metadata__": metadata}
    name = rng.choice(list(header))
    entry = header[name]
    if isinstance(entry, dict) and "dtype" in entry and rng.random() < 0.8:
        key = rng.choice(("dtype", "shape", "data_offsets"))
        new = rng.choice(_DTYPES) if key == "dtype" else change_value(entry[key], rng)
        return {**header, name: {**entry, key: new}}
    return change_value(header, rng)


def _change_text_entry(text: Any, rng: Random) -> Any:
    try:
        return json.dumps(change_value(json.loads(text), rng))
    except (ValueError, TypeError):
        return rng.choice(("", "x", "4", "99", "-1", *(str(each) for each in EXTREME_VALUES[:20])))
