"""Figures 2, 3, 6, 7 and 8 of the paper, recomputed.

    python -m examples.figures [2 3 6 7 8] [-o docs/figures] [--people 25] [--texels 512]

The first two are computed in seconds. The others need scans of people; they are made of 25
synthetic people, whom `examples.lightstage` takes through the whole pipeline into the folder
`--lightstage`. What is there already is not computed again. Figures are written as figure_N.png.
"""

import argparse
import sys
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from examples import lightstage
from examples._command import check_number, check_picture, run, write_picture
from examples._model_figures import draw_components, draw_edits, plot_measures
from examples._skin_figures import draw_colours, draw_spectra
from skinnet.errors import InputError

TARGET = Path("docs/figures")
NUMBERS = (2, 3, 6, 7, 8)
CHARTS = (2, 8)
"""Figures of lines, which a palette keeps small; colours of skin would show its steps."""

EDITED = (5, 20)
"""Numbers of the people of Figure 6, of light skin above and of medium skin below."""

Draw = Callable[[], NDArray[np.uint8]]


def plan(folder: Path, people: int, dpi: int) -> dict[int, Draw]:
    """List how each figure is drawn from the results in a folder."""
    maps = [folder / f"skinmaps/person_{number:02}_maps.npz" for number in range(people)]
    edited = [maps[number % people] for number in EDITED]
    return {
        2: partial(draw_spectra, dpi),
        3: partial(draw_colours, dpi),
        6: partial(draw_edits, edited),
        7: partial(draw_components, folder / "model", maps),
        8: partial(plot_measures, folder / "model", dpi),
    }


def draw(options: argparse.Namespace) -> None:
    """Draw and write the chosen figures."""
    check_number("people", options.people, 3, 999)
    check_number("dpi", options.dpi, 20, 600)
    numbers = options.figures or NUMBERS
    if unknown := set(numbers) - set(NUMBERS):
        raise InputError(f"Figures 2, 3, 6, 7 and 8 are recomputed; got {min(unknown)}.")
    paths = {number: options.output / f"figure_{number}.png" for number in numbers}
    for path in paths.values():
        check_picture(path, TARGET / path.name, "figures")
    if set(numbers) & {6, 7, 8}:
        lightstage.study(options.lightstage, options.people, options.texels, ["false"])
    figures = plan(options.lightstage, options.people, options.dpi)
    for number, path in paths.items():
        write_picture(path, figures[number](), "figures", palette=number in CHARTS)


def main(arguments: list[str] | None = None) -> int:
    """Draw the figures; return 2 for arguments that cannot be used."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("figures", nargs="*", type=int, metavar="N", help="their numbers; all")
    parser.add_argument("-o", "--output", type=Path, default=TARGET)
    parser.add_argument("--lightstage", type=Path, default=Path("runs/figures"))
    parser.add_argument("--people", type=int, default=25)
    parser.add_argument("--texels", type=int, default=512)
    parser.add_argument("--dpi", type=int, default=90)
    options = parser.parse_args(arguments)
    return run(lambda: draw(options))


if __name__ == "__main__":
    sys.exit(main())
