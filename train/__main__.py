"""`python -m train`."""

import os
import sys

# Set before torch starts its threads: threads that spin while they wait slow a busy machine.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")


def run() -> int:
    """Run the training command, or print a sentence if the extra is missing."""
    try:
        from train.cli import main
    except ModuleNotFoundError as error:
        from skinnet.errors import _explain_missing

        sentence = _explain_missing(error, "train", "python -m train", '-e ".[train]"')
        print(f"train: {sentence}", file=sys.stderr)
        return 2
    return main()


if __name__ == "__main__":
    sys.exit(run())
