"""Real portraits: how well they are rebuilt, how firmly they are read, and in what order.

Nobody knows their pigments. What is known: the photograph itself, that a face keeps its pigments
when its picture is made brighter, warmer or smaller, and, of the London set, a grey wall by which
the skin's colour can be measured.
"""

import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.stats import spearmanr

from benchmarks.disturbances import DISTURBANCES, UNDONE
from benchmarks.reader import Reader, composed, resized
from benchmarks.report import Results
from benchmarks.running_statistics import RunningStatistics
from benchmarks.scene import under_daylight
from benchmarks.typology import GROUPS, group, typology_angle
from skinnet.images import find_face, frame_head, read_photo, resize, segment_skin, srgb_to_linear
from skinnet.network.autoencoder import SkinMaps
from skinnet.physics import SkinDecoder

LARGEST = 256
"""Longest side of the crops, in pixels; smaller ones are left as they are."""

EVERY = 20
"""Of the Congress portraits, one in so many is disturbed; of the London ones, all."""

FEWEST = 50
"""Pixels of skin below which a portrait says nothing."""

WALL = (slice(0.02, 0.20), slice(0.02, 0.12))
"""Rows and columns, as shares of the picture, of wall on its left; the same on its right."""

PIGMENTS = ("melanin", "hemoglobin")


class Portrait(NamedTuple):
    """A crop, uint8 sRGB [height, width, 3], where `segment_skin` sees skin in it, and the median
    linear RGB of skin and wall in the whole photograph."""

    crop: NDArray[np.uint8]
    skin: NDArray[np.bool_]
    colour: NDArray[np.float32]
    wall: NDArray[np.float32]


def portraits(paths: Sequence[Path]) -> Iterator[Portrait]:
    """Those of the photographs in which a face is found."""
    for number, path in enumerate(paths, 1):
        if (one := portrait(read_photo(path))) is not None:
            yield one
        print(f"\rPortraits of {path.parent.name}: {number:,}. ", end="", file=sys.stderr)
    print(file=sys.stderr)


def portrait(photo: NDArray[np.uint8]) -> Portrait | None:
    """The square around the face, as `train.portraits` cuts it out, at `LARGEST` pixels."""
    if (face := find_face(photo)) is None:
        return None
    box = frame_head(face, photo.shape[1], photo.shape[0])
    crop, mask = photo[box.slices], segment_skin(photo, face)[box.slices]
    # Without any skin the whole crop's colour, which nobody asks for.
    colour = np.median(srgb_to_linear(crop[mask >= min(0.5, mask.max())]), 0)
    scale = min(1.0, LARGEST / max(box.width, box.height))
    sides = round(box.width * scale), round(box.height * scale)
    return Portrait(resize(crop, *sides), resize(mask, *sides) > 0.5, colour, wall(photo))


def held_out(count: int) -> set[int]:
    """Places of the portraits that `train.portraits` keeps for validation, by its defaults."""
    order = np.random.default_rng(0).permutation(count)
    return set(order[: max(1, round(0.1 * count))].tolist())


