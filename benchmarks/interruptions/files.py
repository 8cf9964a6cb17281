"""What lies in a folder: digests of whole files, without what differs between equal runs."""

import csv
import hashlib
import io
import re
from pathlib import Path
from typing import Any

import numpy as np
import torch

Files = dict[str, str]
"""A digest for each path in a folder."""

_EVENTS, _CURVES, _TABLE = "events.out.tfevents", "metrics.csv", "faces.csv"


def read_files(folder: Path) -> Files:
    """Read the digests of the files in a folder; hidden and growing ones are left out."""
    return {
        str(path.relative_to(folder)): digest(path)
        for path in sorted(folder.rglob("*"))
        if path.is_file() and not path.name.startswith((".", _EVENTS)) and not _grows(path)
    }


def _grows(path: Path) -> bool:
    return path.name in (_CURVES, _TABLE)


def find_partial(folder: Path) -> list[str]:
    """Find hidden files: what an interrupted process has left."""
    return [str(path) for path in folder.rglob(".*") if path.is_file()]


def digest(path: Path) -> str:
    """Compute the digest of what a file holds; `damaged` if it is not whole."""
    try:
        if path.suffix == ".ckpt":
            return _hash_checkpoint(path)
        if path.suffix == ".npz":
            return _hash_arrays(path)
        content = path.read_bytes()
        if path.name == "config.yaml":  # it names the checkpoint from which training goes on
            content = re.sub(rb"(?m)^ckpt_path: .*\n", b"", content)
        if path.name == "report.html":
            content = re.sub(rb"[\d.e+]+ per second", b"", content)
        return hashlib.sha256(content).hexdigest()
    except (OSError, ValueError, RuntimeError, EOFError):
        return "damaged"


def _hash_arrays(path: Path) -> str:
    """The digest of arrays: archives have the time of their making."""
    found = hashlib.sha256()
    with np.load(path) as arrays:
        for name in sorted(arrays.files):
            found.update(name.encode() + arrays[name].tobytes())
    return found.hexdigest()


def _hash_checkpoint(path: Path) -> str:
    """The digest of weights, steps and the state of the optimizer."""
    held = torch.load(path, weights_only=True, map_location="cpu")
    found = hashlib.sha256(str(held["global_step"]).encode())
    for value in _list_tensors([held["state_dict"], held["optimizer_states"]]):
        found.update(value.contiguous().numpy().tobytes())
    return found.hexdigest()


def _list_tensors(value: Any) -> list[torch.Tensor]:
    if isinstance(value, torch.Tensor):
        return [value]
    parts = value.values() if isinstance(value, dict) else value
    return (
        [one for part in parts for one in _list_tensors(part)]
        if isinstance(value, dict | list | tuple)
        else []
    )


def read_losses(run: Path) -> dict[tuple[str, str], str]:
    """Read the curves of a run: a value for each step and metric.

    Raises:
        ValueError: A line is not whole, or a step has two values.
    """
    text = (run / _CURVES).read_text(encoding="utf-8")
    losses: dict[tuple[str, str], str] = {}
    if not text.endswith("\n"):
        raise ValueError(f"{run / _CURVES} ends in a part of a line")
    for row in list(csv.reader(io.StringIO(text)))[1:]:
        step, metric, value = row
        if losses.setdefault((step, metric), value) != value:
            raise ValueError(f"{metric} of step {step} is {losses[step, metric]} and {value}")
    return losses


def read_rows(table: Path) -> set[tuple[str, ...]]:
    """Read the rows of a table of faces.

    Raises:
        ValueError: A row is not whole.
    """
    text = table.read_text(encoding="utf-8")
    rows = list(csv.reader(io.StringIO(text)))
    if not text.endswith("\n") or any(len(row) != len(rows[0]) for row in rows):
        raise ValueError(f"{table} ends in a part of a row")
    return {tuple(row) for row in rows}
