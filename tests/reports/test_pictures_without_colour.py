"""Pictures that are grey or of one tone are refused in words; colour photographs are read."""

import io
import json
from pathlib import Path

import numpy as np
import pytest
from painted_skin import compress_jpeg
from PIL import Image
from toned_pictures import TONES, make_colour, to_grey, to_luma

from skinnet import Decomposer
from skinnet.cli import main
from skinnet.errors import InputError


@pytest.fixture(scope="module")
def decomposer() -> Decomposer:
    return Decomposer(threads=1)


@pytest.fixture(scope="module")
def means(decomposer: Decomposer) -> dict[str, float]:
    """Means over the skin of the astronaut in colour."""
    return dict(decomposer(make_colour(), detail=False).means)


@pytest.mark.parametrize("tone", TONES)
def test_a_toned_picture_is_not_read(decomposer: Decomposer, tone: str) -> None:
    said = r"There is no colour in the image: .*colour photograph|seems to be drawn: .*photograph"
    with pytest.raises(InputError, match=said):
        decomposer(TONES[tone](make_colour()), detail=False)


@pytest.mark.parametrize("mode", ["L", "LA", "1", "P", "I;16", "La", "CMYK"])
def test_a_grey_picture_of_any_mode_is_not_read(decomposer: Decomposer, mode: str) -> None:
    grey = Image.fromarray(to_grey(make_colour())).convert("L")
    if mode == "I;16":
        image = Image.fromarray(np.asarray(grey).astype(np.uint16) * 257)
    elif mode == "CMYK":
        image = grey.convert("RGB").convert("CMYK")
    else:
        image = grey.convert("LA").convert("La") if mode == "La" else grey.convert(mode)
    with pytest.raises(InputError, match=r"There is no colour in the image: .* grey"):
        decomposer(image, detail=False)


@pytest.mark.parametrize("shape", ["[H, W]", "[H, W, 1]", "float"])
def test_a_grey_array_is_not_read(decomposer: Decomposer, shape: str) -> None:
    luma = to_luma(make_colour()).astype(np.uint8)
    array = {"[H, W]": luma, "[H, W, 1]": luma[..., None], "float": luma / 255}[shape]
    for whole in (False, True):
        with pytest.raises(InputError, match="no colour in the image"):
            decomposer(array, whole, detail=False)
    with pytest.raises(InputError, match="no colour in the image"):
        decomposer.edit(array, melanin=2.0)


def save(photo: np.ndarray, path: Path) -> Path:
    options = {"quality": 90} if path.suffix in (".jpg", ".webp") else {}
    Image.fromarray(photo).save(path, **options)
    return path


@pytest.mark.parametrize("suffix", ["png", "jpg", "tif", "webp", "bmp", "gif"])
def test_the_rest_of_a_folder_is_read(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    means: dict[str, float],
    suffix: str,
) -> None:
    sepia = save(TONES["sepia"](make_colour()), tmp_path / f"old.{suffix}")
    colour = save(make_colour(), tmp_path / "today.png")
    assert main(["predict", str(tmp_path), "--json", "--no-detail"]) == 2
    out, err = capsys.readouterr()
    assert f"There is no colour in {sepia}: it has one tone of brown" in err
    summary = json.loads(out)
    assert summary["file"] == str(colour)
    assert summary["maps"]["melanin"]["mean"] == pytest.approx(means["melanin"], rel=0.05)
    assert not list((tmp_path / "skinmaps").glob("old*"))


@pytest.mark.parametrize("tone", ["grey", "sepia", "grey with red lips"])
def test_a_toned_picture_is_not_edited(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], tone: str
) -> None:
    path = save(TONES[tone](make_colour()), tmp_path / "old.png")
    assert main(["edit", str(path), "--melanin", "2"]) == 2
    assert f"There is no colour in {path}" in capsys.readouterr().err
    assert [each.name for each in tmp_path.iterdir()] == ["old.png"]


def test_standard_input_without_colour(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = save(TONES["cyanotype"](make_colour()), tmp_path / "old.png")
    monkeypatch.setattr(
        "sys.stdin", io.TextIOWrapper(io.BytesIO(path.read_bytes()), encoding="utf-8")
    )
    assert main(["predict", "-", "-o", str(tmp_path / "out")]) == 2
    assert (
        "There is no colour in standard input: it has one tone of blue" in capsys.readouterr().err
    )


@pytest.mark.parametrize("quality", [90, 50])
def test_the_colour_photograph_is_read(
    decomposer: Decomposer, means: dict[str, float], quality: int
) -> None:
    assert all(0.01 < mean < 0.1 for mean in means.values())
    read = decomposer(compress_jpeg(make_colour(), quality), detail=False)
    assert read.means == pytest.approx(means, rel=0.15)


@pytest.mark.parametrize("skin", [(200, 150, 130), (150, 105, 85), (90, 60, 45)])
def test_a_patch_of_skin_is_read_as_a_whole(
    decomposer: Decomposer, skin: tuple[int, int, int]
) -> None:
    read = decomposer(np.full((160, 160, 3), skin, np.uint8), whole_image=True, detail=False)
    assert 0 < read.melanin.mean() < 0.5
