"""Writes clips with their truth: `python -m train.synthetic.videos -o clips --clips 6`."""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from skinnet.errors import InputError
from skinnet.files import make_folder
from train.synthetic.videos.clip_files import write_clip
from train.synthetic.videos.clip_renderer import ClipSettings
from train.synthetic.videos.clips import Clips


def main(argv: Sequence[str] | None = None) -> int:
    """Write clips as NAME.mp4 with NAME.csv beside each.

    Args:
        argv: Arguments of the command; None means those of the process.

    Returns:
        The exit code, 2 for bad input.
    """
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("-o", "--output", type=Path, default=Path("clips"))
    parser.add_argument("--clips", type=int, default=6, help="Number of clips.")
    parser.add_argument("--seconds", type=float, default=12.0, help="Length of each.")
    parser.add_argument("--size", type=int, default=320, help="Side of the frames in pixels.")
    parser.add_argument("--seed", type=int, default=0, help="The same seed gives the same clips.")
    parser.add_argument("--heads", type=int, default=64, help="Heads that the clips share.")
    parser.add_argument("--ict", help="File of ICT-FaceKit; without it all heads are procedural.")
    parser.add_argument("--geometry", default="runs/geometry", help="Folder of the heads.")
    try:
        _write_all(parser.parse_args(argv))
    except InputError as error:
        print(error, file=sys.stderr)
        return 2
    return 0


def _write_all(given: argparse.Namespace) -> None:
    if given.clips < 1 or given.heads < 1 or given.size < 64 or not 0 < given.seconds < 3600:
        raise InputError(
            "Clips need a number and heads of 1 or more, a size of 64 or more and seconds below "
            f"3600; got {given.clips}, {given.heads}, {given.size} and {given.seconds:g}."
        )
    folder = make_folder(given.output, "give another folder with -o")
    settings = ClipSettings(given.seconds, size=given.size)
    clips = Clips(
        given.clips, settings, given.seed, given.heads, ict=given.ict, geometry=given.geometry
    )
    data = clips.make_faces()
    for number in range(given.clips):
        plan = clips.plan(number)
        path = folder / f"clip_{number:03d}.mp4"
        write_clip(path, clips.make_renderer(data, plan), plan.quality)
        print(f"{path}: melanin {plan.melanin:.3f}, {plan.motion.kind}, {plan.course.kind}")


if __name__ == "__main__":
    sys.exit(main())
