"""Skins of a hybrid model on the charts of synthetic faces."""

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
from skinnet.shape._procedural_head import compute_chart_angles
from train.synthetic.casts.head_cast import make_blank_cast
from train.synthetic.faces import SyntheticFaces, SyntheticScenes
from train.synthetic.painting.face_painting import paint_face
from train.synthetic.sampling.model_skins import ModelSkins, load_model_skins, save_model_skins
from train.synthetic.sampling.scene_sampling import sample_scene
from train.synthetic.sampling.skin_charts import fill_gaps, find_bare_skin
from train.synthetic.scene import CHART_SIZE, FaceParameters, HeadBuffers, map_tensors
from train.synthetic.skins import find_procedural_places, main, sample_model_skins

SIZE = 64
BROW = (0.35, 0.215)
OCTAVES = ("coarse", "middle", "fine")


def person(number: int) -> SkinTexture:
    """Own melanin, a spot on the left forehead, brows, and a texture the face does not fill."""
    rng = np.random.default_rng(number)
    v, u = 1 - (np.mgrid[:SIZE, :SIZE] + 0.5) / SIZE
    azimuth, elevation = 2 * (1 - 2 * u), 1.5 * (2 * v - 1)
    spot = np.exp(-((azimuth - 0.4) ** 2 + (elevation - 0.5) ** 2) / 0.02)
    brow = np.hypot(np.abs(azimuth) - BROW[0], elevation - BROW[1]) < 0.07
    mel = rng.uniform(0.03, 0.1) * np.exp(rng.normal(0.8, 0.2) * spot) * np.where(brow, 3, 1)
    blood = rng.uniform(0.03, 0.06) * (1 + 0.1 * rng.random((SIZE, SIZE)))
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
    return find_procedural_places(own_uv=True)


@pytest.fixture(scope="module")
def skins(model: HybridModel, place: np.ndarray) -> ModelSkins:
    return sample_model_skins(model, place, 3, seed=1)


def remove_model_skin(face: FaceParameters) -> FaceParameters:
    """The face without its skin of a model."""
    bare = {
        name: pigment._replace(model_skin=torch.zeros_like(pigment.model_skin))
        for name, pigment in (("melanin", face.skin.melanin), ("hemoglobin", face.skin.hemoglobin))
    }
    return face._replace(skin=face.skin._replace(has_model_skin=torch.tensor(0.0), **bare))


def list_tensors(face: FaceParameters) -> list[torch.Tensor]:
    tensors: list[torch.Tensor] = []
    map_tensors(lambda value: tensors.append(value) or value, face)
    return tensors


def texel(azimuth: float, elevation: float) -> tuple[int, int]:
    across, along = compute_chart_angles(*CHART_SIZE)
    return int((along - elevation).abs().argmin()), int((across - azimuth).abs().argmin())


def sample_faces(count: int, skins: ModelSkins | None) -> list[FaceParameters]:
    heads = HeadBuffers(*(one[None] for one in make_blank_cast(8).to_buffers()))
    scenes = SyntheticScenes(heads, "train", count, 0, skins)
    return [scenes[index].face for index in range(count)]


def test_its_own_space_is_the_chart(place: np.ndarray) -> None:
    for azimuth, elevation in ((0.0, 0.0), (0.5, -0.6), (-1.0, 0.2)):
        u, v = place[texel(azimuth, elevation)]
        assert (u, v) == pytest.approx(
            ((azimuth / 2 + 1) / 2, (elevation / 1.5 + 1) / 2), abs=0.006
        )
    assert np.isnan(place[texel(1.8, 0.0)]).all()


def test_the_embedding_is_mirrored_as_the_chart_is() -> None:
    place = find_procedural_places()
    assert np.nanmin(place) > 0 and np.nanmax(place) < 1
    # But for slivers along the border, where squares are cut in ways that do not mirror.
    uneven = np.abs(place[..., 0] + place[:, ::-1, 0] - 1)
    assert np.nanpercentile(uneven, 98) < 5e-3
    assert place[texel(0, 0.5)][1] > place[texel(0, -0.5)][1]


