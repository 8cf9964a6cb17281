"""The change of melanin and hemoglobin between two photographs of one face."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet._version import __version__
from skinnet.errors import InputError, NoFaceError
from skinnet.images._arguments import check_text
from skinnet.images.box import Box
from skinnet.images.faces._outlines import Patch
from skinnet.images.photograph import read_picture
from skinnet.images.picture import Picture
from skinnet.inference._capture_inputs import CaptureLike
from skinnet.inference._comparison.cells import Cells, get_landmarks, sample_cells
from skinnet.inference._comparison.change_maps import (
    Canvas,
    cut,
    spread_changes,
    warp_photograph,
)
from skinnet.inference._comparison.changes import PigmentChanges, RegionChanges
from skinnet.inference._comparison.colour_derivatives import differentiate_chroma, tabulate_daylight
from skinnet.inference._comparison.estimate import Estimate, Reading, estimate_changes
from skinnet.inference._comparison.face_warp import FaceWarp
from skinnet.inference._comparison.picture import describe_change, draw_comparison
from skinnet.inference._face_choice import note_others
from skinnet.inference._image_list import ImageLike, name_image
from skinnet.inference._uncertainty import LEVEL, PIGMENTS
from skinnet.inference.decomposer import Decomposer
from skinnet.inference.decomposition import Decomposition

_LEAST_CELLS, _LEAST_REGION = 30, 2
"""Least number of cells of skin in a face, and in a region, that are compared."""

_OTHER_PERSON = math.log(3)
"""Log change of melanin beyond which two photographs surely show two people."""


@dataclass(frozen=True, eq=False, repr=False)
class Comparison:
    """The change of the skin from one photograph of a face to another one.

    Changes are natural logarithms of factors: 0 is no change, .69 twice as much, -.69 half.

    Attributes:
        face: Changes of `melanin` and `hemoglobin` over the skin that both photographs show, each
            with `log`, `sd`, 90 % `interval`, `percent` and `unchanged`; and `unchanged` for both.
        regions: Of each region of the face the same as `total`, and `against_rest`: by how much
            more than other skin it has changed, which is known better. None where too little of it
            is seen in both.
        melanin: Map of the log change of melanin, float32 [h, w]; NaN where there is none.
        hemoglobin: The same of hemoglobin.
        before: The part of the first photograph that the maps show, uint8 sRGB [h, w, 3].
        after: The second photograph, warped onto it by the face mesh.
        box: Where that part is in the first photograph.
        light: By how much log R/G and log B/G of the light and camera have changed, at the colour
            of the skin.
        other_cells: How many cells that are not skin (hair, clothes, background) were seen to be
            the same in both photographs, and told of the change of light.
        notes: Sentences that the user should read.
        names: Names of both photographs.
        model: As in `Decomposition`.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet import Decomposer
        >>> from skinnet.inference import compare_photographs
        >>> decomposer = Decomposer(threads=1)
        >>> compare_photographs(astronaut(), astronaut(), decomposer=decomposer).face.unchanged
        True
    """

    face: PigmentChanges
    regions: Mapping[str, RegionChanges | None]
    melanin: NDArray[np.float32]
    hemoglobin: NDArray[np.float32]
    before: NDArray[np.uint8]
    after: NDArray[np.uint8]
    box: Box
    light: tuple[float, float]
    other_cells: int
    notes: tuple[str, ...]
    names: tuple[str, str]
    model: Mapping[str, str]

    def __repr__(self) -> str:
        parts = (f"{name} {describe_change(getattr(self.face, name))}" for name in PIGMENTS)
        return f"<Comparison: {', '.join(parts)}>"

    def draw(self) -> NDArray[np.uint8]:
        """Draw both photographs and both maps of changes, on one colour scale.

        Beside the names of the pigments are the changes of the face with their 90 % intervals.
        Differences within a map are more certain than these.

        Returns:
            uint8 sRGB [height, width, 3].
        """
        changes = {name: (getattr(self, name), getattr(self.face, name)) for name in PIGMENTS}
        return draw_comparison(self.before, self.after, changes)

    def summary(self) -> dict[str, Any]:
        """Summarise the changes as numbers for JSON.

        Returns:
            `before` and `after` (names), `level` of the intervals, `face` and `regions` (of each
            `melanin` and `hemoglobin` with `log`, `sd`, `interval`, `percent`, `percent_interval`
            and `unchanged`, and `unchanged` for both; of regions also `against_rest`; None as in
            `regions`), `light` (log changes
            `r_over_g` and `b_over_g`), `other_cells`, `box`, `notes`, `version` and `model`.
        """
        regions = self.regions.items()
        return {
            "before": self.names[0],
            "after": self.names[1],
            "level": LEVEL,
            "face": self.face.to_json(),
            "regions": {name: each and each.to_json() for name, each in regions},
            "light": dict(
                zip(("r_over_g", "b_over_g"), (round(x, 4) for x in self.light), strict=True)
            ),
            "other_cells": self.other_cells,
            "box": self.box._asdict(),
            "notes": list(self.notes),
            "version": __version__,
            "model": dict(self.model),
        }


def compare_photographs(
    before: ImageLike,
    after: ImageLike,
    *,
    decomposer: Decomposer | None = None,
    before_capture: CaptureLike | None = None,
    after_capture: CaptureLike | None = None,
    names: tuple[str, str] | None = None,
) -> Comparison:
    """Compare the skin in two photographs of one face.

    Both are read, and warped onto each other by the points of the face mesh. The change of light
    and that of the pigments are then estimated together: skin, and what is not skin and is seen to
    be the same in both, follow one change of light and camera; skin alone follows the pigments. A
    change of the whole face is told from the light by what the network reads in each photograph,
    and is as uncertain as that; differences within the face are known much better.

    Args:
        before: A photograph as for `Decomposer`; of several faces the largest is compared.
        after: Another one of the same person, from the same side. That one of them is mirrored, as
            selfies may be, is not noticed; left and right are then exchanged.
        decomposer: What reads them; None for the shipped model.
        before_capture: What is known of the light and camera of the first, as for `Decomposer`;
            None: nothing.
        after_capture: The same of the second.
        names: Names of both in messages; the paths by default.

    Returns:
        The changes with their intervals, and their maps.

    Raises:
        InputError: A photograph cannot be read, as by `Decomposer`; the poses differ too much; too
            little skin is seen in both; or they are plainly of different people.
        NoFaceError: No face was found in one of them.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet import Decomposer
        >>> from skinnet.inference import compare_photographs
        >>> decomposer = Decomposer(threads=1)
        >>> flushed = decomposer.edit(astronaut(), hemoglobin=2.0)
        >>> compared = compare_photographs(astronaut(), flushed, decomposer=decomposer)
        >>> compared.face.hemoglobin.log > 0
        True
    """
    decomposer = Decomposer() if decomposer is None else decomposer
    if not isinstance(decomposer, Decomposer):
        raise InputError(f"decomposer is a Decomposer; got {decomposer!r:.60}.")
    pictures = [read_picture(one) for one in (before, after)]
    names = _name(before, after) if names is None else _check_names(names)
    first = _read(decomposer, pictures[0], names[0], before_capture)
    second = _read(decomposer, pictures[1], names[1], after_capture)
    return _compare(decomposer, (pictures[0].srgb, pictures[1].srgb), (first, second), names)


def _read(
    decomposer: Decomposer, picture: Picture, name: str, capture: CaptureLike | None
) -> Decomposition:
    try:
        read = decomposer(picture, name=name, detail=False, capture=capture)
    except NoFaceError as error:
        raise NoFaceError(
            f"No face was found in {name}; a comparison needs the same face in both photographs."
        ) from error
    if not read.means:
        raise InputError(f"No skin was found in {name}; give a photograph with an uncovered face.")
    return read


def _compare(
    decomposer: Decomposer,
    photos: tuple[NDArray[np.uint8], NDArray[np.uint8]],
    read: tuple[Decomposition, Decomposition],
    names: tuple[str, str],
) -> Comparison:
    warp = FaceWarp.between(get_landmarks(read[0]), get_landmarks(read[1]))
    warp.refuse_other_pose(names)
    cells = sample_cells(photos, read, warp)
    _refuse_little_skin(cells, names)
    estimate = _estimate(decomposer, cells, read)
    face = PigmentChanges.from_moments(*estimate.average(np.ones(cells.skin.sum(), bool)))
    _refuse_other_person(face, names)
    canvas = Canvas.around(read[0].box)
    melanin, hemoglobin = spread_changes(estimate.change, cells, read[0], canvas)
    return Comparison(
        face,
        _summarise_regions(estimate, cells, read[0]),
        melanin,
        hemoglobin,
        cut(photos[0], canvas),
        warp_photograph(photos[1], read[1].box, warp, canvas),
        canvas.box,
        (float(estimate.light[0]), float(estimate.light[1])),
        estimate.other_cells,
        _list_notes(read, names, estimate),
        names,
        read[0].model,
    )


def _estimate(
    decomposer: Decomposer, cells: Cells, read: tuple[Decomposition, Decomposition]
) -> Estimate:
    table = tabulate_daylight(decomposer.encoder, decomposer.decoder)
    pigments, gloss = cells.pigments[cells.skin].mean(1), cells.gloss[cells.skin]
    first, second = (np.log([one.means[name] for name in PIGMENTS]) for one in read)
    sds = np.hypot(*(np.array(one.uncertainty.face) for one in read))
    derivatives = differentiate_chroma(table, pigments, gloss)
    return estimate_changes(cells, derivatives, Reading(second - first, sds))


def _summarise_region(estimate: Estimate, chosen: NDArray[np.bool_]) -> RegionChanges:
    return RegionChanges(
        PigmentChanges.from_moments(*estimate.average(chosen)),
        PigmentChanges.from_moments(*estimate.contrast(chosen)),
    )


def _summarise_regions(
    estimate: Estimate, cells: Cells, read: Decomposition
) -> dict[str, RegionChanges | None]:
    parts = {} if read.face_parts is None else read.face_parts.regions
    centres, found = cells.centres[cells.skin], dict[str, RegionChanges | None]()
    for name, region in parts.items():
        chosen = _find_inside(region.patch, centres)
        enough = chosen.sum() >= _LEAST_REGION
        found[name] = _summarise_region(estimate, chosen) if enough else None
    return found


def _find_inside(patch: Patch, points: NDArray[np.float64]) -> NDArray[np.bool_]:
    """Which columns and rows [N, 2] lie in a patch."""
    column, row = (np.floor(points) - (patch.box.left, patch.box.top)).astype(int).T
    height, width = patch.inside.shape
    within = (column >= 0) & (column < width) & (row >= 0) & (row < height)
    inside = np.zeros(len(points), bool)
    inside[within] = patch.inside[row[within], column[within]]
    return inside


def _refuse_little_skin(cells: Cells, names: tuple[str, str]) -> None:
    count = int(cells.skin.sum())
    if count < _LEAST_CELLS:
        raise InputError(
            f"Too little skin is seen in both {names[0]} and {names[1]}: {count} cells of the "
            f"face, and {_LEAST_CELLS} are needed. Use photographs that are neither overexposed "
            "nor dark, with the face uncovered."
        )


def _refuse_other_person(face: PigmentChanges, names: tuple[str, str]) -> None:
    low, high = face.melanin.interval
    if low > _OTHER_PERSON or high < -_OTHER_PERSON:
        factor = math.exp(abs(face.melanin.log))
        more, less = names[::-1] if low > 0 else names
        raise InputError(
            f"{more} and {less} plainly show different people: the skin in the first has "
            f"{factor:.2g} times the melanin of that in the second, and no skin changes so much. "
            "Give two photographs of one person."
        )


def _list_notes(
    read: Sequence[Decomposition], names: tuple[str, str], estimate: Estimate
) -> tuple[str, ...]:
    notes = [note for one in read for note in one.notes]
    for one, name in zip(read, names, strict=True):
        count = one.faces_found or 1
        if count > 1:
            # It replaces the note on --faces, which this verb does not have.
            notes = [note for note in notes if note not in note_others(count, 1, name)]
            notes.append(f"{name} shows {count} faces; the largest is compared.")
    if estimate.conflict:
        notes.append(
            "Clothes or background contradict what the skin tells of the change of light; they "
            "were taken for other ones, and left out."
        )
    return tuple(dict.fromkeys(notes))


def _check_names(names: Any) -> tuple[str, str]:
    if not isinstance(names, Sequence) or isinstance(names, str) or len(names) != 2:
        raise InputError(f"names are those of both photographs; got {names!r:.60}.")
    first, second = (check_text("The name of a photograph", name) for name in names)
    return first, second


def _name(before: ImageLike, after: ImageLike) -> tuple[str, str]:
    first, second = name_image(before), name_image(after)
    return first or "the first photograph", second or "the second photograph"
