"""Whether measured skins stay skin when their pigments are edited.

`python -m benchmarks.edits [--json]`. The colours of the spectra of ISSA and NIST under D65, less
the reflection of the surface, are inverted like a texture, edited, and given their surface again.
The chromaticity (a*, b*) of an edited skin is compared with the convex hull of the chromaticities
of measured skins within 5 units of its lightness L*. `inside` is the share within that hull,
`near` the share at most one unit outside of it, and `p95` the distance in units that 95 % keep.
Edits that lead beyond measured skin are left out of these, and `beyond` is their share: there
either L* or the edited fraction is outside of what 99 % of the measured skins have. A measured skin
is inside the hull of the others in 93 % of cases, and near it in 98 % (`unedited`).
"""

from typing import NamedTuple

import numpy as np
import torch
from jaxtyping import Bool, Float, Float32
from scipy.spatial import ConvexHull

from benchmarks.recovered_spectra import load_d65_matrix
from benchmarks.report import Results, main
from benchmarks.skin_spectra import fill_bands, load_forearms, load_issa
from skinnet.appearance import PigmentEdit, SkinColour, SkinTexture, edit_texture
from skinnet.physics import R_SURFACE, srgb_to_xyz

PRESETS = ("measured", "calibrated")
MELANIN = (0.4, 0.5, 0.7, 1.5, 2.0, 4.0)
BLOOD = (0.25, 0.5, 2.0, 4.0)

_WINDOW = 5.0
"""Difference in L* within which skins are compared."""

_FEWEST = 8
"""Skins of a lightness that are too few for a hull."""

_NEAR = 1.0
"""Distance in a* and b* that the eye hardly sees."""

Colours = Float[np.ndarray, "skins 3"]


class EditedSkins(NamedTuple):
    """Colours of skins after an edit, and whether the edited fraction is one of measured skin."""

    colours: Colours
    possible: Bool[np.ndarray, "skins"]


def load_colours() -> Colours:
    """Load linear sRGB under D65 of all measured spectra, specular included."""
    spectra = fill_bands(torch.cat([load_issa(), load_forearms()]))
    colours: Colours = (spectra @ load_d65_matrix()).numpy()
    return colours


def make_colour(preset: str) -> SkinColour:
    """Make the colours of skin under D65, for the standard observer."""
    return SkinColour(load_d65_matrix().numpy(), optics=preset)


def invert_colours(colours: Colours, colour: SkinColour) -> SkinTexture:
    """Invert colours of measured skins, without their surface, to a texture of one texel each."""
    skin = ((colours - R_SURFACE) / (1 - R_SURFACE)).astype(np.float32)
    found = colour.lookup.inverse(torch.from_numpy(colour.matrix))(torch.from_numpy(skin))
    side = int(np.ceil(np.sqrt(len(skin))))
    mask = (np.arange(side**2) < len(skin)).reshape(side, side)
    f_mel, f_blood = (_scatter(one.numpy(), mask) for one in found[:2])
    bare = SkinTexture(f_mel, f_blood, np.zeros((side, side, 3), np.float32), mask)
    offset = _scatter(skin, mask) - bare.albedo(colour)
    return SkinTexture(f_mel, f_blood, offset, mask)


def _scatter(
    values: Float32[np.ndarray, "skins *channel"], mask: Bool[np.ndarray, "size size"]
) -> Float32[np.ndarray, "size size *channel"]:
    whole = np.zeros((*mask.shape, *values.shape[1:]), np.float32)
    whole[mask] = values
    return whole