def test_portraits_features_come_to_the_charts(shared_data: Path) -> None:
    files = sorted((shared_data / "faces" / "london").glob("*.tem"))
    if not files:
        pytest.skip("There are no portraits in ../shared/data/faces/london.")
    mean = london.average_points([london.read_template(file) for file in files[::9]])
    place = london.find_places(mean)
    for (right, left), (azimuth, elevation) in london.PLACES:
        for number, side in ((right, -azimuth), (left, azimuth)):
            assert np.abs(place[texel(side, elevation)] - mean[number]).max() < 0.03
    assert np.isnan(place[texel(1.5, 0.0)]).all()
    steps = np.diff(place, axis=1)[..., 0], -np.diff(place, axis=0)[..., 1]
    face = np.abs(compute_chart_angles(*CHART_SIZE)[1].ravel().numpy()) < 1.0
    assert all(np.nanmin(step[face[: len(step)]]) > 0 for step in steps)  # nothing folds


def test_skins_are_factors_of_the_face_itself(skins: ModelSkins) -> None:
    for charts in skins:
        assert charts.shape == (3, *CHART_SIZE) and charts.dtype == np.float16
        assert np.abs(charts.astype(float).mean((1, 2))).max() < 1e-3
        assert (charts[:, [0, -1]] == 0).all() and (charts[:, :, [0, -1]] == 0).all()
        # No seam where the model ends.
        assert np.abs(np.diff(charts[:, :, 30:48].astype(float), axis=2)).max() < 0.1


def test_a_spot_stays_in_its_place_and_brows_go(model: HybridModel, place: np.ndarray) -> None:
    # The mean face, of whose structure a part is left.
    melanin = sample_model_skins(model, place, 1, spread=0).melanin[0].astype(float)
    spot, other = (melanin[texel(side, 0.5)] for side in (0.4, -0.4))
    assert 0.03 < spot - other < 0.3
    brow, beside = melanin[texel(-0.35, 0.215)], melanin[texel(0, 0.215)]
    assert abs(brow - beside) < 0.03


def test_people_differ_where_they_do(model: HybridModel, place: np.ndarray) -> None:
    melanin = sample_model_skins(model, place, 12, seed=2).melanin.astype(float)
    spot, other = (melanin[:, *texel(side, 0.5)].std() for side in (0.4, -0.4))
    assert spot > 2 * other
    brow, beside = melanin[:, *texel(-0.35, 0.215)], melanin[:, *texel(0, 0.215)]
    assert np.abs(brow - beside).max() < 0.15  # of log 3


def test_samples_are_repeated_and_have_their_spread(model: HybridModel, place: np.ndarray) -> None:
    twice = [sample_model_skins(model, place, 2, seed=4) for _ in range(2)]
    assert all(np.array_equal(a, b) for a, b in zip(*twice, strict=True))
    mean = sample_model_skins(model, place, 2, spread=0).melanin
    assert np.array_equal(mean[0], mean[1])
    with pytest.raises(InputError, match="count of 1 or more"):
        sample_model_skins(model, place, 0)
    with pytest.raises(InputError, match="covers hardly any texel"):
        sample_model_skins(model, np.full_like(place, np.nan), 1)


def test_gaps_are_filled_from_around_and_lips_are_kept() -> None:
    skin, _ = find_bare_skin()
    kept = skin[texel(0, -0.70)]
    assert kept > 0.8 and skin[texel(0.34, 0.02)] < 0.1 and skin[texel(0.0, -0.95)] < 0.1
    values = np.where(skin > 0.99, 0.3, 5.0)[None]
    sure = (skin > 0.99).astype(float)
    assert np.abs(fill_gaps(values, sure, sure) - 0.3).max() < 1e-9


