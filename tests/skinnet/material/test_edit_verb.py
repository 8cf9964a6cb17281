"""`skinnet edit-albedo`: what each edit changes, what it leaves, and what it refuses."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from albedo_textures import paint_skin, read_pixels, write_pixels, write_texture
from numpy.typing import NDArray

from skinnet.cli import main
from skinnet.images.srgb import srgb_to_linear
from skinnet.material import AlbedoColour
from skinnet.material._brushes import parse_brush
from skinnet.material._map_files import WHITES, to_pixels

SIZE = 32
LINES = [3, 9, 20]


@pytest.fixture
def texture(tmp_path: Path) -> Path:
    path = tmp_path / "a.png"
    write_texture(path, paint_skin(SIZE), "uint16")
    return path


def edit(path: Path, *words: object) -> NDArray[Any]:
    """Edit a texture, and read what was written."""
    assert main(["-q", "edit-albedo", str(path), *map(str, words), "-o", str(path.parent)]) == 0
    stem = path.stem.removesuffix("_maps")
    return read_pixels(path.with_name(f"{stem}_edited.png"))


def write_grey(path: Path, values: NDArray[Any]) -> Path:
    """Write a picture of one channel, of the values' own type."""
    write_pixels(path, values[..., None], str(values.dtype), ("Y",))
    return path


def invert(pixels: NDArray[Any]) -> Any:
    """Find the maps of sRGB values of 16 bits."""
    return AlbedoColour().invert(srgb_to_linear((pixels / 65535).astype(np.float32)))


@pytest.mark.parametrize(
    ("words", "map_", "change"),
    [
        (("--melanin", 1.5), 0, lambda f: 1.5 * f),
        (("--melanin", 0.5), 0, lambda f: 0.5 * f),
        (("--hemoglobin", 2), 1, lambda f: 2 * f),
        (("--melanin-add", 0.05), 0, lambda f: f + 0.05),
        (("--hemoglobin-add", -0.01), 1, lambda f: f - 0.01),
        (("--melanin-paint", 0.1), 0, lambda f: 0 * f + 0.1),
        (("--preset", "tan"), 0, lambda f: 1.5 * f),
        (("--preset", "pallor"), 1, lambda f: 0.5 * f),
    ],
)
def test_pigments_of_the_edited_skin(
    texture: Path, words: tuple[Any, ...], map_: int, change: Any
) -> None:
    before = read_pixels(texture)
    after = edit(texture, *words)
    assert (after[LINES] == before[LINES]).all()
    found, start = (np.delete(invert(one)[map_], LINES, 0) for one in (after, before))
    ratio = found / change(start)
    assert np.median(ratio) == pytest.approx(1, abs=0.02), words


def test_factors_are_multiplied_by_those_of_a_preset(texture: Path) -> None:
    both = edit(texture, "--preset", "tan", "--melanin", 0.8)
    assert (both == edit(texture, "--melanin", 1.2)).all()


def test_a_mask_keeps_what_is_black(texture: Path) -> None:
    before, mask = read_pixels(texture), np.zeros((SIZE, SIZE), np.uint8)
    mask[:, 16:], mask[:, 24:] = 128, 255
    after = edit(texture, "--melanin", 2, "--mask", write_grey(texture.with_name("m.png"), mask))
    assert (after[:, :16] == before[:, :16]).all()
    half, full = ((after / before)[25:, part].mean() for part in (slice(16, 24), slice(24, 32)))
    assert full < half < 1


def test_a_painted_map_is_taken_texel_by_texel(texture: Path) -> None:
    painted = np.linspace(0.02, 0.2, SIZE * SIZE, dtype=np.float32).reshape(SIZE, SIZE)
    path = write_grey(texture.with_name("p.png"), to_pixels(painted, "melanin"))
    found = invert(edit(texture, "--melanin-paint", path)).f_mel
    assert np.corrcoef(found[21:].ravel(), painted[21:].ravel())[0, 1] > 0.99


def test_vitiligo_takes_all_melanin_within_its_mask(texture: Path) -> None:
    mask = np.zeros((SIZE, SIZE), np.uint8)
    mask[22:, :16] = 255
    path = write_grey(texture.with_name("m.png"), mask)
    after = srgb_to_linear(edit(texture, "--preset", "vitiligo", "--mask", path) / 65535)
    assert (after[22:, :16] > 1.3 * after[22:, 16:].mean((0, 1))).all()


