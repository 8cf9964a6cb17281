"""What is known of a capture is used and returned; what is not known is estimated."""

import pytest
import torch

from skinnet.network import SkinAutoencoder
from skinnet.network._known_capture import KNOWN_VALUES, KnownCapture
from skinnet.physics import LIGHTS, Capture, SkinDecoder, SpectralCamera

CAMERA = SpectralCamera()
NAN = float("nan")


@pytest.fixture
def known() -> KnownCapture:
    return KnownCapture(CAMERA)


def complete(known: KnownCapture, count: int = 2, **parts: torch.Tensor) -> Capture:
    return known.complete(Capture(**parts), count, torch.zeros(1))


def test_nothing_known_is_described_by_zeros(known: KnownCapture) -> None:
    described = known.describe(known.complete(None, 3, torch.zeros(1)))
    assert described.shape == (3, KNOWN_VALUES)
    assert not described.any()


def test_each_part_has_a_flag_of_its_own(known: KnownCapture) -> None:
    parts = {
        "light": torch.zeros(1, 9),
        "temperature": torch.full((1,), 6250.0),
        "camera": torch.zeros(1, 6),
        "white_balance": torch.zeros(1, 2),
        "exposure": torch.zeros(1),
    }
    for number, (name, value) in enumerate(parts.items()):
        described = known.describe(complete(known, 1, **{name: value}))
        flags = torch.zeros(5)
        flags[number] = 1
        torch.testing.assert_close(described[0, -6:-1], flags)
        torch.testing.assert_close(described[0, :-6], torch.zeros(KNOWN_VALUES - 6))
    linear = known.describe(complete(known, 1, linear=torch.ones(1)))
    assert linear[0, -1] == 1 and not linear[0, :-1].any()


def test_a_known_balance_is_that_of_the_mean_camera(known: KnownCapture) -> None:
    balance = torch.tensor([[0.2, -0.3], [-0.1, 0.25]])
    capture = CAMERA.standard((2,))._replace(white_balance=balance)
    white = CAMERA.white(capture)
    torch.testing.assert_close(known.find_white_balance(white), balance, rtol=0, atol=2e-5)
    picture = white[..., None, None].expand(2, 3, 4, 4)
    balanced = known._balance(picture, complete(known, white_balance=balance))
    torch.testing.assert_close(balanced, torch.ones_like(balanced), rtol=0, atol=2e-5)


def test_nothing_known_leaves_the_photograph_alone() -> None:
    picture, model = torch.rand(2, 3, 4, 4), SkinAutoencoder.from_pretrained()
    nothing = model.known.complete(None, 2, picture)
    assert torch.equal(model.known.normalise(picture, nothing, model.decoder.camera), picture)


def test_training_in_half_precision_computes_the_matrices_in_full() -> None:
    torch.manual_seed(0)
    known, picture = SkinAutoencoder().known, torch.rand(1, 3, 4, 4)
    told = complete(known, 1, light=torch.eye(9)[[3]], camera=torch.randn(1, 6))
    expected = known.normalise(picture, told, CAMERA)
    with torch.autocast("cpu", torch.bfloat16):
        assert torch.equal(known.normalise(picture, told, CAMERA), expected)


@pytest.mark.parametrize("light", range(1, len(LIGHTS)))
def test_skin_under_a_known_light_and_camera_has_its_standard_colours(light: int) -> None:
    torch.manual_seed(light)
    decoder = SkinDecoder()
    known = SkinAutoencoder().known
    f_mel = torch.logspace(-1.8, -0.7, 12).expand(1, 3, 12)
    f_blood = torch.tensor([0.02, 0.04, 0.07])[None, :, None].expand(1, 3, 12)
    capture = CAMERA.standard((1,))._replace(
        light=torch.eye(len(LIGHTS))[[light]], camera=torch.randn(1, 6)
    )
    seen, standard = decoder(f_mel, f_blood, capture=capture), decoder(f_mel, f_blood)
    told = complete(known, 1, light=capture.light, camera=capture.camera)
    turned = known.normalise(seen, told, CAMERA)

    def measure(picture: torch.Tensor) -> torch.Tensor:
        log = picture.clamp_min(1e-3).log()
        return log[:, 0] - log[:, 1]

    before, after = ((measure(one) - measure(standard)).abs().mean() for one in (seen, turned))
    assert after < 0.05 and after < before
    white = known.normalise(torch.full((1, 3, 1, 1), 0.8), told, CAMERA)[0, :, 0, 0]
    assert (white / white.mean() - 1).abs().max() < 0.06


def test_a_missing_balance_leaves_the_photograph_alone(known: KnownCapture) -> None:
    picture = torch.rand(2, 3, 4, 4)
    balance = torch.tensor([[NAN, NAN], [0.2, 0.1]])
    balanced = known._balance(picture, complete(known, white_balance=balance))
    assert torch.equal(balanced[0], picture[0])
    assert not torch.allclose(balanced[1], picture[1])


def test_what_is_known_is_returned(known: KnownCapture) -> None:
    estimate = CAMERA.standard((2,))._replace(white_balance=torch.full((2, 2), 0.01))
    light = torch.full((2, 9), NAN)
    light[0] = torch.eye(9)[3]
    balance = torch.tensor([[NAN, NAN], [0.2, 0.1]])
    adopted = known.adopt(complete(known, light=light, white_balance=balance), estimate)
    assert torch.equal(adopted.light, torch.stack([torch.eye(9)[3], torch.eye(9)[0]]))
    torch.testing.assert_close(adopted.white_balance, torch.tensor([[0.01, 0.01], [0.21, 0.11]]))


@torch.no_grad()
def test_one_row_serves_a_batch_and_gradients_are_finite() -> None:
    model = SkinAutoencoder.from_pretrained()
    photograph = torch.rand(2, 3, 32, 32)
    known = Capture(white_balance=torch.tensor([[0.1, -0.1]]), linear=torch.ones(1))
    both = model.encode(photograph, known)
    for row in range(2):
        single = model.encode(photograph[row : row + 1], known)
        torch.testing.assert_close(single[0].melanin[0], both[0].melanin[row], rtol=1e-4, atol=1e-5)
    with torch.enable_grad():
        value = photograph.clone().requires_grad_()
        maps = model.encode(value, Capture(white_balance=torch.tensor([[0.1, NAN]])))[0]
        maps.melanin.sum().backward()
    assert value.grad is not None and value.grad.isfinite().all()
