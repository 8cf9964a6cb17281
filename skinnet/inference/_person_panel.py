"""The panel of a person: the shots, and what each of them and all of them together say."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from skinnet.inference._forest_plot import PlotRow, draw_forest_plot
from skinnet.inference._tiles import draw_grid, draw_picture
from skinnet.inference._uncertainty import PIGMENTS, describe_percent
from skinnet.inference.person import Person

_COLUMNS = 4


def draw_person(pictures: Sequence[NDArray[np.uint8]], person: Person) -> NDArray[np.uint8]:
    """Draw the shots of a person, and forest plots of the pigments by shot and by region.

    Args:
        pictures: The part of each shot that was read, uint8 sRGB [h, w, 3].
        person: What was read of them.

    Returns:
        uint8 sRGB [h, w, 3].
    """
    shots = [
        draw_picture(f"shot {number}" + (" (left out)" if session is None else ""), picture)
        for number, (picture, session) in enumerate(zip(pictures, person.sessions, strict=True), 1)
    ]
    plots = [_draw_shots(person, name) for name in PIGMENTS]
    plots += [_draw_regions(person, name) for name in PIGMENTS if person.regions]
    return np.concatenate([draw_grid(shots, _COLUMNS), draw_grid(plots, _COLUMNS)])


def _draw_shots(person: Person, pigment: str) -> Image.Image:
    rows = [
        PlotRow(
            f"shot {number}", alone["mean"], alone["interval"], int(shot["session"] is not None)
        )
        for number, shot in enumerate(person.summary()["shots"], 1)
        for alone in (shot["pigments"][pigment],)
    ]
    fused = person.pigments[pigment]
    rows.append(PlotRow("fused", fused.mean, fused.interval, 2))
    note = describe_percent(person.means[pigment], person.interval()[pigment])
    return draw_forest_plot(pigment, pigment, rows, note)


def _draw_regions(person: Person, pigment: str) -> Image.Image:
    rows = [
        PlotRow(name.replace("_", " "), one.mean, one.interval)
        for name, region in person.regions.items()
        for one in (getattr(region, pigment),)
    ]
    return draw_forest_plot(pigment, f"{pigment} by region", rows)
