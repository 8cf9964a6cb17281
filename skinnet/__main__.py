"""The `skinnet` command: `python -m skinnet` and the script that is installed."""

import os
import signal
import sys


def run() -> int:
    """Run the command; until its modules are imported, Ctrl-C ends it without a word."""
    usual = signal.getsignal(signal.SIGINT)
    if usual is signal.default_int_handler:
        signal.signal(signal.SIGINT, lambda *_: os._exit(130))
    from skinnet.cli import main

    try:
        signal.signal(signal.SIGINT, usual)
        return main()
    except KeyboardInterrupt:  # before or after `main` itself
        return 130


if __name__ == "__main__":
    sys.exit(run())
