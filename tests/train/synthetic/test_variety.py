"""The mild faces are those of earlier versions, and the two varieties share no file."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from train.synthetic.casts import head_cache
from train.synthetic.faces import SyntheticFaces
from train.synthetic.sampling.face_sampling import sample_face

KNOWN = {
    "val": (6970, 236320, 479772, 5905.27880859375),
    "test": (8608, 210194, 470162, 7364.09423828125),
}
"""Sums of labels, normals, sky visibility and photographs before there was another variety."""


@pytest.mark.parametrize("split", ["val", "test"])
def test_mild_sets_are_those_of_earlier_versions(tmp_path: Path, split: str) -> None:
    data = SyntheticFaces(
        32, val_heads=2, test_heads=2, val_samples=4, test_samples=4, geometry=str(tmp_path)
    )
    assert data.variety == "mild"
    data.setup({"val": "validate", "test": "test"}[split])
    (scenes,) = data.val_dataloader() if split == "val" else data.test_dataloader()
    head = scenes.head
    sums = [int(one.long().sum()) for one in (head.label, head.normal, head.sky_visibility)]
    photographs = data.render(scenes, split).photograph
    assert (*sums, photographs.sum().item()) == pytest.approx(KNOWN[split], abs=1e-3)


@pytest.mark.slow
def test_a_model_is_trained_on_any(tmp_path: Path, fit: Callable[..., int]) -> None:
    assert fit(tmp_path / "run", "--data.init_args.variety", "any") == 0
    assert "variety: any" in (tmp_path / "run" / "config.yaml").read_text()


def test_a_model_says_what_it_saw() -> None:
    assert "variety" not in SyntheticFaces().description
    assert (
        "scenes of procedural heads of the variety any" in SyntheticFaces(variety="any").description
    )


def test_captures_are_named_too() -> None:
    assert "in wide captures" in SyntheticFaces(captures="wide").description
    assert "and 7 portraits" in SyntheticFaces(variety="any", portrait_heads=7).description


def test_hair_and_eyes_of_any_faces_say_nothing_about_the_skin() -> None:
    rng = np.random.default_rng(0)
    faces = [sample_face(rng, True, "any") for _ in range(600)]
    melanin = np.log([face.skin.melanin.fraction.item() for face in faces])
    for colour in ("hair.colour", "features.iris"):
        record, field = colour.split(".")
        values = [getattr(getattr(face, record), field).mean().item() for face in faces]
        assert abs(np.corrcoef(melanin, np.log(values))[0, 1]) < 0.1


def test_training_on_any_sees_the_darkest_skin() -> None:
    rng = np.random.default_rng(0)
    faces = [sample_face(rng, True, "any") for _ in range(200)]
    melanin = [face.skin.melanin.fraction.item() for face in faces]
    assert max(melanin) > 0.38 and min(melanin) < 0.014


def test_portrait_heads_are_mixed_among_the_others(tmp_path: Path) -> None:
    data = SyntheticFaces(
        32, heads=2, val_heads=1, geometry=str(tmp_path), variety="any", portrait_heads=2
    )
    data.setup("fit")
    assert len(data.buffers["train"].label) == 4 and len(data.buffers["val"].label) == 1
    folders = {path.name for path in tmp_path.iterdir() if path.is_dir()}
    assert len(folders) == 2


def test_varieties_have_folders_of_their_own() -> None:
    mild, varied = (head_cache._describe(160, 0, None, one) for one in ("mild", "any"))
    assert mild.folder == "v1-160px-seed0-procedural"
    assert varied.folder == f"v{head_cache.ANY_VERSION}-160px-seed0-any-procedural"
