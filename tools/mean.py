"""The mean of the weights of two checkpoints of one run, or of runs that follow each other.

    python -m tools.mean EARLIER.ckpt LATER.ckpt -o MEAN.ckpt

Near the end of a run weights wander around a minimum, and their mean lies closer to it (Izmailov
et al. 2018). The result exports as any checkpoint does; training does not go on with it.
"""

import argparse
import sys
from pathlib import Path

import torch
from torch import Tensor

from skinnet.checkpoint import read_checkpoint
from skinnet.errors import InputError
from skinnet.files import atomic


def mean(earlier: Path, later: Path) -> dict[str, object]:
    """A checkpoint of the mean weights and of what both were trained on."""
    first, last = read_checkpoint(earlier), read_checkpoint(later)
    before, state = first["state_dict"], last["state_dict"]
    if {name: one.shape for name, one in before.items()} != {
        name: one.shape for name, one in state.items()
    }:
        raise InputError(f"{earlier} and {later} hold models of different shape; give two of one.")
    if all(torch.equal(one, state[name]) for name, one in before.items()):
        raise InputError(f"{earlier} and {later} hold the same weights; give two different ones.")
    note = last["skinnet"] | {
        "trained_on": f"{last['skinnet']['trained_on']}; mean with the weights of an earlier end"
    }
    averaged = {name: _between(before[name], one) for name, one in state.items()}
    return {"skinnet": note, "state_dict": averaged}


def _between(a: Tensor, b: Tensor) -> Tensor:
    return (a + b) / 2 if b.is_floating_point() else b


def main(arguments: list[str] | None = None) -> int:
    """Write the mean; 2 for input that it cannot use."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("earlier", type=Path)
    parser.add_argument("later", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True)
    given = parser.parse_args(arguments)
    try:
        checkpoint = mean(given.earlier, given.later)
        with atomic(given.output) as path:
            torch.save(checkpoint, path)
    except (InputError, OSError) as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