@pytest.mark.parametrize(
    ("brush", "map_"),
    [
        ("freckles:count=60,size=0.05,radius=0.5", 0),
        ("moles:count=4,size=0.1,radius=0.4", 0),
        ("flush:v=0.3,radius=0.3", 1),
        ("tan-line:v=0.2,width=0.1", 0),
        ("patches:size=0.3", 0),
    ],
)
def test_brushes_change_places_of_one_pigment(texture: Path, brush: str, map_: int) -> None:
    before, seed = read_pixels(texture), "," if ":" in brush else ":"
    after = edit(texture, "--brush", brush)
    changed = (after != before).any(-1)
    assert 0.02 < changed.mean() < 0.98 and not changed[LINES].any()
    start, found = invert(before), invert(after)
    moved = [np.abs(np.log((found[k] + 1e-3) / (start[k] + 1e-3)))[changed].mean() for k in (0, 1)]
    assert moved[map_] > 2 * moved[1 - map_]
    assert (edit(texture, "--brush", brush) == after).all()
    if not brush.startswith("tan"):
        assert (edit(texture, "--brush", f"{brush}{seed}seed=5") != after).any()


@pytest.mark.parametrize("name", ["freckles", "moles"])
def test_spots_have_no_rim(name: str) -> None:
    axis = (np.arange(600) + 0.5) / 600
    word = f"{name}:count=20000,size=0.002,radius=0.4"
    painted = parse_brush(word).paint(axis, axis[::-1]) > 0
    distance = np.hypot(axis - 0.5, axis[::-1, None] - 0.5) / 0.4
    shares = [
        painted[(distance >= low) & (distance < low + 0.1)].mean() for low in np.arange(0, 1, 0.1)
    ]
    assert np.all(np.diff(shares) < 0.02) and shares[-1] < 0.2 * shares[0]


def test_patches_have_their_cover_and_soft_borders() -> None:
    axis = (np.arange(1000) + 0.5) / 1000
    brush = parse_brush("patches:cover=0.4,size=0.05,soft=0.02,radius=10")
    painted = brush.paint(axis, axis[::-1])
    assert (painted > 0.5).mean() == pytest.approx(0.4, abs=0.05)
    down, across = np.gradient(painted, 1 / 1000)
    border = np.hypot(down, across)[(painted > 0.3) & (painted < 0.7)]
    assert 0.5 < 0.02 * np.median(border) < 2
    melanin, hemoglobin = brush.compute_factors(axis, axis[::-1])
    assert melanin.min() < 0.01 and hemoglobin.min() == pytest.approx(0.5, abs=0.01)


def test_patches_shrink_towards_their_radius() -> None:
    axis = (np.arange(400) + 0.5) / 400
    painted = parse_brush("patches:radius=0.4,size=0.03").paint(axis, axis[::-1])
    distance = np.hypot(axis - 0.5, axis[::-1, None] - 0.5) / 0.4
    rim = painted[(distance > 0.96) & (distance < 1)]
    assert painted[distance < 0.8].mean() > 0.2 and rim.mean() < 0.05
    assert not painted[distance > 1].any()


def test_a_brush_is_the_same_at_any_resolution(tmp_path: Path) -> None:
    small, large = (np.full((side, side, 3), (0.5, 0.27, 0.18), np.float32) for side in (32, 96))
    words = ("--brush", "freckles:count=30,size=0.1,radius=0.5,seed=3")
    pictures = []
    for name, linear in (("s.png", small), ("l.png", large)):
        write_texture(tmp_path / name, linear, "uint16")
        pictures.append(edit(tmp_path / name, *words).astype(float))
    shrunk = pictures[1].reshape(32, 3, 32, 3, 3).mean((1, 3))
    contrast = np.ptp(pictures[0])
    assert np.abs(shrunk - pictures[0]).mean() < 0.03 * contrast


def test_the_maps_give_the_same_edit_as_the_texture(texture: Path) -> None:
    words = ("--melanin", 1.5, "--brush", "flush:v=0.2,radius=0.4")
    direct = edit(texture, *words)
    assert main(["-q", "invert", str(texture), "-o", str(texture.parent / "maps")]) == 0
    again = edit(texture.parent / "maps" / "a_maps.json", *words)
    assert (direct == again).all()