def wall(photo: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Median linear RGB of what is beside the head, near the upper corners."""
    rows, columns = (
        slice(round(part.start * side), round(part.stop * side))
        for part, side in zip(WALL, photo.shape[:2], strict=True)
    )
    both = np.concatenate([photo[rows, columns], photo[:, ::-1][rows, columns]])
    return np.median(srgb_to_linear(both.reshape(-1, 3)), 0).astype(np.float32)


def measure_portraits(
    folder: Path, reader: Reader, decoder: SkinDecoder, every: int = 1
) -> Results:
    """Every figure; `every` takes only one picture in so many.

    `congress_held_out` is what stage 2 did not see if it was trained on the Congress portraits by
    the defaults of `train.portraits`; only with all pictures are these known.
    """
    errors: dict[str, list[RunningStatistics]] = {}
    bare: list[RunningStatistics] = []
    changes: dict[str, list[list[float]]] = {name: [] for name in DISTURBANCES}
    measured: list[tuple[Portrait, list[float]]] = []
    for kind in ("congress", "london"):
        errors[kind] = []
        found = portraits(sorted((folder / kind).glob("*.jpg"))[::every])
        for number, one in enumerate(found):
            maps, capture = reader(one.crop)
            made = composed(maps, capture, decoder)
            errors[kind].append(rebuilt(one, made.image))
            bare.append(rebuilt(one, made.explained))
            if kind == "london" or number % EVERY == 0:
                for name, change in relative_changes(one.crop, maps, reader).items():
                    changes[name].append(change)
            if kind == "london":
                measured.append((one, means(maps, maps.mask > 0.5)))
    kept = held_out(len(errors["congress"])) if every == 1 and errors["congress"] else set()
    sets = {**errors, "congress_held_out": [errors["congress"][place] for place in kept]}
    return {
        "reconstruction": pooled(errors["congress"] + errors["london"]).rmse,
        "stability": {name: medians(some) for name, some in changes.items()},
        "ita_rank": ita_rank([(one, melanin) for one, (melanin, _) in measured]),
        "typology": by_tone(measured, decoder),
        "explained": pooled(bare).rmse,
        "reconstruction_by_set": {name: pooled(some).rmse for name, some in sets.items()},
        "count": {
            **{name: len(some) for name, some in sets.items()},
            "disturbed": len(changes["mirror"]),
        },
    }


def rebuilt(one: Portrait, image: torch.Tensor) -> RunningStatistics:
    """Errors on the skin of a portrait, in linear RGB."""
    linear, skin = torch.from_numpy(srgb_to_linear(one.crop)), torch.from_numpy(one.skin)
    moments = RunningStatistics()
    moments.add(image[0].movedim(0, -1)[skin], linear[skin])
    return moments


def pooled(parts: Iterable[RunningStatistics]) -> RunningStatistics:
    """Of all pixels of several pictures."""
    whole = RunningStatistics()
    for part in parts:
        whole.sums += part.sums
    return whole


def means(maps: SkinMaps, skin: torch.Tensor) -> list[float]:
    """Mean melanin and hemoglobin over skin; NaN where there is none."""
    enough = skin.sum() >= FEWEST
    return [
        getattr(maps, name)[skin].double().mean().item() if enough else np.nan for name in PIGMENTS
    ]


def relative_changes(
    crop: NDArray[np.uint8], maps: SkinMaps, reader: Reader
) -> dict[str, list[float]]:
    """By how much each disturbance changes both means, over the skin seen without it."""
    skin = maps.mask > 0.5
    before = means(maps, skin)
    found = {}
    for name, disturb in DISTURBANCES.items():
        disturbed, _ = reader(disturb(crop))
        if name in UNDONE:
            disturbed = SkinMaps(*(one.flip(-1) for one in disturbed))
        after = means(resized(disturbed, *crop.shape[:2]), skin)
        found[name] = [abs(b / a - 1) for a, b in zip(before, after, strict=True)]
    return found


def medians(changes: list[list[float]]) -> dict[str, float | None]:
    """Over portraits, leaving out those without skin."""
    usable = np.array([one for one in changes if np.isfinite(one).all()])
    if not len(usable):
        return dict.fromkeys(PIGMENTS)
    return dict(zip(PIGMENTS, np.median(usable, 0).tolist(), strict=True))


def ita_rank(measured: list[tuple[Portrait, float]]) -> float | None:
    """Spearman's correlation of mean melanin with the typology angle measured by the wall."""
    usable = [(one, melanin) for one, melanin in measured if np.isfinite(melanin)]
    if len(usable) < 3 or len({melanin for _, melanin in usable}) == 1:
        return None
    angles = wall_angles([one for one, _ in usable])
    return float(spearmanr([melanin for _, melanin in usable], angles.numpy()).statistic)


def by_tone(measured: list[tuple[Portrait, list[float]]], decoder: SkinDecoder) -> Results:
    """Of each skin tone how many portraits, and means of melanin, of the angle measured by the wall
    and of that of skin with the mean pigments, without gloss, under D65.

    Dark skin read as pale skin in little light shows here, where a rank may not.
    """
    usable = [(one, pigments) for one, pigments in measured if np.isfinite(pigments).all()]
    if not usable:
        return {}
    angles = wall_angles([one for one, _ in usable])
    pigments = torch.tensor([pigments for _, pigments in usable], dtype=torch.float32)
    read = typology_angle(under_daylight(*pigments.unbind(1), decoder))
    tones = [group(angle) for angle in angles.tolist()]
    found: Results = {}
    for name in sorted(set(tones), key=list(GROUPS).index):
        mine = torch.tensor([tone == name for tone in tones])
        found[name] = {
            "portraits": int(mine.sum()),
            "melanin": float(pigments[mine, 0].mean()),
            "angle_by_wall": float(angles[mine].mean()),
            "angle_of_skin": float(read[mine].mean()),
        }
    return found


def wall_angles(some: Sequence[Portrait]) -> torch.Tensor:
    """Typology angles [portraits] in degrees, measured by the wall.

    Each portrait's light is divided by its wall's; the wall keeps its median luminance.
    """
    walls, colours = (np.stack([getattr(one, name) for one in some]) for name in ("wall", "colour"))
    grey = np.median(walls @ [0.2126, 0.7152, 0.0722])
    return typology_angle(torch.from_numpy(colours / walls * grey))
