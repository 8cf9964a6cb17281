"""Two real scans through the classic pipeline: fit, warp, inversion, edit, rendering.

`python -m examples.scans DATA [-o FOLDER]`, where DATA holds scans/lps (Lee Perry-Smith,
Infinite-Realities, CC BY 3.0), scans/james (menpo3d, BSD-3) and models/ict_facekit.npz
(USC ICT, MIT). It prints each command and runs it. The pictures show real people and stay out of
the project.
"""

import argparse
import shlex
import sys
from pathlib import Path

from skinnet.cli import main as skinnet

WHITE = ["--colour.white", "[150, 187, 157]"]
"""Colour of the shaded collar of James' white shirt; his texture is not white-balanced."""


def run(*words: object) -> None:
    """Print a command and run it."""
    arguments = [str(word) for word in words]
    print("$ skinnet", shlex.join(arguments), flush=True)
    code = skinnet(arguments)
    if code:
        sys.exit(code)


def main() -> None:
    """Make maps of both scans, then the edits of Figure 6, seen a little from the side."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path("runs/scans"))
    options = parser.parse_args()
    model = ["--model", options.data / "models/ict_facekit.npz", "-o", options.output]
    run("maps", options.data / "scans/lps/head.obj", *model)
    run("maps", options.data / "scans/james/james.obj", *model, *WHITE)
    for name, change in {"head": ["--hemoglobin", 2], "james": ["--melanin", 1.5]}.items():
        run("edit-maps", options.output / f"{name}_maps.npz", *change, "--relight.yaw", 20)


if __name__ == "__main__":
    main()