@pytest.mark.parametrize("name", ["a.png", "a.tif", "a.exr"])
def test_without_an_edit_and_with_alpha_the_texture_comes_back(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    kind = "half" if path.suffix == ".exr" else "uint8"
    stored = write_texture(path, paint_skin(SIZE), kind, alpha=True)
    assert main(["-q", "edit-albedo", str(path), "--melanin", "1"]) == 0
    assert (read_pixels(tmp_path / f"a_edited{path.suffix}") == stored).all()
    assert main(["-q", "edit-albedo", str(path), "--melanin", "2"]) == 0
    after = read_pixels(tmp_path / f"a_edited{path.suffix}")
    assert (after[..., 3] == stored[..., 3]).all() and (after[:, :5] == stored[:, :5]).all()
    assert (after[25:, 5:, :3] < stored[25:, 5:, :3]).mean() > 0.9


def test_a_set_is_edited_tile_by_tile(tmp_path: Path) -> None:
    tiles = (1001, 1002)
    for tile in tiles:
        write_texture(tmp_path / f"f.{tile}.png", paint_skin(SIZE), "uint8")
        write_grey(
            tmp_path / f"m.{tile}.png", np.full((SIZE, SIZE), 255 * (tile == 1002), np.uint8)
        )
    words = ["--melanin", "2", "--mask", str(tmp_path / "m.<UDIM>.png")]
    assert main(["-q", "edit-albedo", str(tmp_path / "f.<UDIM>.png"), *words]) == 0
    for tile in tiles:
        before = read_pixels(tmp_path / f"f.{tile}.png")
        after = read_pixels(tmp_path / f"f_edited.{tile}.png")
        assert (before != after).any() == (tile == 1002)


def test_a_set_of_masks_that_are_all_black_is_refused(tmp_path: Path, capsys) -> None:
    for tile in (1001, 1002):
        write_texture(tmp_path / f"f.{tile}.png", paint_skin(SIZE), "uint8")
        write_grey(tmp_path / f"m.{tile}.png", np.zeros((SIZE, SIZE), np.uint8))
    words = ["--melanin", "2", "--mask", str(tmp_path / "m.<UDIM>.png")]
    assert main(["edit-albedo", str(tmp_path / "f.<UDIM>.png"), *words]) == 2
    assert "black everywhere" in capsys.readouterr().err
    assert not list(tmp_path.glob("*edited*"))


def test_without_an_edit_an_earlier_one_stays(texture: Path, capsys) -> None:
    edited = edit(texture, "--melanin", 2)
    assert main(["edit-albedo", str(texture)]) == 0
    assert "Nothing is edited" in capsys.readouterr().err
    copies = set(texture.parent.glob("a_edited*")) - {texture.with_name("a_edited.png")}
    assert [(read_pixels(file) == read_pixels(texture)).all() for file in copies] == [True]
    for file in copies:
        file.unlink()
    assert (read_pixels(texture.with_name("a_edited.png")) == edited).all()
    maps = texture.parent / "a_maps.json"
    assert main(["-q", "invert", str(texture), "-o", str(texture.parent)]) == 0
    again = edit(maps, "--melanin", 2)
    assert main(["-q", "edit-albedo", str(maps)]) == 0
    files = sorted(texture.parent.glob("a_edited*"))
    assert len(files) == 3 and (again == edited).all()
    assert sorted((read_pixels(file) == edited).all() for file in files) == [False, True, True]


def test_a_brush_runs_across_the_tiles_of_a_set(tmp_path: Path) -> None:
    flat = np.full((SIZE, SIZE, 3), (0.5, 0.27, 0.18), np.float32)
    for tile in (1001, 1002):
        write_texture(tmp_path / f"f.{tile}.png", flat, "uint16")
    word = "freckles:u=1,count=80,size=0.2,radius=0.4"
    assert main(["-q", "edit-albedo", str(tmp_path / "f.1001.png"), "--brush", word]) == 0
    left, right = (read_pixels(tmp_path / f"f_edited.{k}.png").astype(int) for k in (1001, 1002))
    across = np.abs(left[:, -1] - right[:, 0]).mean()
    within = np.abs(np.diff(left[:, -8:], axis=1)).mean()
    assert 0 < across < 2 * within


def test_a_full_calibration_undoes_a_transform(tmp_path: Path, capsys) -> None:
    transform = np.array([[0.8, 0.1, 0], [0.05, 0.85, 0.05], [0, 0.1, 0.7]], np.float32)
    skin = np.concatenate([paint_skin(48, f_mel=mel) for mel in (0.03, 0.12)])
    skin = np.delete(skin, [k + shift for k in LINES for shift in (0, 48)], 0) @ transform.T
    write_texture(tmp_path / "a.tif", skin, "uint16")
    words = ["--calibration", "full", "--json", "-o", str(tmp_path)]
    assert main(["-q", "invert", str(tmp_path / "a.tif"), *words]) == 0
    assert json.loads(capsys.readouterr().out)["skin_share"] > 0.95
    words[1] = str(tmp_path / "a_maps.json")
    assert main(["-q", "edit-albedo", str(tmp_path / "a.tif"), "--melanin", "1.5", *words]) == 0
    before, after = (read_pixels(tmp_path / name) for name in ("a.tif", "a_edited.tif"))
    assert (after < before).mean() > 0.95


def test_json_says_what_was_done(texture: Path, capsys) -> None:
    words = ["--preset", "blush", "--brush", "moles:seed=2", "--json"]
    assert main(["-q", "edit-albedo", str(texture), *words]) == 0
    record = json.loads(capsys.readouterr().out)
    assert record["hemoglobin"]["scale"] == 2 and record["preset"] == "blush"
    assert record["brushes"][0]["seed"] == 2 and Path(record["files"][0]).is_file()


def test_baked_highlights_are_said(tmp_path: Path, capsys) -> None:
    skin = paint_skin(64)
    skin[30:40, 30:40] += 0.25
    write_texture(tmp_path / "a.png", skin, "uint16")
    assert main(["edit-albedo", str(tmp_path / "a.png"), "--melanin", "1.2"]) == 0
    assert "brighter and whiter than skin" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--melanin", "12"), "scale is a factor from 0 to 10; got 12"),
        (("--melanin", "nan"), "scale is a factor from 0 to 10; got nan"),
        (("--hemoglobin-add", "4"), "add is a volume fraction in [-1, 1]; got 4"),
        (("--melanin-paint", "20"), "paint is a volume fraction in [0, 1]; got 20"),
        (("--melanin-paint", "none.png"), "or a painted map; got none.png"),
        (("--mask", "SMALL"), "is 16 x 16 and the texture 32 x 32"),
        (("--mask", "none.png"), "none.png"),
        (("--melanin-paint", "SMALL"), "is 16 x 16 and the texture 32 x 32"),
        (("--brush", "frekles"), "Did you mean freckles?"),
        (("--brush", "moles:count=0"), "count of the brush moles is 1 to 20000; got 0"),
        (("--brush", "moles:number=3"), "The brush moles takes"),
        (("--brush", "tan-line:radius=0.2"), "The brush tan-line takes u, v, width"),
        (("--light", "candle"), "no light 'candle'"),
        (("--calibration", "some"), "--calibration is none, exposure, full"),
    ],
)
def test_bad_words_are_one_sentence_and_leave_nothing(
    texture: Path, capsys, words: tuple[str, ...], said: str
) -> None:
    small = write_grey(texture.with_name("small.png"), np.full((16, 16), 255, np.uint8))
    before = sorted(texture.parent.iterdir())
    given = [str(small) if word == "SMALL" else word for word in words]
    assert main(["edit-albedo", str(texture), "--hemoglobin", "2", *given]) == 2
    error = capsys.readouterr().err
    assert said in error and len(error.strip().splitlines()) == 1
    assert sorted(texture.parent.iterdir()) == before


