import kornia
import numpy as np
import torch

from skinnet.images._guided_filter import enlarge_guided, filter_guided
from skinnet.images.resizing import resize


def test_the_filter_is_that_of_kornia() -> None:
    rng = np.random.default_rng(0)
    guide, image = rng.random((40, 50, 3)).astype("f"), rng.random((40, 50)).astype("f")
    tensors = torch.tensor(guide).permute(2, 0, 1)[None], torch.tensor(image)[None, None]
    theirs = kornia.filters.guided_blur(*tensors, kernel_size=7, eps=1e-2)[0, 0].numpy()
    assert np.abs(filter_guided(guide, image, 3, 1e-2) - theirs).max() < 1e-5


def test_an_enlarged_mask_follows_the_edge_of_the_photograph() -> None:
    photo = np.full((300, 400, 3), (200, 140, 110), np.uint8)
    photo[:, 203:] = (40, 30, 30)
    truth = np.zeros((300, 400), np.float32)
    truth[:, :203] = 1
    small = resize(truth, 40, 30)
    enlarged = enlarge_guided(photo, small, 2, 1e-4)
    assert enlarged.shape == (300, 400) and enlarged.dtype == np.float32
    assert np.abs(enlarged - truth).max() < 0.1
    assert np.abs(resize(small, 400, 300) - truth).max() > 0.3


def test_strips_leave_no_seams() -> None:
    rows = np.linspace(0, 1, 300, dtype=np.float32)[:, None].repeat(60, 1)
    photo = (255 * rows[..., None].repeat(3, 2)).astype(np.uint8)
    enlarged = enlarge_guided(photo, resize(rows, 12, 60), 2, 10.0)
    assert np.abs(np.diff(enlarged, axis=0)).max() < 0.01