def edit_skins(
    skins: SkinTexture, colour: SkinColour, melanin: float = 1.0, blood: float = 1.0
) -> EditedSkins:
    """Multiply the pigments of skins, and compute what would be measured then."""
    edited = edit_texture(skins, colour, PigmentEdit(melanin), PigmentEdit(blood))
    possible = np.ones(int(skins.mask.sum()), bool)
    for before, after in ((skins.f_mel, edited.f_mel), (skins.f_blood, edited.f_blood)):
        low, high = np.quantile(before[skins.mask], (0.005, 0.995))
        possible &= ((after >= low) & (after <= high))[skins.mask] | (after == before)[skins.mask]
    return EditedSkins(R_SURFACE + (1 - R_SURFACE) * edited.albedo(colour)[skins.mask], possible)


def compute_lab(colours: Colours) -> Colours:
    """Compute L*, a* and b* of linear sRGB."""
    to_xyz = srgb_to_xyz().numpy()
    ratio = colours @ to_xyz.T / to_xyz.sum(1)
    knee = (6 / 29) ** 3
    f = np.where(
        ratio > knee, np.cbrt(np.maximum(ratio, knee)), ratio / (3 * (6 / 29) ** 2) + 4 / 29
    )
    return np.stack([116 * f[:, 1] - 16, 500 * (f[:, 0] - f[:, 1]), 200 * (f[:, 1] - f[:, 2])], 1)


def compute_excess(
    lab: Colours, measured: Colours, own: bool = False
) -> Float[np.ndarray, "skins"]:
    """Compute how far chromaticities are outside the hull of measured ones of their lightness.

    Args:
        lab: L*, a* and b* of the skins.
        measured: Those of the measured skins.
        own: Whether `lab` are the measured skins themselves; each is then left out of its hull.

    Returns:
        Distances in a* and b*, negative inside; NaN where too few measured skins are as light.
    """
    excess = np.full(len(lab), np.nan)
    lightness = measured[:, 0]
    for index, (level, *chroma) in enumerate(lab):
        near = np.abs(lightness - level) <= _WINDOW
        near[index] &= not own
        if near.sum() < _FEWEST or not lightness.min() <= level <= lightness.max():
            continue
        sides = ConvexHull(measured[near, 1:]).equations
        excess[index] = (sides[:, :2] @ chroma + sides[:, 2]).max()
    return excess


def measure(
    presets: tuple[str, ...] = PRESETS,
    melanin: tuple[float, ...] = MELANIN,
    blood: tuple[float, ...] = BLOOD,
) -> Results:
    """Measure the shares of every preset, pigment and factor."""
    colours = load_colours()
    measured = compute_lab(colours)
    results: Results = {"unedited": summarise(compute_excess(measured, measured, own=True))}
    for preset in presets:
        colour = make_colour(preset)
        skins = invert_colours(colours, colour)
        edits = [("melanin", factor) for factor in melanin] + [("blood", one) for one in blood]
        results[preset] = {}
        for pigment, factor in edits:
            edited = edit_skins(skins, colour, **{pigment: factor})
            excess = compute_excess(compute_lab(edited.colours), measured)
            results[preset][f"{pigment} x {factor:g}"] = summarise(
                np.where(edited.possible, excess, np.nan)
            )
    return results


def summarise(excess: Float[np.ndarray, "skins"]) -> Results:
    """Summarise the distances of one edit."""
    known = excess[~np.isnan(excess)]
    return {
        "inside": float(np.mean(known <= 0)),
        "near": float(np.mean(known <= _NEAR)),
        "p95": float(np.quantile(known, 0.95)),
        "beyond": float(np.mean(np.isnan(excess))),
    }


def layout(results: Results) -> str:
    """Lay the results out as a table in Markdown."""
    rows = {"unedited": results["unedited"]} | {
        f"`{preset}`, {edit}": row for preset in PRESETS for edit, row in results[preset].items()
    }
    lines = [
        f"| {name} | " + " | ".join(f"{value:.2f}" for value in row.values()) + " |"
        for name, row in rows.items()
    ]
    return "\n".join(["| skins | inside | near | p95 | beyond |", "|---|---|---|---|---|", *lines])


if __name__ == "__main__":
    main(measure, "Whether measured skins stay skin when they are edited.", layout)
