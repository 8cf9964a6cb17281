"""`python -m train`."""

import os
import sys

# Set before torch starts its threads: threads that spin while they wait slow a busy machine.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")


def run() -> int:
    """Run the training command, or print a sentence if the extra is missing."""
    from skinnet.inference._messages import open_missing_streams, quit_at_interrupt

    open_missing_streams()
    try:
        with quit_at_interrupt():
            from train.cli import main

        return main()
    except ModuleNotFoundError as error:
        from skinnet.errors import _explain_missing

        sentence = _explain_missing(error, "train", "python -m train", '-e ".[train]"')
        print(f"train: {sentence}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        return 130


if __name__ == "__main__":
    sys.exit(run())
