"""`python -m skinnet` is the `skinnet` command."""

import sys

from skinnet.cli import main

if __name__ == "__main__":
    sys.exit(main())
