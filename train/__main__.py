"""`python -m train`."""

import os
import sys

# Read when torch starts its threads. Waiting threads that spin stop each other on a busy machine.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")


def run() -> int:
    """The training command, or a sentence if the extra is missing."""
    try:
        from train.cli import main
    except ModuleNotFoundError as error:
        print(f'train needs {error.name}: pip install -e ".[train]"', file=sys.stderr)
        return 2
    return main()


if __name__ == "__main__":
    sys.exit(run())
