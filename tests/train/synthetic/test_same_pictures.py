"""The same seed gives the same pictures as in earlier versions."""

from collections.abc import Iterator

import pytest
import torch
from torch.utils.data import default_collate

from skinnet.physics import SkinDecoder
from train.batch import Batch
from train.synthetic.faces import SyntheticFaces, SyntheticScenes
from train.synthetic.photography.renderer import render

TRAIN = (0.21912456, 0.0242834, 0.02715974, 0.0537778, 0.00268468, 0.07689927, 0.1704403)
TEST = (0.29194102, 0.03692688, 0.02704669, 0.04756396, 0.00177844, 0.2123137, 0.2073564)


def describe(batch: Batch) -> Iterator[float]:
    """Means that change if any sampled value or any step of the renderer changes."""
    assert batch.truth is not None and batch.capture is not None
    weight = torch.linspace(0, 1, 32)
    for value in (batch.photograph, *batch.truth[:5]):
        yield (value * weight).mean().item()
    yield batch.capture.white_balance.abs().sum().item()


@pytest.mark.parametrize(("split", "expected"), [("train", TRAIN), ("test", TEST)])
def test_pictures_are_those_of_earlier_versions(
    data: SyntheticFaces, split: str, expected: tuple[float, ...]
) -> None:
    scenes = SyntheticScenes(
        data.buffers[split], split, 4, seed=0, domain_randomised=split == "train"
    )
    scene = default_collate([scenes[index] for index in range(4)])
    batch = render(scene, SkinDecoder("calibrated"), split)
    assert tuple(describe(batch)) == pytest.approx(expected, abs=1e-5)
