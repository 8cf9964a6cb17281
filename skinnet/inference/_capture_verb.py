"""The verb `capture`, with options that are parsed."""

import argparse
import json
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import yaml

from skinnet.errors import InputError
from skinnet.images._walk import find_one
from skinnet.inference._messages import note, print_line
from skinnet.inference._photo_verbs import _read
from skinnet.inference._references.chart import CLASSIC
from skinnet.inference._references.options import read_references
from skinnet.inference.capture_profile import CaptureProfile


def capture(options: argparse.Namespace) -> None:
    """Write the capture profile of a picture of a chart or a white reference."""
    references = read_references(options, 1)
    target: Path = options.output
    _refuse_other_file(target)
    source, picture, notes = _read(find_one(options.input))
    if references.place is None:
        profile = CaptureProfile.from_chart(picture, references.chart or CLASSIC)
    else:
        profile = CaptureProfile.from_white(picture, references.place, references.colour)
    profile.save(target)
    sentences = (*notes, *picture.notes)
    for sentence in sentences:
        note(sentence)
    if options.json:
        print_line(json.dumps(_summarise(source.name, target, sentences), allow_nan=False))
    else:
        print_line(f"{source.name}: {describe_profile(profile)}; {target}")


def _summarise(name: str, target: Path, notes: Sequence[str]) -> dict[str, Any]:
    """The content of a profile's file, and where it is from."""
    content = yaml.safe_load(target.read_text(encoding="utf-8"))
    return {"file": name, "output": str(target), "profile": content, "notes": list(notes)}


def describe_profile(profile: CaptureProfile) -> str:
    """Describe a profile in a line."""
    red, blue = profile.white_balance
    parts = [f"log R/G {red:.2f}, log B/G {blue:.2f}"]
    if profile.exposure is not None:
        parts.append(f"log luminance of white {profile.exposure:.2f}")
    for name in profile.light or ():
        parts.append(f"{profile.temperature:,.0f} K daylight" if name == "D" else f"light {name}")
    if profile.light is None and profile.delta_e is not None:
        parts.append("light and camera are not told")
    if profile.linear or profile.tone is not None:
        parts.append("linear" if profile.linear else "tone curve known")
    if profile.delta_e is not None:
        parts.append("CIEDE2000 {:.1f} in the mean, {:.1f} at most".format(*profile.delta_e))
    return ", ".join(parts)


def _refuse_other_file(target: Path) -> None:
    if target.suffix.lower() not in (".yaml", ".yml"):
        raise InputError(f"A capture profile is a .yaml file; got -o {target}.")
    if not os.path.lexists(target):
        return
    try:
        CaptureProfile.load(target)
    except InputError as error:
        raise InputError(
            f"{target} exists, and is not a capture profile; choose another file with -o."
        ) from error
