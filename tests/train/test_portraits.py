"""Photographs as training data."""

import csv
import sys
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch
from lightning import Trainer
from PIL import Image
from skimage.data import astronaut
from toned_pictures import TONES
from torch.utils.data import DataLoader

from skinnet.errors import InputError
from skinnet.images import srgb_to_linear
from skinnet.images._mark import EDITED, PROCESSING_SOFTWARE, Mark, read_mark
from skinnet.images._png_file import write_png
from skinnet.network import read_checkpoint
from train.callbacks import LastCheckpoint, PictureGrid
from train.cli import main
from train.portraits import (
    EXPOSURE_SD,
    WHITE_BALANCE_SD,
    Crop,
    Crops,
    Portraits,
    augment,
    find_crops,
    write_skipped,
)
from train.synthetic.casts.head_cast import make_blank_cast
from train.synthetic.faces import SyntheticFaces
from train.synthetic.scene import HeadBuffers


def test_a_face_is_found_cropped_and_masked(tmp_path: Path) -> None:
    Image.fromarray(astronaut()).save(tmp_path / "astronaut.png")
    (crop,), skipped = find_crops(tmp_path, 64)
    assert not skipped
    assert crop.photograph.shape == (64, 64, 3) and crop.mask.shape == (64, 64)
    assert 0.08 < (crop.mask > 127).mean() < 0.6


def test_pictures_without_a_face_are_skipped_and_counted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Image.fromarray(astronaut()).save(tmp_path / "a.png")
    Image.new("RGB", (80, 80)).save(tmp_path / "black.png")
    (tmp_path / "broken.jpg").write_bytes(b"no picture")
    crops, skipped = find_crops(tmp_path, 32, unreadable_share=0.4)
    assert len(crops) == 1
    assert [each.path.name for each in skipped] == ["black.png", "broken.jpg"]
    (message,) = capsys.readouterr().err.splitlines()
    assert "1 faces, 2 pictures skipped" in message
    assert "1 without a face; 1 unreadable" in message and "broken.jpg" in message


def test_pictures_without_colour_are_skipped_and_counted(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    Image.fromarray(astronaut()).save(tmp_path / "a.png")
    Image.fromarray(astronaut()).convert("L").save(tmp_path / "grey.png")
    Image.fromarray(TONES["sepia"](astronaut())).save(tmp_path / "sepia.jpg")
    crops, skipped = find_crops(tmp_path, 32, unreadable_share=0.0)
    assert len(crops) == 1
    assert [each.path.name for each in skipped] == ["grey.png", "sepia.jpg"]
    grey, sepia = (each.reason for each in skipped)
    assert grey == "It has no colour: the skin in it is grey."
    assert sepia.startswith("It has no colour: it has one tone of brown")
    message = capsys.readouterr().err
    assert "1 faces, 2 pictures skipped (2 without colour)" in message


def test_more_unreadable_pictures_than_the_share_are_refused(tmp_path: Path) -> None:
    Image.fromarray(astronaut()).save(tmp_path / "a.png")
    for number in range(9):
        (tmp_path / f"broken_{number}.jpg").write_bytes(b"no picture")
    with pytest.raises(
        InputError, match=r"9 of 10 pictures in .* cannot be read .90%; at most 80%"
    ) as no:
        find_crops(tmp_path, 32, unreadable_share=0.8)
    message = str(no.value)
    assert "broken_4.jpg and 4 more" in message and "unreadable_share" in message
    assert len(find_crops(tmp_path, 32, unreadable_share=0.9)[1]) == 9


def test_files_of_other_kinds_are_passed_over_and_listed(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "rawpy", None)
    face = Image.fromarray(astronaut())
    (tmp_path / "deep" / "skinmaps").mkdir(parents=True)
    for name in ("a.jfif", "deep/b", "deep/c.JPG_large"):
        face.save(tmp_path / name, "JPEG")
    exif = Image.Exif()
    exif[PROCESSING_SOFTWARE] = str(Mark("edit", EDITED))
    face.save(tmp_path / "a_edited.jpg", exif=exif)
    mark = Mark("predict", "reconstruction").to_text()
    write_png(tmp_path / "deep" / "skinmaps" / "a_reconstruction.png", astronaut(), mark)
    (tmp_path / "raw.nef").write_bytes(b"II*\0" + bytes(20))
    (tmp_path / "\udcff.txt").write_text("odd")
    (tmp_path / ".hidden.jpg").write_bytes(b"")
    crops, skipped = find_crops(tmp_path, 32)
    assert len(crops) == 3
    write_skipped(skipped, tmp_path / "run" / "skipped.csv")
    reasons = {
        Path(row["picture"]).name: row["reason"] for row in rows(tmp_path / "run/skipped.csv")
    }
    assert reasons == {
        "a_edited.jpg": "It is a result of skinnet; give the photograph itself.",
        "a_reconstruction.png": "It is a result of skinnet; give the photograph itself.",
        "raw.nef": 'It is a RAW file; pip install "skinnet[raw]" reads it; or develop it, and save '
        "it as 16-bit TIFF or JPEG.",
        "\\udcff.txt": "It is another file; give a JPEG, PNG, TIFF or WebP file.",
    }
    count = capsys.readouterr().err.splitlines()[-1]
    assert "4 passed over: 2 results of skinnet (a_edited.jpg, a_reconstruction.png)" in count
    assert "1 RAW file (raw.nef)" in count


def test_a_folder_without_faces_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"holds no photographs; they are JPEG, PNG"):
        find_crops(tmp_path, 32)
    with pytest.raises(InputError, match="not a folder"):
        find_crops(tmp_path / "absent", 32)
    Image.new("RGB", (80, 80)).save(tmp_path / "black.png")
    with pytest.raises(InputError, match="holds no photograph with a face"):
        find_crops(tmp_path, 32)


