"""Paths and URLs lead to files; what does not is a sentence."""

from pathlib import Path

import pytest

from skinnet.batch._places import find_place
from skinnet.errors import InputError


@pytest.mark.parametrize("root", ["", "file://", "memory://"])
def test_files_are_written_listed_moved_and_read(root: str, tmp_path: Path) -> None:
    folder = find_place(f"{root}{tmp_path}/a folder" if root != "file://" else tmp_path.as_uri())
    folder.make_folder()
    folder.join("b").write(b"1")
    folder.join("b").write(b"22")
    folder.join("a").write(b"333")
    folder.join("b").move(folder.join("a"))
    assert [(place.name, info.size) for place, info in folder.list()] == [("a", 2)]
    assert find_place(folder.join("a").url).read() == b"22"
    folder.join("a").delete()
    assert not folder.join("a").exists()


def test_a_query_is_kept_apart_from_the_url() -> None:
    place = find_place("s3://bucket/a b/c?region=eu-west-1&endpoint_override=localhost:1")
    assert place.path == "bucket/a b/c" and place.url == "s3://bucket/a b/c"
    assert place.query == "?region=eu-west-1&endpoint_override=localhost:1"
    assert place.join("d.jpg").url == "s3://bucket/a b/c/d.jpg"


def test_an_unknown_kind_of_url_is_a_sentence() -> None:
    with pytest.raises(InputError, match=r"abc://x/y cannot be used \(Protocol not known: abc\)"):
        find_place("abc://x/y")


def test_a_file_that_is_not_there_is_a_sentence(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"absent\.jpg cannot be used .*; check the path\."):
        find_place(f"{tmp_path}/absent.jpg").read()
