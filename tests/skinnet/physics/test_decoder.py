"""The layer: what it composes, and that the fast mode and the closed form are one function."""

from collections.abc import Callable
from pathlib import Path

import pytest
import torch
from hypothesis import given
from hypothesis import strategies as st
from safetensors.torch import save_file
from torch import nn
from torch.func import functional_call

from skinnet.physics.capture import Capture
from skinnet.physics.decoder import SkinDecoder
from skinnet.physics.nuisance import Nuisance
from skinnet.physics.optics import PRESETS, SkinOptics
from tests import oracle

D = torch.float64
MODES = pytest.mark.parametrize("fast", [True, False], ids=["fast", "bands"])


def maps(*shape: int, count: int = 2, seed: int = 0) -> list[torch.Tensor]:
    rng = torch.Generator().manual_seed(seed)
    return list(torch.rand(count, *shape, generator=rng, dtype=D))


@MODES
def test_standard_capture_agrees_with_the_oracle(fast: bool) -> None:
    decoder, (f_mel, f_blood) = SkinDecoder(fast=fast, dtype=D), maps(9, 7)
    spectra = oracle.reflectance("measured", f_mel.numpy(), f_blood.numpy())
    rgb = oracle.linear_srgb(spectra, oracle.daylight(6504.0), decoder.camera.mean.numpy())
    actual = decoder(f_mel, f_blood).movedim(0, -1).numpy()
    assert actual == pytest.approx(rgb, abs=5e-4 if fast else 1e-6)


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("seed", range(3))
def test_modes_agree_over_the_unit_square(
    random_capture: Callable[..., Capture], preset: str, seed: int
) -> None:
    capture = random_capture(4, seed=seed)
    # Half of the pixels even over the square, half of them crowded where skin is.
    f = [torch.cat([m, m**4], -1) for m in maps(4, 64, 32, seed=seed)]
    fast, bands = (SkinDecoder(preset, fast=fast, dtype=D) for fast in (True, False))
    assert (fast(*f, capture=capture) - bands(*f, capture=capture)).abs().max() < 5e-4


def deviations(*shape: int, seed: int = 0) -> Nuisance:
    """About as much as skins differ from one another."""
    rng = torch.Generator().manual_seed(seed)
    scales = torch.tensor([0.7, 0.3, 0.2, 0.5], dtype=D)
    return Nuisance(*(scales * torch.randn(*shape, 4, generator=rng, dtype=D)).unbind(-1))


@pytest.mark.parametrize("preset", PRESETS)
@pytest.mark.parametrize("shape", [(), (6,), (2, 3)])
def test_modes_agree_for_skins_that_deviate(
    random_capture: Callable[..., Capture], preset: str, shape: tuple[int, ...]
) -> None:
    decoder, nuisance = SkinDecoder(preset, dtype=D), deviations(*shape)
    matrix = decoder.camera.matrix(random_capture(*shape))
    f = [torch.cat([m, m**4], -1) for m in maps(*shape, 32, 16)]
    fast = decoder.albedo(*f, matrix, nuisance)
    decoder.fast = False
    bands = decoder.albedo(*f, matrix, nuisance)
    assert fast.shape == (*shape, 3, 32, 32) and (fast - bands).abs().max() < 5e-4
    assert not torch.allclose(bands, decoder.albedo(*f, matrix), rtol=0.1, atol=0)


@MODES
def test_no_deviation_is_the_preset(random_capture: Callable[..., Capture], fast: bool) -> None:
    decoder, f = SkinDecoder(fast=fast, dtype=D), maps(3, 4, 5)
    matrix = decoder.camera.matrix(random_capture(3))
    zeros = decoder.albedo(*f, matrix, Nuisance.zeros((3,), like=matrix))
    assert torch.allclose(zeros, decoder.albedo(*f, matrix), rtol=0, atol=1e-12)


@MODES
def test_gradients_reach_the_deviations(random_capture: Callable[..., Capture], fast: bool) -> None:
    decoder, f = SkinDecoder(fast=fast, dtype=D), maps(2, 1, 2)
    matrix = decoder.camera.matrix(random_capture(2)).detach()
    assert torch.autograd.gradcheck(
        lambda *nuisance: decoder.albedo(*f, matrix, Nuisance(*nuisance)),
        [0.1 * deviation.requires_grad_() for deviation in deviations(2)],
    )


