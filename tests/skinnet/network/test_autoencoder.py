"""The autoencoder takes any size, and its outputs are in physical ranges."""

from copy import deepcopy

import pytest
import torch

from skinnet.errors import InputError
from skinnet.network import (
    CAMERA_MAX,
    F_BLOOD_MAX,
    F_MEL_MAX,
    SHADING_MAX,
    WHITE_BALANCE_MAX,
    AutoencoderConfig,
    SkinAutoencoder,
)
from skinnet.network.autoencoder import (
    _GLOBAL_CHANNELS,
    _MAP_CHANNELS,
    LOG_SD_RANGE,
    _activate,
    _activate_capture,
    _activate_uncertainty,
    _at_least_float32,
)
from skinnet.physics import LIGHTS, Capture, SkinDecoder


@pytest.fixture(scope="module")
def model() -> SkinAutoencoder:
    torch.manual_seed(0)
    return SkinAutoencoder(AutoencoderConfig(widths=(4, 6, 8))).eval()


@pytest.mark.parametrize("size", [(1, 1), (3, 2), (17, 33), (64, 48)])
def test_any_size_is_read(model: SkinAutoencoder, size: tuple[int, int]) -> None:
    reading = model(torch.rand(2, 3, *size))
    assert reading.reconstruction.shape == (2, 3, *size)
    assert all(value.shape[-2:] == size for value in reading.maps)
    assert reading.capture.light.shape == (2, len(LIGHTS))


def test_the_default_network_is_light() -> None:
    weights = sum(value.numel() for value in SkinAutoencoder().encoder.parameters())
    assert weights < 1_300_000


def test_the_reconstruction_is_the_decoder_s(model: SkinAutoencoder) -> None:
    maps, capture, reconstruction, _ = model(torch.rand(2, 3, 12, 10))
    pixels = (maps.melanin, maps.hemoglobin, maps.shading, maps.specular, maps.offset)
    assert torch.allclose(SkinDecoder()(*pixels, capture=capture), reconstruction, atol=1e-6)


@pytest.mark.parametrize("raw", [-1e4, -3.0, 0.0, 3.0, 1e4])
def test_activations_stay_in_their_ranges(raw: float) -> None:
    white = torch.ones(1, 3, 2, 2)
    raw_maps = torch.full((1, _MAP_CHANNELS, 2, 2), raw)
    raw_values = torch.full((1, _GLOBAL_CHANNELS), raw)
    maps, capture = _activate(raw_maps, white), _activate_capture(raw_values, WHITE_BALANCE_MAX)
    spread = _activate_uncertainty(raw_maps, raw_values, torch.ones(2, 2, 1))
    low_sd, high_sd = LOG_SD_RANGE[0] * (1 - 1e-5), LOG_SD_RANGE[1] * (1 + 1e-5)
    for value, low, high in (
        (maps.melanin, 0, F_MEL_MAX),
        (maps.hemoglobin, 0, F_BLOOD_MAX),
        (maps.shading, 0, SHADING_MAX),
        (maps.specular, 0, 1),
        (maps.offset, -1, 1),
        (maps.mask, 0, 1),
        (capture.temperature, 3999.9, 25000.1),
        (capture.camera, -CAMERA_MAX, CAMERA_MAX),
        (capture.white_balance, -WHITE_BALANCE_MAX, WHITE_BALANCE_MAX),
        *((one, low_sd, high_sd) for one in spread),
    ):
        assert low <= value.min() and value.max() <= high
    assert capture.light.sum() == pytest.approx(1)


def test_raw_zero_is_ordinary_skin_in_ordinary_light() -> None:
    maps = _activate(torch.zeros(1, _MAP_CHANNELS, 1, 1), torch.zeros(1, 3, 1, 1))
    capture = _activate_capture(torch.zeros(1, _GLOBAL_CHANNELS), WHITE_BALANCE_MAX)
    assert 0.02 < maps.melanin.item() < 0.1 and 0.01 < maps.hemoglobin.item() < 0.05
    assert maps.shading.item() == pytest.approx(1, abs=0.02) and maps.specular.item() < 0.05
    assert 5000 < capture.temperature.item() < 8000
    assert capture.camera.abs().max() == 0 and capture.white_balance.abs().max() == 0


