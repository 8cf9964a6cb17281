"""Skins of a hybrid model on the twin's charts."""

from pathlib import Path

import numpy as np
import pytest
import torch
from torch.utils.data import default_collate

from examples import london
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.appearance.stack_writer import write_stack
from skinnet.errors import InputError
from skinnet.physics import load_spectrum_to_srgb
from skinnet.shape import compute_chart_angles
from train.synthetic.face_painting import paint_skin
from train.synthetic.faces import Lots, SyntheticFaces
from train.synthetic.model_skins import Skins, load_skins, save_skins
from train.synthetic.scene_sampling import CHART, draw_lot
from train.synthetic.skins import bare, draw_skins, filled, main, procedural_place

SIZE = 64
BROW = (0.35, 0.215)


def person(number: int) -> SkinTexture:
    """Own melanin, a spot on the left forehead, brows, and a texture the face does not fill."""
    draw = np.random.default_rng(number)
    v, u = 1 - (np.mgrid[:SIZE, :SIZE] + 0.5) / SIZE
    azimuth, elevation = 2 * (1 - 2 * u), 1.5 * (2 * v - 1)
    spot = np.exp(-((azimuth - 0.4) ** 2 + (elevation - 0.5) ** 2) / 0.02)
    brow = np.hypot(np.abs(azimuth) - BROW[0], elevation - BROW[1]) < 0.07
    mel = draw.uniform(0.03, 0.1) * np.exp(draw.normal(0.8, 0.2) * spot) * np.where(brow, 3, 1)
    blood = draw.uniform(0.03, 0.06) * (1 + 0.1 * draw.random((SIZE, SIZE)))
    mask = (azimuth / 1.25) ** 2 + ((elevation + 0.175) / 0.975) ** 2 < 1
    offset = np.zeros((SIZE, SIZE, 3), np.float32)
    return SkinTexture(mel.astype(np.float32), blood.astype(np.float32), offset, mask)


@pytest.fixture(scope="module")
def model(tmp_path_factory: pytest.TempPathFactory) -> HybridModel:
    folder = tmp_path_factory.mktemp("people")
    people = {str(i): lambda i=i: person(i) for i in range(5)}
    colour = SkinColour(load_spectrum_to_srgb("D65", "mean").numpy())
    return HybridModel.fit(write_stack(folder, people, colour, "people"))


@pytest.fixture(scope="module")
def place() -> np.ndarray:
    return procedural_place(own_uv=True)


@pytest.fixture(scope="module")
def skins(model: HybridModel, place: np.ndarray) -> Skins:
    return draw_skins(model, place, 3, seed=1)


def texel(azimuth: float, elevation: float) -> tuple[int, int]:
    across, along = compute_chart_angles(*CHART)
    return int((along - elevation).abs().argmin()), int((across - azimuth).abs().argmin())


def lots(count: int, skins: Skins | None) -> list[dict[str, np.ndarray]]:
    return [Lots({"label": np.zeros((2, 8, 8))}, "train", count, 0, skins)[i] for i in range(count)]


def test_its_own_space_is_the_chart(place: np.ndarray) -> None:
    for azimuth, elevation in ((0.0, 0.0), (0.5, -0.6), (-1.0, 0.2)):
        u, v = place[texel(azimuth, elevation)]
        assert (u, v) == pytest.approx(
            ((azimuth / 2 + 1) / 2, (elevation / 1.5 + 1) / 2), abs=0.006
        )
    assert np.isnan(place[texel(1.8, 0.0)]).all()


def test_the_embedding_is_mirrored_as_the_chart_is() -> None:
    place = procedural_place()
    assert np.nanmin(place) > 0 and np.nanmax(place) < 1
    # But for slivers along the border, where squares are cut in ways that do not mirror.
    uneven = np.abs(place[..., 0] + place[:, ::-1, 0] - 1)
    assert np.nanpercentile(uneven, 98) < 5e-3
    assert place[texel(0, 0.5)][1] > place[texel(0, -0.5)][1]


def test_portraits_features_come_to_the_charts(shared_data: Path) -> None:
    files = sorted((shared_data / "faces" / "london").glob("*.tem"))
    if not files:
        pytest.skip("There are no portraits in ../shared/data/faces/london.")
    mean = london.frame([london.landmarks(file) for file in files[::9]])
    place = london.chart_place(mean)
    for (right, left), (azimuth, elevation) in london.PLACES:
        for number, side in ((right, -azimuth), (left, azimuth)):
            assert np.abs(place[texel(side, elevation)] - mean[number]).max() < 0.03
    assert np.isnan(place[texel(1.5, 0.0)]).all()
    steps = np.diff(place, axis=1)[..., 0], -np.diff(place, axis=0)[..., 1]
    face = np.abs(compute_chart_angles(*CHART)[1].ravel().numpy()) < 1.0
    assert all(np.nanmin(step[face[: len(step)]]) > 0 for step in steps)  # nothing folds


def test_skins_are_factors_of_the_face_itself(skins: Skins) -> None:
    for charts in skins:
        assert charts.shape == (3, *CHART) and charts.dtype == np.float16
        assert np.abs(charts.astype(float).mean((1, 2))).max() < 1e-3
        assert (charts[:, [0, -1]] == 0).all() and (charts[:, :, [0, -1]] == 0).all()
        # No seam where the model ends.
        assert np.abs(np.diff(charts[:, :, 30:48].astype(float), axis=2)).max() < 0.1