def fit(photographs: Path, casts: Path, run: Path, *arguments: str) -> int:
    """Two epochs of three steps of two of seven photographs."""
    data = (f"folder={photographs}", "size=16", "batch_size=2", "unreadable_share=0.2")
    heads = ("heads=1", "val_heads=1", f"geometry={casts}")
    synthetic = ("size=16", "batch_size=2", "val_samples=2", *heads)
    return main([
        *("fit", "--config=configs/portraits.yaml", f"--run={run}", "--model.weights=null"),
        *("--model.widths=[4,8]", *(f"--data.init_args.{each}" for each in data)),
        *(f"--data.init_args.synthetic.{each}" for each in synthetic),
        *("--trainer.precision=32-true", "--trainer.accelerator=cpu", "--trainer.max_epochs=2"),
        *("--trainer.enable_progress_bar=false", "--trainer.log_every_n_steps=1", *arguments),
    ])  # fmt: skip


@pytest.fixture(scope="module")
def photographs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("photographs")
    for number in range(8):
        face = astronaut()[:300, : 400 - number] * (1 - 0.05 * number)
        Image.fromarray(face.astype(np.uint8)).save(folder / f"{number}.png")
    (folder / "broken.jpg").write_bytes(b"no picture")
    return folder


def test_a_killed_run_goes_on_as_if_it_had_not_been(
    photographs: Path, casts: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole, parts = tmp_path / "whole", tmp_path / "parts"
    assert fit(photographs, casts, whole) == 0
    assert all(read_mark(path) is not None for path in (whole / "pictures").iterdir())
    (row,) = rows(whole / "skipped.csv")
    assert row["picture"] == str(photographs / "broken.jpg") and "picture" in row["reason"]

    def kill(_: PictureGrid, trainer: Trainer, *__: object) -> None:
        if trainer.global_step == 4:
            raise KeyError("killed")

    monkeypatch.setattr("train.cli.LastCheckpoint", partial(LastCheckpoint, seconds=0.0))
    with monkeypatch.context() as context:
        context.setattr(PictureGrid, "on_train_batch_start", kill)
        with pytest.raises(KeyError):
            fit(photographs, casts, parts)
    assert read_checkpoint(parts / "last.ckpt")["global_step"] == 4
    assert fit(photographs, casts, parts, f"--ckpt_path={parts / 'last.ckpt'}") == 0
    (one, other) = (read_checkpoint(run / "last.ckpt")["state_dict"] for run in (whole, parts))
    assert all(torch.equal(one[name], other[name]) for name in one)
    assert logged(whole) == logged(parts)


def rows(path: Path) -> list[dict[str, str]]:
    with path.open(encoding="utf-8") as file:
        return list(csv.DictReader(file))


def logged(run: Path) -> set[tuple[str, ...]]:
    """Every loss of a run, with its step."""
    found = rows(run / "metrics.csv")
    return {tuple(row.values()) for row in found if row["metric"].startswith("train/")}


def test_every_epoch_shows_every_photograph_once_in_its_own_order(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    grey = [Crop(np.full((2, 2, 3), n, np.uint8), np.zeros((2, 2), np.uint8)) for n in range(20)]
    crops = Crops(grey, seed=1)
    monkeypatch.setattr("train.portraits.augment", lambda crop, rng: crop)
    epochs = [[int(crops[20 * e + i].photograph[0, 0, 0]) for i in range(20)] for e in range(2)]
    assert sorted(epochs[0]) == sorted(epochs[1]) == list(range(20))
    assert epochs[0] != epochs[1]


def test_photographs_vary_by_seed_epoch_and_index_alone() -> None:
    grey = [Crop(np.full((2, 2, 3), 120, np.uint8), np.zeros((2, 2), np.uint8))]
    first, again, other = (Crops(grey, seed) for seed in (1, 1, 2))
    samples = [[crops[index].photograph for index in range(50)] for crops in (first, again, other)]
    np.testing.assert_array_equal(samples[0], samples[1])
    assert (np.array(samples[0]) != samples[2]).any()
    light = np.log(srgb_to_linear(np.array(samples[0])[:, 0, 0]))
    assert 0.7 * EXPOSURE_SD < light[:, 1].std() < 1.3 * EXPOSURE_SD
    warmth = (light[:, 0] - light[:, 1]).std()
    assert 0.7 * WHITE_BALANCE_SD < warmth < 1.3 * WHITE_BALANCE_SD
    assert all((pair.photograph != pair.again).any() for pair in map(first.__getitem__, range(9)))


def test_a_brighter_photograph_clips_and_keeps_its_mask() -> None:
    bright = Crop(np.full((2, 2, 3), 250, np.uint8), np.full((2, 2), 7, np.uint8))
    made = [augment(bright, np.random.default_rng(n)) for n in range(20)]
    assert max(each.photograph.max() for each in made) == 255
    assert all((each.mask == 7).all() for each in made)


def test_sizes_that_differ_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="cut to 192 pixels and synthetic faces have 160"):
        Portraits(str(tmp_path), size=192, synthetic=SyntheticFaces(size=160)).setup("fit")


@pytest.mark.filterwarnings("ignore:.isinstance.treespec")
def test_validation_sees_all_its_photographs_however_few_synthetic_faces(tmp_path: Path) -> None:
    data = Portraits(str(tmp_path), size=16, batch_size=2)
    data.crops = {"val": [Crop(np.zeros((16, 16, 3), np.uint8), np.zeros((16, 16), np.uint8))] * 9}
    synthetic: DataLoader[Any] = DataLoader([{"f_mel": np.zeros(1)}] * 2, 2)  # type: ignore[arg-type]
    sizes = [len(batch["portraits"].photograph) for batch, *_ in data._combine(synthetic)]
    assert sum(sizes) == 9


@pytest.mark.filterwarnings("ignore:.isinstance.treespec")
def test_photographs_kept_for_validation_are_left_as_they_are(tmp_path: Path) -> None:
    data = Portraits(str(tmp_path), size=16, batch_size=2)
    rng = np.random.default_rng(0)
    pictures = rng.integers(0, 255, (4, 16, 16, 3), np.uint8)
    data.crops = {"val": [Crop(each, each[..., 0]) for each in pictures]}
    blank = make_blank_cast(16).to_buffers()
    data.synthetic.buffers = {"val": HeadBuffers(*(one[None] for one in blank))}
    loader = data.val_dataloader().iterables["portraits"]
    loaded = np.concatenate([batch.photograph for batch in loader])
    np.testing.assert_array_equal(loaded, pictures)