def test_a_mask_of_one_tile_is_not_enough_for_a_set(tmp_path: Path, capsys) -> None:
    for tile in (1001, 1002):
        write_texture(tmp_path / f"f.{tile}.png", paint_skin(SIZE), "uint8")
    mask = write_grey(tmp_path / "m.1001.png", np.full((SIZE, SIZE), 255, np.uint8))
    for given in (mask, tmp_path / "m.<UDIM>.png"):
        words = ["--melanin", "2", "--mask", str(given)]
        assert main(["edit-albedo", str(tmp_path / "f.1001.png"), *words]) == 2
        assert "draw one for each tile" in capsys.readouterr().err
    assert not list(tmp_path.glob("*edited*"))


def test_the_scale_of_painted_maps_is_documented() -> None:
    text = Path("docs/albedo.md").read_text(encoding="utf-8")
    assert WHITES["melanin"] == 0.5 and ".5 for melanin, .25 for hemoglobin" in text


@pytest.mark.parametrize("verb", ["invert", "edit-albedo"])
def test_the_name_of_a_file_is_no_folder(
    texture: Path, verb: str, capsys: pytest.CaptureFixture[str]
) -> None:
    target = texture.with_name("edited.png")
    words = ["--melanin", "2"] if verb == "edit-albedo" else []
    assert main([verb, str(texture), *words, "-o", str(target)]) == 2
    assert f"got {target}" in capsys.readouterr().err and not target.exists()


def test_two_presets_are_refused(texture: Path, capsys) -> None:
    words = ["--preset", "tan", "--preset", "blush"]
    assert main(["edit-albedo", str(texture), *words]) == 2
    assert "is given twice" in capsys.readouterr().err


def test_an_edited_texture_is_said_to_be_one(texture: Path, capsys) -> None:
    edit(texture, "--melanin", 2)
    for verb in (["invert"], ["edit-albedo", "--hemoglobin", "2"]):
        assert main([*verb, str(texture.with_name("a_edited.png"))]) == 0
        assert "was edited by skinnet" in capsys.readouterr().err
