"""`python -m train`."""

import os
import sys

# Set before torch starts its threads: threads that spin while they wait slow a busy machine.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")


def run() -> int:
    """Run the training command or print its help; without the extra, print a sentence."""
    from skinnet.errors import InputError
    from train.usage import answer

    try:
        text = answer(sys.argv[1:])
    except InputError as error:
        print(f"train: {error}", file=sys.stderr)
        return 2
    if text is not None:
        print(text)
        return 0
    try:
        from train.cli import main
    except ModuleNotFoundError as error:
        print(f'train needs {error.name}: pip install -e ".[train]"', file=sys.stderr)
        return 2
    return main()


if __name__ == "__main__":
    sys.exit(run())
