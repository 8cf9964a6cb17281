"""Skin of hands and arms is that of the face, without its features."""

import numpy as np
import torch

from train.synthetic.painting.body_painting import paint_body
from train.synthetic.sampling.body_sampling import sample_body
from train.synthetic.sampling.face_sampling import sample_face
from train.synthetic.scene import CHART_SIZE, FaceParameters, map_tensors


def sample(seed: int) -> tuple[FaceParameters, FaceParameters]:
    rng = np.random.default_rng(seed)
    face = map_tensors(torch.Tensor.float, sample_face(rng, variety="any"))
    return face, sample_body(rng, face)


def test_pigments_and_types_are_those_of_the_face() -> None:
    face, body = sample(0)
    for one, other in (
        (face.skin.melanin, body.skin.melanin),
        (face.skin.hemoglobin, body.skin.hemoglobin),
    ):
        assert one.fraction == other.fraction and not torch.equal(one.fine, other.fine)
        assert {value.dtype for value in other} == {torch.float32}
        assert [value.shape for value in one] == [value.shape for value in other]
    assert [value.shape for value in face.marks] == [value.shape for value in body.marks]


def test_palms_have_less_melanin_and_no_hair() -> None:
    rows, columns = CHART_SIZE
    for seed in range(6):
        _, body = sample(seed)
        charts = paint_body(map_tensors(lambda value: value[None], body))
        hand = charts.melanin[0, 0, rows // 4 : rows // 2 - 12]
        palm, back = hand[:, : columns // 8], hand[:, 2 * columns // 5 : 3 * columns // 5]
        assert palm.median() < 0.8 * back.median()
        assert charts.cover[0, 0, rows // 4 : rows // 2 - 12, : columns // 8].max() < 0.02
