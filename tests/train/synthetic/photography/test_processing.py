"""Processing of photographs: what each part does, and that none changes nothing."""

import pytest
import torch
from skimage.color import rgb2hsv

from train.synthetic.photography.processing import add_flare, grade, resample
from train.synthetic.sampling.wide_captures import make_no_processing
from train.synthetic.scene import ProcessingParameters, map_tensors


def make(**changed: torch.Tensor) -> ProcessingParameters:
    none = map_tensors(lambda value: value[None], make_no_processing())
    return none._replace(**changed)


@pytest.fixture
def picture() -> torch.Tensor:
    torch.manual_seed(0)
    return 0.2 + 0.6 * torch.rand(1, 3, 24, 20)


def test_none_changes_nothing(picture: torch.Tensor) -> None:
    none = make()
    assert torch.equal(add_flare(none, picture), picture)
    assert torch.equal(grade(none, picture), picture)
    assert torch.equal(resample(none, picture), picture)


def test_saturation_moves_colours_from_grey(picture: torch.Tensor) -> None:
    grey = grade(make(saturation=torch.tensor([-20.0])), picture)
    assert (grey.amax(1) - grey.amin(1)).max() < 1e-6
    more, less = (grade(make(saturation=torch.tensor([one])), picture) for one in (0.2, -0.2))
    saturation = [
        rgb2hsv(one[0].movedim(0, -1).numpy())[..., 1].mean() for one in (less, picture, more)
    ]
    assert saturation == sorted(saturation)


def test_toning_belongs_to_shadows_or_highlights() -> None:
    toning = torch.tensor([[[0.3, 0.0, 0.0], [0.0, 0.0, 0.3]]])
    levels = torch.tensor([0.02, 0.98])[None, None, None].expand(1, 3, 1, 2)
    toned = grade(make(toning=toning), levels)
    shadow, highlight = toned[0, :, 0].unbind(-1)
    assert shadow[0] > 1.2 * shadow[1] and shadow[2] == pytest.approx(shadow[1].item(), rel=0.01)
    assert highlight[2] == 1 and highlight[0] == pytest.approx(highlight[1].item(), rel=0.01)


def test_a_reduced_picture_has_lost_detail_and_keeps_its_mean(picture: torch.Tensor) -> None:
    small = resample(make(reduction=torch.tensor([1.2])), picture)
    assert small.std() < 0.7 * picture.std()
    assert small.mean().item() == pytest.approx(picture.mean().item(), abs=0.01)
    sharp = resample(make(sharpening=torch.tensor([1.0])), picture)
    assert sharp.std() > 1.1 * picture.std()
