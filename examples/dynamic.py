"""Blood of three faces over time: rest, smile, frown, flush and pallor, and an animation.

    python -m examples.dynamic --ict ict_facekit.npz [-o docs/figures/dynamic.png] [--size 320]
    python -m examples.dynamic --ict ict_facekit.npz --animation face.mp4 [--track clip_track.csv]
    python -m examples.dynamic --photo photo.jpg --animation photo.mp4 [--track clip_track.csv]

The faces are renders of the project's own, and the blood is that of the dynamic model. In the
animation a face smiles, blushes and turns pale; with the table of `skinnet track`, its blood is
that of the person in the video. A photograph takes that blood too, with its own expression. The
animation is an MP4, or a folder of PNG files if its name has no ending. Without the file that
`python -m tools.ict_facekit` makes of a checkout of ICT-FaceKit, the heads are procedural, and
expressions bend their picture.
"""

import argparse
import sys
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from examples._command import check_number, check_picture, run, write_picture
from examples._living_face import LivingFace
from examples._portraits import Sitter
from examples.strip import SITTERS
from skinnet.appearance import BloodSequence, DynamicModel
from skinnet.errors import InputError
from skinnet.files import make_folder
from skinnet.images import read_picture
from skinnet.inference import Decomposer
from skinnet.inference._tiles import draw_grid, draw_picture

TARGET = Path("docs/figures/dynamic.png")
COLUMNS = {
    "at rest": ({}, {}),
    "smile": ({"smile": 1.0}, {"smile": 1.0}),
    "frown": ({"frown": 1.0}, {"frown": 1.0}),
    "flush 0.7": ({}, {"flush": 0.7}),
    "pallor 0.7": ({}, {"pallor": 0.7}),
}
"""Expression and blood of each column."""

RATE, SECONDS = 12.0, 12.0
"""Frames a second, and length of the animation."""

_STEPS = 5
"""Stages of an expression that are cast; those between are the nearest."""

_COURSES = {
    "smile": ((0.5, 1.2, 4.5, 6.0), 1.0),
    "flush": ((1.5, 2.0, 5.0, 6.0), 0.9),
    "pallor": ((7.0, 8.0, 11.0, 12.0), 0.8),
}
"""Seconds at which each cause begins, is complete, begins to end and has ended; and its amount."""

_TRACKED = ("flush", "pallor", "pulse")

Draw = Callable[[float, Mapping[str, float]], NDArray[np.uint8]]
Frames = Iterator[tuple[float, NDArray[np.uint8]]]


def draw_figure(size: int, ict: Path | None) -> NDArray[np.uint8]:
    """Draw the figure, with a row for each person."""
    model, tiles = DynamicModel.load(), []
    for sitter in SITTERS:
        face = LivingFace(sitter, size, ict, model)
        for name, (expression, blood) in COLUMNS.items():
            tiles.append(draw_picture(f"{sitter.name}, {name}", face.render(expression, blood)))
    return draw_grid(tiles, len(COLUMNS))


def animate(draw: Draw, table: Path | None) -> Frames:
    """Draw the frames of the animation, each with its time in seconds.

    Args:
        draw: Draws a frame, given how much it smiles and the amounts of blood.
        table: The table of `skinnet track` whose blood is played; None: that of the animation.
    """
    model = DynamicModel.load()
    if table is None:
        times = np.arange(round(RATE * SECONDS)) / RATE
        causes = {name: _ramp(times, *course) for name, course in _COURSES.items()}
        blood = model.follow(causes | {"pulse": np.ones(len(times))}, times)
        smile = causes["smile"]
    else:
        sequence = BloodSequence.from_track(table)
        times, smile = sequence.times, np.zeros(len(sequence.times))
        blood = model.explain(sequence, _TRACKED)
    for frame, time in enumerate(times.tolist()):
        amounts = {name: float(values[frame]) for name, values in blood.items()}
        yield time, draw(round(_STEPS * float(smile[frame])) / _STEPS, amounts)


def draw_render(sitter: Sitter, size: int, ict: Path | None) -> Draw:
    """Make the function that draws frames of a rendered face."""
    face = LivingFace(sitter, size, ict, DynamicModel.load())
    return lambda smile, blood: face.render({"smile": smile}, blood)


def draw_photo(path: Path) -> Draw:
    """Make the function that draws frames of a photograph, whose expression stays."""
    model, face = DynamicModel.load(), Decomposer()(read_picture(path), detail=False)
    return lambda _, blood: face.edit(state=model.change(blood))


def write_animation(path: Path, frames: Frames) -> None:
    """Write frames as an MP4, or as PNG files in a folder.

    Raises:
        InputError: The name has another ending, or is there already.
    """
    if path.suffix not in ("", ".mp4"):
        raise InputError(
            f"{path} ends in neither .mp4 nor nothing, which is a folder of PNG files."
        )
    if path.exists():
        raise InputError(f"{path} is there already; give another name with --animation.")
    if not path.suffix:
        make_folder(path, "give another one with --animation")
        for number, (_, pixels) in enumerate(frames):
            Image.fromarray(pixels).save(path / f"{number:04d}.png")
        return
    from train.synthetic.videos.clip_files import ClipWriter

    writer = ClipWriter(path, quality=16)
    for time, pixels in frames:
        writer.add(pixels, time)
    writer.close()


def _ramp(
    times: NDArray[np.float64], corners: tuple[float, ...], amount: float
) -> NDArray[np.float64]:
    return amount * np.interp(times, corners, (0.0, 1.0, 1.0, 0.0))


def main(arguments: list[str] | None = None) -> int:
    """Draw the figure or the animation; return 2 for arguments that cannot be used."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--ict", type=Path, help="ICT-FaceKit's model as an .npz")
    parser.add_argument("-o", "--output", type=Path, default=TARGET)
    parser.add_argument("--size", type=int, default=320, help="side of the faces in pixels")
    parser.add_argument("--animation", type=Path, help="an .mp4 or a folder, instead of the figure")
    parser.add_argument("--track", type=Path, help="table of skinnet track, for the animation")
    parser.add_argument("--photo", type=Path, help="a photograph that the animation is made of")
    parser.add_argument("--person", type=int, default=0, help="0 light, 1 medium, 2 dark")
    given = parser.parse_args(arguments)

    def command() -> None:
        check_number("--size", given.size, 64, 1024)
        check_number("--person", given.person, 0, len(SITTERS) - 1)
        if given.animation is not None:
            if given.photo is None:
                draw = draw_render(SITTERS[given.person], given.size, given.ict)
            else:
                draw = draw_photo(given.photo)
            write_animation(given.animation, animate(draw, given.track))
            print(f"written: {given.animation}")
            return
        check_picture(given.output, TARGET, "dynamic")
        write_picture(given.output, draw_figure(given.size, given.ict), "dynamic")

    return run(command)


if __name__ == "__main__":
    sys.exit(main())
