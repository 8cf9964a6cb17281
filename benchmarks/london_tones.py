"""London's portraits, read with nothing known and with their wall as a white reference."""

from collections.abc import Sequence

import torch

from benchmarks.portraits import (
    Portrait,
    average_pigments,
    group_by_tone,
    measure_wall_reflectance,
    rank_by_angle,
)
from benchmarks.reader import NetworkReader
from benchmarks.report import Results
from skinnet.physics import Capture, luminance


def measure_london(portraits: Sequence[Portrait], reader: NetworkReader) -> Results:
    """Measure the rank of melanin with the wall's angle, and angles by tone group, both ways."""
    return {
        "blind": _measure(portraits, reader, given=False),
        "white": _measure(portraits, reader, given=True),
    }


def know_wall(portrait: Portrait, reader: NetworkReader, reflectance: float) -> Capture:
    """Say what is known of the capture of a portrait whose wall is a grey reference."""
    wall = torch.from_numpy(portrait.wall)[None]
    exposure = torch.log(luminance(wall[..., None, None])[:, 0, 0, 0] / reflectance)
    balance = reader.model.known.find_white_balance(wall)
    return Capture(white_balance=balance, exposure=exposure)


def _measure(portraits: Sequence[Portrait], reader: NetworkReader, given: bool) -> Results:
    measured, reflectance = [], measure_wall_reflectance(portraits) if portraits else 1.0
    for one in portraits:
        known = know_wall(one, reader, reflectance) if given else None
        maps, _, _ = reader.read(one.crop, known)
        measured.append((one, average_pigments(maps, maps.mask > 0.5)))
    groups = group_by_tone(measured, reader.model.decoder)
    for tone in groups.values():
        tone["difference"] = tone["angle_of_skin"] - tone["angle_by_wall"]
    return {
        "rank": rank_by_angle([(one, melanin) for one, (melanin, _) in measured]),
        "groups": groups,
    }
