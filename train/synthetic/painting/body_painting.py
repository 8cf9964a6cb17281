"""Skin of hands, arms and other parts without a face, painted on charts of their own.

The chart of a limb goes around it and along it. Its middle is the back of the hand and the outer
side of the arm; fingers are above and the arm below.
"""

from functools import cache

import torch
from jaxtyping import Float
from torch import Tensor

from skinnet.network.autoencoder import F_BLOOD_MAX, F_MEL_MAX
from skinnet.shape._procedural_head import compute_chart_angles
from train.synthetic.painting.face_painting import (
    FaceCharts,
    paint_moles,
    resize_to_chart,
    sum_structure,
)
from train.synthetic.scene import CHART_SIZE, FaceParameters
from train.synthetic.tensors import expand_colour, expand_scalar, soft_step

_FLATTENING = 0.4
"""Height over width of a mole on the chart, which is stretched along a limb."""


def paint_body(face: FaceParameters) -> FaceCharts:
    """Paint skin without a face, with marks and hairs.

    Args:
        face: A batch of `train.synthetic.sampling.body_sampling.sample_body`.

    Returns:
        Charts of `CHART_SIZE` rows and columns.
    """
    skin, marks, hair = face.skin, face.marks, face.hair
    regions = _evaluate_regions(skin.bump.device)
    dark = resize_to_chart(marks.freckles) + paint_moles(marks, _FLATTENING)
    red = resize_to_chart(marks.spots) + resize_to_chart(marks.vessels)
    melanin = expand_scalar(skin.melanin.fraction)
    melanin = melanin * (sum_structure(skin.melanin, regions) + dark).exp()
    hemoglobin = expand_scalar(skin.hemoglobin.fraction)
    hemoglobin = hemoglobin * (sum_structure(skin.hemoglobin, regions) + red).exp()
    palm = regions[1] + regions[0] * regions[2]
    cover = expand_scalar(hair.beard.stubble) * hair.beard.grain * (1 - palm).clamp(0, 1)
    colour = expand_colour(hair.colour).expand(-1, 3, *CHART_SIZE)
    oil = torch.full_like(cover, 0.7)
    return FaceCharts(
        melanin.clamp(1e-4, F_MEL_MAX),
        hemoglobin.clamp(1e-4, F_BLOOD_MAX),
        colour,
        cover,
        oil,
        skin.bump,
    )


@cache
def _evaluate_regions(device: torch.device) -> Float[Tensor, "regions rows columns"]:
    """Inner side, palm, fingertips, knuckles, elbow, and hollow of the elbow."""
    azimuth, elevation = (axis.to(device) for axis in compute_chart_angles(*CHART_SIZE))
    inner = soft_step(azimuth.abs() - 1.15, 0.3).expand(CHART_SIZE)
    hand = soft_step(elevation + 0.05, 0.08).expand(CHART_SIZE)
    tips = soft_step(elevation - 1.25, 0.15).expand(CHART_SIZE)
    joints = sum(torch.exp(-(((elevation - at) / 0.05) ** 2)) for at in (0.5, 0.9, 1.15))
    elbow = torch.exp(-(((elevation + 1.18) / 0.1) ** 2))
    outer = 1 - inner
    return torch.stack(
        [inner * (1 - hand), inner * hand, tips, joints * outer, elbow * outer, elbow * inner]
    )
