"""`python -m train`."""

import sys


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
