"""Checkpoints of training: damaged archives, and states of other networks and programs."""

import io
import pickle
import zipfile
from functools import cache
from random import Random
from typing import Any

import torch

from benchmarks.fuzzing.case import Case
from benchmarks.fuzzing.changes import EXTREME_VALUES, change_bytes, change_value
from benchmarks.fuzzing.weights import change_tensors, load_and_run, make_model


def make(rng: Random) -> Case:
    """Make a checkpoint, which is loaded as a model that is run."""
    change = rng.choice((_change_content, _change_content, _change_members, change_bytes))
    if change is _change_content:
        return Case(load_and_run("a.ckpt"), {"a.ckpt": _save(_change_content(rng))}, "content")
    return Case(load_and_run("a.ckpt"), {"a.ckpt": change(_make_file(), rng)}, "file")


@cache
def _make_file() -> bytes:
    return _save(_make_content())


def _make_content() -> dict[str, Any]:
    """What training writes: the model, and how far training has come."""
    checkpoint = make_model().make_checkpoint()
    optimiser = {"state": {0: {"step": torch.tensor(3.0), "exp_avg": torch.zeros(4)}}}
    training = {"epoch": 1, "global_step": 3, "optimizer_states": [optimiser], "loops": {}}
    return {**checkpoint, **training, "pytorch-lightning_version": "2.6.6"}


def _save(content: Any) -> bytes:
    file = io.BytesIO()
    torch.save(content, file)
    return file.getvalue()


def _change_content(rng: Random) -> Any:
    content = _make_content()
    for _ in range(rng.choice((1, 1, 2))):
        match rng.randrange(8):
            case 0 | 1 | 2:
                content["state_dict"] = change_tensors(content["state_dict"], rng)
            case 3 | 4 | 5:
                content["skinnet"] = change_value(content["skinnet"], rng)
            case 6:
                content[rng.choice(list(content))] = rng.choice(EXTREME_VALUES)
            case _:
                content["state_dict"] = {
                    **content["state_dict"],
                    "model.x": rng.choice(
                        (
                            torch.zeros(2).to_sparse(),
                            torch.nn.Parameter(torch.ones(2)),
                            "x",
                            None,
                            1.5,
                        )
                    ),
                }
        if not isinstance(content.get("state_dict"), dict) or not content["state_dict"]:
            return content
    return content if rng.random() < 0.95 else rng.choice((content["state_dict"], [content], None))


def _change_members(data: bytes, rng: Random) -> bytes:
    """Change members of the archive, above all its pickle."""
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        members = {each: archive.read(each) for each in archive.namelist()}
    pickles = [name for name in members if name.endswith("data.pkl")]
    name = rng.choice((*pickles, *pickles, *members))
    match rng.randrange(6):
        case 0:
            del members[name]
        case 1:
            members[name] = b""
        case 2:
            members[name] = pickle.dumps(rng.choice((print, {"skinnet": {}}, [], Random)), 2)
        case 3:
            members[name] = members[name].replace(
                b"FloatStorage", rng.choice((b"LongStorage", b"HalfStorage", b"x"))
            )
        case _:
            members[name] = change_bytes(members[name], rng)
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w") as archive:
        for each, content in members.items():
            archive.writestr(zipfile.ZipInfo(each), content)
    return file.getvalue()
