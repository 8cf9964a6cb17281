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
        print(f'train needs {error.name}: pip install -e ".[train]"', file=sys.stderr)
        return 2
    return main()


if __name__ == "__main__":
    sys.exit(run())
