"""Skin and what covers it, painted on the charts of a batch of heads."""

from functools import cache
from typing import NamedTuple

import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor

from skinnet.network.autoencoder import F_BLOOD_MAX, F_MEL_MAX
from skinnet.shape import compute_chart_angles
from train.synthetic.scene_sampling import CHART
from train.synthetic.tensors import column, soft_step

Chart = Float[Tensor, "batch channels rows columns"]

REGIONS = ((0.0, 0.50, 0.50, 0.20), (0.52, -0.28, 0.20, 0.15), (0.0, -0.30, 0.14, 0.14),
           (0.34, 0.05, 0.16, 0.10), (0.0, -0.66, 0.17, 0.055), (0.0, -1.0, 0.3, 0.15))  # fmt: skip
"""Azimuth, elevation and widths of forehead, cheeks, nose, lids, lips and chin."""

OWN = 0.4
"""Share of a lot's own regions and noise that is left under a skin of a hybrid model, which has
such structure already."""


class Paint(NamedTuple):
    """Charts [batch, channels, rows, columns]: the pigments, the paint over them and its share,
    oil, and the slopes of the skin's own relief."""

    melanin: Tensor
    hemoglobin: Tensor
    paint: Tensor
    cover: Tensor
    oil: Tensor
    bump: Tensor


def paint_skin(lot: dict[str, Tensor]) -> Paint:
    """The charts of a batch of lots."""
    azimuth, elevation = (axis.to(lot["f_mel"].device) for axis in compute_chart_angles(*CHART))
    regions = _regions(lot["f_mel"].device)
    melanin, hemoglobin = _pigments(lot, regions)
    paint, cover = torch.zeros_like(melanin).expand(-1, 3, -1, -1), torch.zeros_like(melanin)
    for colour, mask in _layers(lot, azimuth, elevation, regions):
        paint = paint * (1 - mask) + colour * mask
        cover = cover + mask - cover * mask
    oil = (0.8 + 0.7 * regions[2] + 0.5 * regions[0])[None, None].expand_as(cover)
    return Paint(melanin, hemoglobin, paint / cover.clamp_min(1e-3), cover, oil, lot["bump"])


@cache
def _regions(device: torch.device) -> Float[Tensor, "regions rows columns"]:
    azimuth, elevation = (axis.to(device) for axis in compute_chart_angles(*CHART))
    return torch.stack([region(azimuth, elevation, *place) for place in REGIONS])


def region(
    azimuth: Tensor, elevation: Tensor, at: float, height: float, wide: float, tall: float
) -> Tensor:
    """A bell on both sides of the face, or on its middle."""
    across = (azimuth.abs() - at if at else azimuth) / wide
    return torch.exp(-(across**2 + ((elevation - height) / tall) ** 2) / 2)


def _pigments(lot: dict[str, Tensor], regions: Tensor) -> tuple[Tensor, Tensor]:
    logs = []
    own = 1 - (1 - OWN) * column(lot["worn"])
    for name in ("melanin", "blood"):
        log = torch.einsum("br,rhw->bhw", lot[f"{name}_regions"], regions)[:, None]
        for octave in ("coarse", "middle", "fine"):
            log = log + enlarged(lot[f"{name}_{octave}"])
        logs.append(own * log + lot[f"skin_{name}"])
    # Lips hold what they hold: freckles and moles end there.
    skin = 1 - regions[4]
    marks = (enlarged(lot["freckles"]) + _moles(lot)) * skin
    blood = (enlarged(lot["spots"]) + enlarged(lot["vessels"]) * (regions[1] + regions[2])) * skin
    melanin = column(lot["f_mel"]) * (logs[0] + marks).exp()
    hemoglobin = column(lot["f_blood"]) * (logs[1] + blood).exp()
    return melanin.clamp(1e-4, F_MEL_MAX), hemoglobin.clamp(1e-4, F_BLOOD_MAX)


def enlarged(small: Chart) -> Chart:
    """A lot's noise over the whole chart."""
    return F.interpolate(small, CHART, mode="bilinear")


def _moles(lot: dict[str, Tensor]) -> Tensor:
    azimuth, elevation = (axis.to(lot["f_mel"].device) for axis in compute_chart_angles(*CHART))
    at, height, radius, factor = (part[..., None, None] for part in lot["moles"].unbind(2))
    across = torch.exp(-(((azimuth - at) / radius) ** 2) / 2)
    along = torch.exp(-(((elevation - height) / radius) ** 2) / 2)
    # Separable bells, so that six of them cost two thin products.
    return torch.matmul((factor * along)[..., 0].mT, across[:, :, 0])[:, None]


def _layers(
    lot: dict[str, Tensor], azimuth: Tensor, elevation: Tensor, regions: Tensor
) -> list[tuple[Tensor, Tensor]]:
    side = azimuth.abs()
    hair = lot["hair"][:, :, None, None] * enlarged(lot["strands"]).exp()
    dark = torch.tensor([0.03, 0.010, 0.008], device=side.device)[None, :, None, None]
    mouth = torch.exp(-(((elevation + 0.66) / 0.010) ** 2)) * soft_step(0.20 - side, 0.04)
    nostrils = region(azimuth, elevation, 0.075, -0.435, 0.028, 0.015)
    lips = (1.6 * regions[4]).clamp_max(1) * column(lot["make_up"])
    return [
        (lot["lipstick"][:, :, None, None], lips),
        (hair, beard(lot, side, elevation)),
        (hair, _brow(lot, side, elevation)),
        (torch.full_like(dark, 0.015), _lashes(lot, side, elevation)),
        (dark, 0.5 * mouth),
        (dark, 0.8 * nostrils),
    ]


def beard(lot: dict[str, Tensor], side: Tensor, elevation: Tensor) -> Tensor:
    """The share of hair where a lot has beard, moustache or stubble."""
    jaw = soft_step(-0.42 - elevation - 0.35 * (1 - (side / 0.6).clamp(0, 1)) * (side > 0.25), 0.06)
    lip = soft_step(elevation + 0.60, 0.03) * soft_step(0.35 - side, 0.05)
    jaw = jaw * (1 - lip * (1 - column(lot["moustache"])))
    lips = region(side, elevation, 0.0, -0.66, 0.16, 0.06)
    place = jaw * (1 - lips).clamp(0, 1) * soft_step(1.4 - side, 0.1)
    place = place * soft_step(elevation + 1.25, 0.1)
    hairs = 0.8 + 0.2 * lot["beard_grain"]
    return place * torch.maximum(column(lot["stubble"]), column(lot["beard"])) * hairs


def _brow(lot: dict[str, Tensor], side: Tensor, elevation: Tensor) -> Tensor:
    height, tilt, thick = (column(part) for part in lot["brow_shape"].unbind(1))
    arch = elevation - (0.19 + height + (0.05 + tilt) * (side - 0.1))
    arch = arch + 0.35 * (side - 0.35).clamp_min(0) ** 2
    length = soft_step(side - 0.12, 0.03) * soft_step(0.58 - side, 0.04)
    return column(lot["brow"]) * length * torch.exp(-((arch / (0.032 + thick)) ** 2))


def _lashes(lot: dict[str, Tensor], side: Tensor, elevation: Tensor) -> Tensor:
    lid = elevation - (0.055 - 1.6 * (side - 0.34) ** 2)
    length = soft_step(0.15 - (side - 0.34).abs(), 0.03)
    return 0.7 * column(lot["lashes"]) * length * torch.exp(-((lid / 0.014) ** 2))