def test_without_skin_the_offset_is_the_photograph() -> None:
    raw, linear = torch.zeros(1, _MAP_CHANNELS, 2, 2), torch.rand(1, 3, 2, 2)
    raw[:, 4] = torch.tensor([[-1e4, 0.0], [1e4, 0.0]])
    raw.requires_grad_()
    maps = _activate(raw, linear)
    left = torch.tensor([[1.0, 0.5], [0.0, 0.5]])
    torch.testing.assert_close(maps.offset, left * linear)
    (gradient,) = torch.autograd.grad(maps.offset.sum() + 0 * raw.sum(), raw)
    assert not gradient.any()  # or the best explanation would be no skin at all


def test_the_tint_of_the_voting_reaches_the_white_balance_directly(model: SkinAutoencoder) -> None:
    model, photograph = deepcopy(model), torch.rand(1, 3, 24, 20)
    with torch.no_grad():
        model.encoder.refine[-1].weight.zero_()  # the indirect path
        before = model.encode(photograph)[1].white_balance
        model.encoder.pooling.expected_chroma.bias += 0.1
        assert (model.encode(photograph)[1].white_balance != before).all()


def test_activations_of_half_precision_are_float32_and_float64_stays() -> None:
    for given, kept in ((torch.bfloat16, torch.float32), (torch.float64, torch.float64)):
        raw = _at_least_float32(torch.zeros(1, _MAP_CHANNELS, 2, 2, dtype=given))
        values = _at_least_float32(torch.zeros(1, _GLOBAL_CHANNELS, dtype=given))
        maps, capture = _activate(raw, torch.zeros(1, 3, 2, 2)), _activate_capture(values, 0.9)
        assert maps.melanin.dtype == kept and capture.light.dtype == kept


def test_gradients_of_the_appearance_reach_every_weight(model: SkinAutoencoder) -> None:
    model.zero_grad()
    known = Capture(linear=torch.ones(2))
    reading = model(torch.rand(2, 3, 16, 16), known)
    (reading.reconstruction.square().mean() + reading.maps.mask.mean()).backward()
    assert all(value.grad is not None for value in model.encoder.parameters())


def test_without_a_path_the_shipped_network_is_loaded() -> None:
    model = SkinAutoencoder.from_pretrained()
    assert not model.training and model.config.working_size == 160
    assert model.trained_on.startswith("1000 ICT-FaceKit and procedural heads")


@pytest.mark.parametrize(
    ("photograph", "words"),
    [
        (torch.full((1, 3, 8, 8), 255.0), "255. Divide 8-bit values by 255"),
        (torch.full((1, 3, 8, 8), -0.5), "-0.5"),
        (torch.zeros(1, 8, 8, 3), r"\[1, 8, 8, 3\]"),
    ],
)
def test_what_is_no_photograph_is_refused(
    model: SkinAutoencoder, photograph: torch.Tensor, words: str
) -> None:
    with pytest.raises(InputError, match=words):
        SkinAutoencoder.encode.__wrapped__(model, photograph)


@pytest.mark.parametrize(
    "values",
    [
        *({"widths": widths} for widths in ((), (0, 4), (4, 10**6), (8,) * 20)),
        *({"working_size": size} for size in (0, 10**6, True)),
        *({"white_balance_max": largest} for largest in (-1.0, float("nan"), float("inf"))),
    ],
)
def test_a_network_of_no_size_is_refused(values: dict[str, object]) -> None:
    with pytest.raises(InputError, match=f"{next(iter(values))} .*; got "):
        AutoencoderConfig(**values)  # type: ignore[arg-type]