def test_half_of_the_faces_get_a_skin_and_nothing_else_changes(skins: ModelSkins) -> None:
    changed, plain = sample_faces(40, skins), sample_faces(40, None)
    applied = np.array([face.skin.has_model_skin.item() for face in changed])
    assert 10 < applied.sum() < 30 and set(applied) == {0, 1}
    for one, other, has_skin in zip(changed, plain, applied, strict=True):
        compared = []
        for face in (one, other):
            for chart in (face.skin.melanin.model_skin, face.skin.hemoglobin.model_skin):
                assert chart.shape == (1, *CHART_SIZE) and chart.dtype == torch.float32
                assert chart.any() == (has_skin and face is one)
            compared.append(list_tensors(remove_model_skin(face)))
        assert all(torch.equal(a, b) for a, b in zip(*compared, strict=True))


def test_skins_are_applied_as_they_are_and_mirrored(skins: ModelSkins) -> None:
    row, column = texel(0.4, 0.5)
    applied = [face.skin for face in sample_faces(40, skins) if face.skin.has_model_skin]
    spots = [skin.melanin.model_skin[0, row] for skin in applied]
    assert {bool(spot[column] > spot[-1 - column]) for spot in spots} == {True, False}


def test_skins_of_a_model_are_painted() -> None:
    face = sample_scene(np.random.default_rng(0), make_blank_cast(8).to_buffers()).face
    zero = {name: 0 * getattr(face.skin.melanin, name) for name in ("regions", *OCTAVES)}
    melanin, hemoglobin = (
        pigment._replace(**zero) for pigment in (face.skin.melanin, face.skin.hemoglobin)
    )
    marks = map_tensors(torch.zeros_like, face.marks)
    skin = face.skin._replace(melanin=melanin, hemoglobin=hemoglobin)
    plain_face = face._replace(skin=skin, marks=marks)
    chart = torch.full((1, *CHART_SIZE), 0.2)
    skin = skin._replace(
        hemoglobin=hemoglobin._replace(model_skin=chart), has_model_skin=torch.tensor(1.0)
    )
    changed_face = plain_face._replace(skin=skin)
    plain, changed = (paint_face(default_collate([one])) for one in (plain_face, changed_face))
    ratio = changed.hemoglobin / plain.hemoglobin
    torch.testing.assert_close(ratio, torch.full_like(ratio, float(np.exp(0.2))))
    torch.testing.assert_close(changed.melanin, plain.melanin)


def test_the_command_writes_what_synthetic_faces_read(model: HybridModel, tmp_path: Path) -> None:
    model.save(tmp_path / "hybrid.npz")
    out = tmp_path / "skins.npz"
    words = [str(tmp_path / "hybrid.npz"), "-o", str(out), "--count", "2", "--own-uv"]
    assert main(words) == 0
    assert load_model_skins(out).hemoglobin.shape == (2, *CHART_SIZE)
    assert main([str(tmp_path / "none.npz"), "-o", str(out)]) == 2


def test_bad_files_are_named(skins: ModelSkins, tmp_path: Path) -> None:
    bad = tmp_path / "bad.npz"
    holes = skins.melanin.copy()
    holes[0, 0, 0] = np.nan
    cases = [
        ({"melanin": skins.melanin}, "lacks"),
        ({"melanin": skins.melanin[:, 1:], "blood": skins.hemoglobin}, "should be"),
        ({"melanin": skins.melanin, "blood": skins.hemoglobin[1:]}, "should be"),
        ({"melanin": skins.melanin[:0], "blood": skins.hemoglobin[:0]}, "should be"),
        ({"melanin": holes, "blood": skins.hemoglobin}, "not finite numbers"),
    ]
    for arrays, said in cases:
        np.savez(bad, **arrays)
        with pytest.raises(InputError, match=rf"bad\.npz.*{said}"):
            load_model_skins(bad)
    bad.write_bytes(b"PK")
    with pytest.raises(InputError, match=r"bad\.npz cannot be read"):
        SyntheticFaces(heads=1, skins=str(bad)).setup("validate")
    with pytest.raises(InputError, match="does not end in"):
        save_model_skins(tmp_path / "skins.txt", skins)
