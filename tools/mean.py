"""The mean of the weights of two checkpoints of one run, or of runs that follow each other.

    python -m tools.mean EARLIER.ckpt LATER.ckpt -o MEAN.ckpt

Near the end of a run weights wander around a minimum, and their mean lies closer to it (Izmailov
et al. 2018). The result exports as any checkpoint does; training does not go on with it.
"""

import argparse
import sys
from pathlib import Path
from typing import Any

import torch
from torch import Tensor

from skinnet.errors import InputError
from skinnet.files import write_atomically
from skinnet.network.checkpoint import checkpoint_of, load_checkpoint


def mean(earlier: Path, later: Path) -> dict[str, Any]:
    """A checkpoint of the mean weights and of what both were trained on."""
    (first, _), (last, trained_on) = load_checkpoint(earlier), load_checkpoint(later)
    if first.config != last.config:
        raise InputError(f"{earlier} and {later} hold models of different shape; give two of one.")
    before, state = first.state_dict(), last.state_dict()
    if all(torch.equal(one, state[name]) for name, one in before.items()):
        raise InputError(f"{earlier} and {later} hold the same weights; give two different ones.")
    last.load_state_dict({name: _between(before[name], one) for name, one in state.items()})
    return checkpoint_of(last, f"{trained_on}; mean with the weights of an earlier end")


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
        if not given.output.parent.is_dir():
            raise InputError(f"{given.output.parent} is not a folder; make it first.")
        checkpoint = mean(given.earlier, given.later)
        with write_atomically(given.output) as path:
            torch.save(checkpoint, path)
    except (InputError, OSError) as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