def test_a_spot_stays_in_its_place_and_brows_go(model: HybridModel, place: np.ndarray) -> None:
    # The mean face, of whose structure a part is left.
    melanin = draw_skins(model, place, 1, spread=0).melanin[0].astype(float)
    spot, other = (melanin[texel(side, 0.5)] for side in (0.4, -0.4))
    assert 0.03 < spot - other < 0.3
    brow, beside = melanin[texel(-0.35, 0.215)], melanin[texel(0, 0.215)]
    assert abs(brow - beside) < 0.03


def test_people_differ_where_they_do(model: HybridModel, place: np.ndarray) -> None:
    melanin = draw_skins(model, place, 12, seed=2).melanin.astype(float)
    spot, other = (melanin[:, *texel(side, 0.5)].std() for side in (0.4, -0.4))
    assert spot > 2 * other
    brow, beside = melanin[:, *texel(-0.35, 0.215)], melanin[:, *texel(0, 0.215)]
    assert np.abs(brow - beside).max() < 0.15  # of log 3


def test_draws_are_repeated_and_have_their_spread(model: HybridModel, place: np.ndarray) -> None:
    twice = [draw_skins(model, place, 2, seed=4) for _ in range(2)]
    assert all(np.array_equal(a, b) for a, b in zip(*twice, strict=True))
    mean = draw_skins(model, place, 2, spread=0).melanin
    assert np.array_equal(mean[0], mean[1])
    with pytest.raises(InputError, match="count of 1 or more"):
        draw_skins(model, place, 0)
    with pytest.raises(InputError, match="hardly any texel"):
        draw_skins(model, np.full_like(place, np.nan), 1)


def test_gaps_are_filled_from_around_and_lips_are_kept() -> None:
    skin, _ = bare()
    kept = skin[texel(0, -0.70)]
    assert kept > 0.8 and skin[texel(0.34, 0.02)] < 0.1 and skin[texel(0.0, -0.95)] < 0.1
    values = np.where(skin > 0.99, 0.3, 5.0)[None]
    sure = (skin > 0.99).astype(float)
    assert np.abs(filled(values, sure, sure) - 0.3).max() < 1e-9


def test_half_wear_a_skin_and_nothing_else_changes(skins: Skins) -> None:
    dressed, plain = lots(40, skins), lots(40, None)
    worn = np.array([one["worn"] for one in dressed])
    assert 10 < worn.sum() < 30 and set(worn) == {0, 1}
    for one, other in zip(dressed, plain, strict=True):
        for name in one.keys() - {"worn", "skin_melanin", "skin_blood"}:
            assert np.array_equal(one[name], other[name])
        for name in ("skin_melanin", "skin_blood"):
            assert one[name].shape == (1, *CHART) and one[name].dtype == np.float32
            assert one[name].any() == bool(one["worn"]) and not other[name].any()


def test_both_ways_round_are_worn(skins: Skins) -> None:
    row, column = texel(0.4, 0.5)
    spots = [one["skin_melanin"][0, row] for one in lots(40, skins) if one["worn"]]
    assert {bool(spot[column] > spot[-1 - column]) for spot in spots} == {True, False}


def test_worn_skins_are_painted() -> None:
    lot = draw_lot(np.random.default_rng(0), 8)
    for name in lot:
        if name.startswith(("melanin_", "blood_")) or name in ("freckles", "spots", "vessels"):
            lot[name] = np.zeros_like(lot[name])
    lot["moles"] = np.zeros_like(lot["moles"])
    dressed = lot | {"worn": np.float32(1), "skin_blood": np.full((1, *CHART), 0.2, np.float32)}
    plain, worn = (paint_skin(default_collate([one])) for one in (lot, dressed))
    ratio = worn.hemoglobin / plain.hemoglobin
    torch.testing.assert_close(ratio, torch.full_like(ratio, float(np.exp(0.2))))
    torch.testing.assert_close(worn.melanin, plain.melanin)


def test_the_command_writes_what_the_twin_reads(model: HybridModel, tmp_path: Path) -> None:
    model.save(tmp_path / "hybrid.npz")
    out = tmp_path / "skins.npz"
    words = [str(tmp_path / "hybrid.npz"), "-o", str(out), "--count", "2", "--own-uv"]
    assert main(words) == 0
    assert load_skins(out).blood.shape == (2, *CHART)
    assert main([str(tmp_path / "none.npz"), "-o", str(out)]) == 2


def test_bad_files_are_named(skins: Skins, tmp_path: Path) -> None:
    bad = tmp_path / "bad.npz"
    holes = skins.melanin.copy()
    holes[0, 0, 0] = np.nan
    cases = [
        ({"melanin": skins.melanin}, "lacks"),
        ({"melanin": skins.melanin[:, 1:], "blood": skins.blood}, "should be"),
        ({"melanin": skins.melanin, "blood": skins.blood[1:]}, "should be"),
        ({"melanin": skins.melanin[:0], "blood": skins.blood[:0]}, "should be"),
        ({"melanin": holes, "blood": skins.blood}, "no finite number"),
    ]
    for arrays, said in cases:
        np.savez(bad, **arrays)
        with pytest.raises(InputError, match=rf"bad\.npz.*{said}"):
            load_skins(bad)
    bad.write_bytes(b"PK")
    with pytest.raises(InputError, match=r"bad\.npz cannot be read"):
        SyntheticFaces(heads=1, skins=str(bad)).setup("validate")
    with pytest.raises(InputError, match="does not end in"):
        save_skins(tmp_path / "skins.txt", skins)
