"""Real portraits: reconstruction, stability, and the order of skin tones.

Their pigments are unknown. What is known is the photograph, and that a face keeps its pigments when
its picture is made brighter, warmer or smaller. In the London set a grey wall serves as a
reference, by which the colour of skin can be measured.
"""

import sys
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import torch
from numpy.typing import NDArray
from scipy.stats import spearmanr

from benchmarks.disturbances import DISTURBANCES, MIRRORED
from benchmarks.pictures import render_under_daylight
from benchmarks.reader import Reader, compose, resize_maps
from benchmarks.report import Results
from benchmarks.running_statistics import RunningStatistics
from benchmarks.typology import GROUPS, compute_typology_angle, find_group
from skinnet.images import find_faces, frame_head, read_photo, resize, segment_skin, srgb_to_linear
from skinnet.images.faces._largest import choose_largest
from skinnet.images.srgb import LUMINANCE_WEIGHTS
from skinnet.network.autoencoder import SkinMaps
from skinnet.physics import SkinDecoder

LARGEST = 256
"""Longest side of the crops in pixels; smaller crops keep their size."""

EVERY = 20
"""Every 20th portrait of Congress is disturbed, and every portrait of London."""

FEWEST = 50
"""Pixels of skin that a portrait needs to count."""

WALL = (slice(0.02, 0.20), slice(0.02, 0.12))
"""Rows and columns of the wall on the left, as shares of the picture; the right is symmetric."""

PIGMENTS = ("melanin", "hemoglobin")


class Portrait(NamedTuple):
    """A face and what was measured in its photograph.

    Attributes:
        crop: uint8 sRGB, [height, width, 3].
        skin: Where `segment_skin` finds skin in it.
        colour: Median linear RGB of the skin.
        wall: Median linear RGB of the wall.
    """

    crop: NDArray[np.uint8]
    skin: NDArray[np.bool_]
    colour: NDArray[np.float32]
    wall: NDArray[np.float32]


def read_portraits(paths: Sequence[Path]) -> Iterator[Portrait]:
    """Yield the portraits of the photographs in which a face is found."""
    for number, path in enumerate(paths, 1):
        if (one := crop_portrait(read_photo(path))) is not None:
            yield one
        print(f"\rPortraits of {path.parent.name}: {number:,}. ", end="", file=sys.stderr)
    print(file=sys.stderr)


def crop_portrait(photo: NDArray[np.uint8]) -> Portrait | None:
    """Crop the face as `train.portraits` does, at `LARGEST` pixels; None without a face."""
    if (found := choose_largest(find_faces(photo))) is None:
        return None
    face = found.box
    box = frame_head(face, photo.shape[1], photo.shape[0])
    crop, mask = photo[box.slices], segment_skin(photo, face)[box.slices]
    # Without any skin, the colour of the whole crop, which is not used.
    colour = np.median(srgb_to_linear(crop[mask >= min(0.5, mask.max())]), 0)
    scale = min(1.0, LARGEST / max(box.width, box.height))
    sides = round(box.width * scale), round(box.height * scale)
    return Portrait(resize(crop, *sides), resize(mask, *sides) > 0.5, colour, measure_wall(photo))


def choose_held_out(count: int) -> set[int]:
    """Choose the portraits that `train.portraits` keeps for validation, by its defaults."""
    order = np.random.default_rng(0).permutation(count)
    return set(order[: max(1, round(0.1 * count))].tolist())


def measure_wall(photo: NDArray[np.uint8]) -> NDArray[np.float32]:
    """Measure the median linear RGB beside the head, near the upper corners."""
    rows, columns = (
        slice(round(part.start * side), round(part.stop * side))
        for part, side in zip(WALL, photo.shape[:2], strict=True)
    )
    both = np.concatenate([photo[rows, columns], photo[:, ::-1][rows, columns]])
    return np.median(srgb_to_linear(both.reshape(-1, 3)), 0).astype(np.float32)


def measure_portraits(
    folder: Path, reader: Reader, decoder: SkinDecoder, every: int = 1
) -> Results:
    """Measure every figure; with `every` = n, only every nth picture is used.

    `congress_held_out` are the portraits that stage 2 did not see, if it was trained on the
    Congress portraits by the defaults of `train.portraits`. They are known only if all pictures are
    used.
    """
    errors: dict[str, list[RunningStatistics]] = {}
    explained: list[RunningStatistics] = []
    changes: dict[str, list[list[float]]] = {name: [] for name in DISTURBANCES}
    measured: list[tuple[Portrait, list[float]]] = []
    for kind in ("congress", "london"):
        errors[kind] = []
        found = read_portraits(sorted((folder / kind).glob("*.jpg"))[::every])
        for number, one in enumerate(found):
            maps, capture = reader(one.crop)
            composition = compose(maps, capture, decoder)
            errors[kind].append(measure_reconstruction(one, composition.image))
            explained.append(measure_reconstruction(one, composition.explained))
            if kind == "london" or number % EVERY == 0:
                for name, change in measure_changes(one.crop, maps, reader).items():
                    changes[name].append(change)
            if kind == "london":
                measured.append((one, average_pigments(maps, maps.mask > 0.5)))
    kept = choose_held_out(len(errors["congress"])) if every == 1 and errors["congress"] else set()
    sets = {**errors, "congress_held_out": [errors["congress"][place] for place in kept]}
    return {
        "reconstruction": pool(errors["congress"] + errors["london"]).rmse,
        "stability": {name: compute_medians(some) for name, some in changes.items()},
        "ita_rank": rank_by_angle([(one, melanin) for one, (melanin, _) in measured]),
        "typology": group_by_tone(measured, decoder),
        "explained": pool(explained).rmse,
        "reconstruction_by_set": {name: pool(some).rmse for name, some in sets.items()},
        "count": {
            **{name: len(some) for name, some in sets.items()},
            "disturbed": len(changes["mirror"]),
        },
    }