@pytest.mark.parametrize("scale", [(1.0, 1.0), (0.4, 0.07)], ids=["unit square", "skin"])
def test_gradients_of_the_modes_agree(
    random_capture: Callable[..., Capture], scale: tuple[float, float]
) -> None:
    f = [value * upper for value, upper in zip(maps(4, 64, 64), scale, strict=True)]
    weight = torch.randn(4, 3, 64, 64, generator=torch.Generator().manual_seed(1), dtype=D)
    gradients = []
    for fast in (True, False):
        inputs = [value.clone().requires_grad_() for value in (*f, *random_capture(4)[:4])]
        image = SkinDecoder(fast=fast, dtype=D)(*inputs[:2], capture=Capture(*inputs[2:]))
        gradients.append(torch.autograd.grad((weight * image).sum(), inputs))
    for ours, exact in zip(*gradients, strict=True):
        assert (ours - exact).norm() < 0.01 * exact.norm()


def differentiate(decoder: SkinDecoder, f: list[torch.Tensor], capture: Capture) -> torch.Tensor:
    """Derivatives of R, G and B by both fractions of each pixel [2, 3, batch, height, width]."""
    inputs = [value.clone().requires_grad_() for value in f]
    image = decoder(*inputs, capture=capture)
    rows = [
        torch.autograd.grad(image[:, channel].sum(), inputs, retain_graph=True)
        for channel in range(3)
    ]
    return torch.stack([torch.stack(row) for row in rows], 1)


@pytest.mark.parametrize("preset", sorted(set(PRESETS) - {"printed"}))
def test_gradients_of_each_pixel_agree(random_capture: Callable[..., Capture], preset: str) -> None:
    capture = random_capture(4)
    f = [torch.cat([m, m**4], -1) for m in maps(4, 64, 32)]
    for value, edges in zip(f, ([0.0, 0.0, 1.0, 1.0], [0.0, 1.0, 0.0, 1.0]), strict=True):
        value[:, 0, :4] = torch.tensor(edges, dtype=D)
    ours, exact = (
        differentiate(SkinDecoder(preset, fast=fast, dtype=D), f, capture) for fast in (True, False)
    )
    assert ((ours - exact).norm(dim=1) < 0.01 * exact.norm(dim=1)).all()


@MODES
@pytest.mark.parametrize("corner", [(0.0, 0.0), (0.0, 1.0), (1.0, 0.0), (1.0, 1.0)])
def test_gradients_are_right_in_the_corners(
    random_capture: Callable[..., Capture], fast: bool, corner: tuple[float, float]
) -> None:
    # The fast mode's gradients of the fractions are those of the closed form, and tested above.
    decoder, capture = SkinDecoder(fast=fast, dtype=D), random_capture(1)
    f = [torch.full((1, 1, 2), value, dtype=D, requires_grad=not fast) for value in corner]
    others = [m.requires_grad_() for m in maps(1, 1, 2)]
    lamp, kelvin, device, balance = (value.requires_grad_() for value in capture[:4])

    def picture(*inputs: torch.Tensor) -> torch.Tensor:
        light, heat, camera, white = inputs[4:]
        taken = Capture(light, 1000 * heat, camera, white)
        return decoder(*inputs[:4], capture=taken)

    heat = (kelvin / 1000).detach().requires_grad_()
    assert torch.autograd.gradcheck(picture, (*f, *others, lamp, heat, device, balance))


@MODES
@pytest.mark.parametrize(
    ("name", "value"), [("d_epd", 0.021), ("r_vessel", 20e-4), ("r_vessel", 0.0), ("f_oxy", 0.75)]
)
def test_a_trainable_constant_has_its_gradient_in_both_modes(
    fast: bool, name: str, value: float
) -> None:
    start = torch.tensor(value, dtype=D)
    optics = SkinOptics.preset("calibrated", **{name: nn.Parameter(start)})
    decoder, f = SkinDecoder(optics, fast=fast, dtype=D), maps(2, 3)
    names = [key for key, _ in decoder.named_parameters()]
    assert len(names) == 1 and names[0].endswith(f"reflectance.{name}")
    assert torch.autograd.gradcheck(
        lambda constant: functional_call(decoder, {names[0]: constant}, tuple(f)),
        start.clone().requires_grad_(),
        eps=1e-8,
        atol=1e-4,
    )


@MODES
def test_constants_have_one_gradient_in_both_modes(fast: bool) -> None:
    def slope(fast: bool) -> torch.Tensor:
        constant = nn.Parameter(torch.tensor(20e-4, dtype=D))
        decoder = SkinDecoder(SkinOptics(r_vessel=constant), fast=fast, dtype=D)
        decoder(*maps(16, 16)).sum().backward()
        assert constant.grad is not None
        return constant.grad

    assert slope(fast).item() == pytest.approx(slope(False).item(), rel=0.01)


