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

from examples._command import run as run_command
from skinnet.cli import main as skinnet
from skinnet.pipeline._output import SCAN_ENDS
from skinnet.pipeline._source import Source, choose_folder

WHITE = ["--colour.white", "[150, 187, 157]"]
"""Colour of the shaded collar of James' white shirt; his texture is not white-balanced."""


def run(*words: object) -> None:
    """Print a command and run it."""
    arguments = [str(word) for word in words]
    print("$ skinnet", shlex.join(arguments), flush=True)
    code = skinnet(arguments)
    if code:
        sys.exit(code)


def main(arguments: list[str] | None = None) -> int:
    """Make maps of both scans, then their edits; return 2 for bad input."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("data", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path("runs/scans"))
    options = parser.parse_args(arguments)
    return run_command(lambda: study(options.data, options.output))


def study(data: Path, output: Path) -> None:
    """Make maps of both scans, then the edits of Figure 6, seen a little from the side."""
    head, james = data / "scans/lps/head.obj", data / "scans/james/james.obj"
    for scan in (head, james):
        # Where a name is taken, the maps would get a number, and the edits would miss them.
        names = [f"{scan.stem}{end}" for end in SCAN_ENDS]
        choose_folder(output, output, names, Source.read([scan]))
    model = ["--shape", data / "models/ict_facekit.npz", "-o", output]
    run("maps", head, *model)
    run("maps", james, *model, *WHITE)
    for name, change in {"head": ["--hemoglobin", 2], "james": ["--melanin", 1.5]}.items():
        run("edit-maps", output / f"{name}_maps.npz", *change, "--relight.yaw", 20)


if __name__ == "__main__":
    sys.exit(main())