def measure_reconstruction(one: Portrait, image: torch.Tensor) -> RunningStatistics:
    """Measure errors on the skin of a portrait, in linear RGB."""
    linear, skin = torch.from_numpy(srgb_to_linear(one.crop)), torch.from_numpy(one.skin)
    moments = RunningStatistics()
    moments.add(image[0].movedim(0, -1)[skin], linear[skin])
    return moments


def pool(parts: Iterable[RunningStatistics]) -> RunningStatistics:
    """Pool the statistics of several pictures."""
    whole = RunningStatistics()
    for part in parts:
        whole.sums += part.sums
    return whole


def average_pigments(maps: SkinMaps, skin: torch.Tensor) -> list[float]:
    """Average melanin and hemoglobin over skin; NaN if there is too little."""
    enough = skin.sum() >= FEWEST
    return [
        getattr(maps, name)[skin].double().mean().item() if enough else np.nan for name in PIGMENTS
    ]


def measure_changes(
    crop: NDArray[np.uint8], maps: SkinMaps, reader: Reader
) -> dict[str, list[float]]:
    """Measure how each disturbance changes both means, over the skin found without it."""
    skin = maps.mask > 0.5
    before = average_pigments(maps, skin)
    found = {}
    for name, disturb in DISTURBANCES.items():
        disturbed, _ = reader(disturb(crop))
        if name in MIRRORED:
            disturbed = SkinMaps(*(one.flip(-1) for one in disturbed))
        after = average_pigments(resize_maps(disturbed, *crop.shape[:2]), skin)
        found[name] = [abs(b / a - 1) for a, b in zip(before, after, strict=True)]
    return found


def compute_medians(changes: list[list[float]]) -> dict[str, float | None]:
    """Compute medians over portraits with skin."""
    usable = np.array([one for one in changes if np.isfinite(one).all()])
    if not len(usable):
        return dict.fromkeys(PIGMENTS)
    return dict(zip(PIGMENTS, np.median(usable, 0).tolist(), strict=True))


def rank_by_angle(measured: list[tuple[Portrait, float]]) -> float | None:
    """Correlate mean melanin with the typology angle measured by the wall (Spearman's rank)."""
    usable = [(one, melanin) for one, melanin in measured if np.isfinite(melanin)]
    if len(usable) < 3 or len({melanin for _, melanin in usable}) == 1:
        return None
    angles = compute_wall_angles([one for one, _ in usable])
    return float(spearmanr([melanin for _, melanin in usable], angles.numpy()).statistic)


def group_by_tone(measured: list[tuple[Portrait, list[float]]], decoder: SkinDecoder) -> Results:
    """Average melanin and typology angles by skin tone.

    `angle_by_wall` is measured by the wall. `angle_of_skin` is that of skin with the mean pigments,
    without specular reflection, under D65. If dark skin is read as pale skin in little light, these
    differ, although the rank may be right.
    """
    usable = [(one, pigments) for one, pigments in measured if np.isfinite(pigments).all()]
    if not usable:
        return {}
    angles = compute_wall_angles([one for one, _ in usable])
    pigments = torch.tensor([pigments for _, pigments in usable], dtype=torch.float32)
    read = compute_typology_angle(render_under_daylight(*pigments.unbind(1), decoder))
    tones = [find_group(angle) for angle in angles.tolist()]
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


def measure_wall_reflectance(some: Sequence[Portrait]) -> float:
    """Measure the median luminance of walls, which is taken for the reflectance of the wall."""
    return float(np.median(np.stack([one.wall for one in some]) @ LUMINANCE_WEIGHTS))


def compute_wall_angles(some: Sequence[Portrait]) -> torch.Tensor:
    """Compute typology angles [portraits] in degrees, relative to the wall.

    The light of each portrait is divided by that of its wall; the median luminance of walls stays.
    """
    walls, colours = (np.stack([getattr(one, name) for one in some]) for name in ("wall", "colour"))
    grey = measure_wall_reflectance(some)
    return compute_typology_angle(torch.from_numpy(colours / walls * grey))
