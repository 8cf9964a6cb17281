"""A standard capture, and one capture for a whole batch."""

import torch

from skinnet.physics.capture import Capture


def test_the_standard_is_d65_with_the_mean_camera() -> None:
    capture = Capture.standard(9, 6, (2,), torch.zeros(1, dtype=torch.float64))
    assert capture.light.tolist() == [[1] + [0] * 8] * 2
    assert capture.temperature.tolist() == [6504, 6504]
    assert not capture.camera.any() and not capture.white_balance.any()
    assert {value.dtype for value in capture[:4]} == {torch.float64}


def test_a_capture_is_expanded_to_a_batch() -> None:
    expanded = Capture.standard(9, 6).expand((3, 2), torch.float64)
    assert [tuple(value.shape) for value in expanded[:4]] == [
        (3, 2, 9),
        (3, 2),
        (3, 2, 6),
        (3, 2, 2),
    ]
    assert {value.dtype for value in expanded[:4]} == {torch.float64}


def test_what_is_not_known_stays_so() -> None:
    known = Capture(white_balance=torch.ones(1, 2)).map(torch.Tensor.double)
    assert known.white_balance.dtype == torch.float64
    assert known._replace(white_balance=None) == Capture()
