import unicodedata
from pathlib import Path

import pytest

from skinnet.images._result_names import choose_stem, compute_digest, describe_input, is_input

ENDS = (".json", "_mask.png")


def never(path: Path) -> bool:
    return False


@pytest.mark.parametrize(
    ("there", "stem", "chosen"),
    [
        ([], "a", "a"),
        (["b.json", "a.jpg", "a_panel.png"], "a", "a"),
        (["a.json"], "a", "a-2"),
        (["a_mask.png"], "a", "a-2"),
        (["a.json", "a-2_mask.png"], "a", "a-3"),
        (["a-2.json"], "a", "a"),
        (["A.JSON"], "a", "a-2"),
        (["a_Mask.png"], "A", "A-2"),
        (["straße.json"], "STRASSE", "STRASSE-2"),
        ([unicodedata.normalize("NFD", "é.json")], unicodedata.normalize("NFC", "é"), "é-2"),
    ],
)
def test_a_name_that_is_taken_gets_a_number(
    tmp_path: Path, there: list[str], stem: str, chosen: str
) -> None:
    for name in there:
        (tmp_path / name).write_text("")
    assert choose_stem(tmp_path, stem, ENDS, never) == chosen


def test_an_input_finds_its_own_number(tmp_path: Path) -> None:
    for name, owner in (("a.json", "other"), ("a-2.json", "mine"), ("a-3.json", "mine")):
        (tmp_path / name).write_text(owner)
    mine = choose_stem(tmp_path, "a", ENDS, lambda path: path.read_text() == "mine")
    assert mine == "a-2"


def test_folders_and_broken_links_take_names_too(tmp_path: Path) -> None:
    (tmp_path / "a.json").mkdir()
    (tmp_path / "a-2.json").symlink_to("nowhere")
    assert choose_stem(tmp_path, "a", ENDS, Path.is_file) == "a-3"
    assert choose_stem(tmp_path / "absent", "a", ENDS, never) == "a"


def test_an_input_is_known_by_path_and_content(tmp_path: Path) -> None:
    out = tmp_path / "out"
    out.mkdir()
    photo, copy = tmp_path / "a.jpg", tmp_path / "b.jpg"
    for path in (photo, copy):
        path.write_bytes(b"one")
    digest = compute_digest(photo)
    assert digest == "7692c3ad3540bb803c020b3aee66cd8887123234ea0c6e7143c0add73ff431ed"
    record = describe_input(photo, digest, out)
    assert record == {"path": "../a.jpg", "sha256": digest}
    assert is_input(record, photo, digest, out)
    assert not is_input(record, copy, digest, out)
    assert not is_input(record, photo, "0" * 64, out)
    assert not is_input({}, photo, digest, out)
    photo.unlink()  # it was moved
    assert is_input(record, copy, digest, out)


def test_standard_input_is_known_by_content(tmp_path: Path) -> None:
    record = describe_input(None, "1", tmp_path)
    assert is_input(record, None, "1", tmp_path)
    assert not is_input(record, None, "2", tmp_path)
    assert not is_input(record, tmp_path / "a.jpg", "1", tmp_path)


def test_a_link_and_its_file_are_one_input(tmp_path: Path) -> None:
    (tmp_path / "a.jpg").write_bytes(b"one")
    (tmp_path / "link.jpg").symlink_to("a.jpg")
    record = describe_input(tmp_path / "a.jpg", "1", tmp_path)
    assert is_input(record, tmp_path / "link.jpg", "1", tmp_path)