@MODES
def test_image_is_shading_times_skin_plus_specular_times_white_plus_offset(
    random_capture: Callable[..., Capture], fast: bool
) -> None:
    decoder, capture = SkinDecoder(fast=fast, dtype=D), random_capture(2)
    f_mel, f_blood, shading, specular = maps(2, 5, 4, count=4)
    (offset,) = maps(2, 3, 5, 4, count=1, seed=3)
    skin = decoder(f_mel, f_blood, capture=capture)
    white = decoder.camera.white(capture)[:, :, None, None]
    expected = shading[:, None] * skin + specular[:, None] * white + offset
    actual = decoder(f_mel, f_blood, shading, specular, offset, capture)
    assert torch.allclose(actual, expected, atol=1e-12)


@MODES
@given(shape=st.lists(st.integers(1, 3), max_size=3))
def test_any_leading_shape(
    random_capture: Callable[..., Capture], fast: bool, shape: list[int]
) -> None:
    decoder, capture = SkinDecoder(fast=fast, dtype=D), random_capture(*shape)
    f_mel, f_blood, shading = maps(*shape, 2, 3, count=3)
    image = decoder(f_mel, f_blood, shading, capture=capture)
    assert image.shape == (*shape, 3, 2, 3)
    first = (0,) * len(shape)
    alone = capture.map(lambda value: value[first])
    expected = decoder(f_mel[first], f_blood[first], shading[first], capture=alone)
    assert torch.allclose(image[first], expected, atol=1e-12)


@MODES
def test_single_precision_is_good_to_a_millionth(
    random_capture: Callable[..., Capture], fast: bool
) -> None:
    f, capture = maps(3, 16, 16), random_capture(3)
    double = SkinDecoder(fast=fast, dtype=D)(*f, capture=capture)
    low = capture.map(torch.Tensor.float)
    single = SkinDecoder(fast=fast)(*(value.float() for value in f), capture=low)
    assert single.dtype == torch.float32 and torch.allclose(single.double(), double, atol=5e-6)


@MODES
@pytest.mark.parametrize("value", [3.0, -0.1, float("nan")])
def test_fraction_out_of_range_is_refused_in_words(fast: bool, value: float) -> None:
    f_mel, f_blood = maps(2, 2)
    with pytest.raises(ValueError, match=rf"f_blood is a volume fraction .* got {value:g}"):
        SkinDecoder(fast=fast, dtype=D)(f_mel, torch.full_like(f_blood, value))


@MODES
def test_nothing_is_checked_in_an_exported_graph(fast: bool) -> None:
    decoder = SkinDecoder(fast=fast)
    f = tuple(value.float() for value in maps(2, 4, 5))
    program = torch.export.export(decoder, f, strict=False)
    assert torch.allclose(program.module()(*f), decoder(*f), atol=1e-6)
    assert not [node for node in program.graph.nodes if "aminmax" in str(node.target)]


@MODES
def test_state_dict_round_trip(tmp_path: Path, fast: bool) -> None:
    saved = SkinDecoder(SkinOptics(d_epd=0.03), fast=fast, dtype=D)
    torch.save(saved.state_dict(), tmp_path / "decoder.pt")
    loaded = SkinDecoder(fast=fast, dtype=D)
    loaded.load_state_dict(torch.load(tmp_path / "decoder.pt", weights_only=True))
    assert torch.equal(loaded(*maps(4, 4)), saved(*maps(4, 4)))


def test_both_modes_have_one_state_dict() -> None:
    assert set(SkinDecoder().state_dict()) == set(SkinDecoder(fast=False).state_dict())


def test_state_is_safetensors(tmp_path: Path) -> None:
    save_file(SkinDecoder().state_dict(), tmp_path / "decoder.safetensors")


@MODES
def test_one_capture_serves_a_batch_and_one_map_many_captures(
    random_capture: Callable[..., Capture], fast: bool
) -> None:
    decoder, capture, f = SkinDecoder(fast=fast, dtype=D), random_capture(3), maps(3, 4)
    stacked = [torch.stack([value] * 3) for value in f]
    many = decoder(*f, capture=capture)
    assert torch.allclose(many, decoder(*stacked, capture=capture))
    first = capture.map(lambda value: value[0])
    assert torch.allclose(decoder(*stacked, capture=first)[1], many[0])


@pytest.mark.parametrize("shapes", [((), ()), ((4,), (4,)), ((4, 5), (6, 5))])
def test_an_input_that_is_not_a_map_is_named(shapes: tuple[tuple[int, ...], ...]) -> None:
    f_mel, f_blood = (torch.full(shape, 0.05) for shape in shapes)
    decode = SkinDecoder().forward.__wrapped__  # the checks of shapes under pytest come first
    with pytest.raises(ValueError, match="maps"):
        decode(SkinDecoder(), f_mel, f_blood)
