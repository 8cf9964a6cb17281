"""`python -m train`."""

import os
import sys

# Set before torch starts its threads: threads that spin while they wait slow a busy machine.
os.environ.setdefault("OMP_WAIT_POLICY", "PASSIVE")


def run() -> int:
    """Run the training command or print its help; without the extra, print a sentence."""
    try:
        return _run()
    except KeyboardInterrupt:
        return 130


def _run() -> int:
    from skinnet.errors import InputError
    from skinnet.inference._messages import open_missing_streams, quit_at_interrupt

    open_missing_streams()
    try:
        with quit_at_interrupt():
            from train.usage import answer

        text = answer(sys.argv[1:])
    except InputError as error:
        print(f"train: {error}", file=sys.stderr)
        return 2
    if text is not None:
        print(text)
        return 0
    try:
        with quit_at_interrupt():
            from train.cli import main

        return main()
    except ModuleNotFoundError as error:
        from skinnet.errors import _explain_missing

        sentence = _explain_missing(error, "train", "python -m train", '-e ".[train]"')
        print(f"train: {sentence}", file=sys.stderr)
        return 2


if __name__ == "__main__":
    sys.exit(run())
