"""The mean of the weights of two checkpoints of one run, or of runs that follow each other.

    python -m tools.mean EARLIER.ckpt LATER.ckpt -o MEAN.ckpt

Near the end of a run, weights move around a minimum, and their mean lies closer to it (Izmailov et
al. 2018). The result can be exported as any checkpoint; training cannot continue from it.
"""

import argparse
import sys
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from skinnet.errors import InputError
from skinnet.files import write_atomically
from skinnet.network import SkinAutoencoder


def average(earlier: Path, later: Path) -> dict[str, Any]:
    """Make a checkpoint of the mean weights; its training data are those of the later one.

    Raises:
        InputError: for files without a model, and for models of different shape or equal weights.
    """
    first, last = (SkinAutoencoder.from_pretrained(path) for path in (earlier, later))
    if first.config != last.config:
        raise InputError(f"{earlier} and {later} hold models of different shape; give two of one.")
    before, state = first.state_dict(), last.state_dict()
    if all(torch.equal(one, state[name]) for name, one in before.items()):
        raise InputError(f"{earlier} and {later} hold the same weights; give two different ones.")
    last.load_state_dict({name: _halfway(before[name], one) for name, one in state.items()})
    last.trained_on += "; mean with the weights of an earlier end"
    return last.make_checkpoint()


def _halfway(a: Tensor, b: Tensor) -> Tensor:
    return (a + b) / 2 if b.is_floating_point() else b


def _check_output(output: Path, checkpoint: dict[str, Any]) -> None:
    """Refuse to replace a file that does not hold these weights already."""
    if not output.exists():
        return
    try:
        state = SkinAutoencoder.from_pretrained(output).make_checkpoint()["state_dict"]
    except InputError:
        state = {}
    new = checkpoint["state_dict"]
    if state.keys() != new.keys() or not all(torch.equal(state[key], new[key]) for key in new):
        raise InputError(
            f"{output} is there already and is not this mean; give another name with -o, or move "
            "it away."
        )


def main(arguments: list[str] | None = None) -> int:
    """Write the mean; return 2 for input that cannot be used."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("earlier", type=Path)
    parser.add_argument("later", type=Path)
    parser.add_argument("-o", "--output", type=Path, required=True)
    given = parser.parse_args(arguments)
    try:
        if not given.output.parent.is_dir():
            raise InputError(f"{given.output.parent} is not a folder; make it first.")
        checkpoint = average(given.earlier, given.later)
        _check_output(given.output, checkpoint)
        with write_atomically(given.output) as path:
            torch.save(checkpoint, path)
    except (InputError, OSError) as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
