import os
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from time import sleep

import numpy as np
import pytest
from flat_decomposer import save

from skinnet.errors import InputError
from skinnet.images._mark import EDITED, Mark
from skinnet.images._png_file import write_png
from skinnet.images._result_names import compute_digest, lock_folder
from skinnet.inference._own_results import Source, choose_edit_target, choose_result_stem

ENDS = (".json", "_offset_r.png")


def make_source(path: Path) -> Source:
    return Source(str(path), path, compute_digest(path))


def test_standard_input_has_a_name() -> None:
    source = Source("standard input", None, "0")
    assert source.stem == "stdin" and source.folder == Path()
    assert source.describe(Path("out")) == {"path": None, "sha256": "0"}


def test_pictures_without_a_summary_are_known_by_their_mark(tmp_path: Path) -> None:
    source = make_source(save(tmp_path / "a.png"))
    picture = save(tmp_path / "a_offset_r.png")
    assert choose_result_stem(tmp_path, source, ENDS) == "a-2"
    pixels = np.zeros((2, 2), "uint16")
    for digest, stem in ((source.digest, "a"), ("0" * 64, "a-2"), ("", "a-2")):
        write_png(picture, pixels, Mark("predict", "map", digest).to_text())
        assert choose_result_stem(tmp_path, source, ENDS) == stem
    write_png(picture, pixels, Mark("edit", EDITED, source.digest).to_text())
    assert choose_result_stem(tmp_path, source, ENDS) == "a-2"


def test_targets_of_edits(tmp_path: Path) -> None:
    source = make_source(save(tmp_path / "a.png"))
    own, other = tmp_path / "a_edited.png", tmp_path / "b.png"
    assert choose_edit_target(source, None, ".png") == own
    assert choose_edit_target(source, other, ".png") == other
    save(own)
    assert choose_edit_target(source, None, ".png") == tmp_path / "a_edited-2.png"
    with pytest.raises(InputError, match="is not an edit of"):
        choose_edit_target(source, own, ".png")
    pixels = np.zeros((2, 2, 3), "uint8")
    write_png(own, pixels, Mark("edit", EDITED, source.digest).to_text())
    assert choose_edit_target(source, None, ".png") == own
    assert choose_edit_target(source, own, ".png") == own
    with pytest.raises(InputError, match="is the photograph itself"):
        choose_edit_target(source, source.path, ".png")


def test_a_folder_that_cannot_be_locked_is_used_all_the_same(tmp_path: Path) -> None:
    with lock_folder(tmp_path / "absent"), lock_folder(tmp_path):
        assert choose_result_stem(tmp_path, Source("a", None, ""), ENDS) == "stdin"


def test_two_processes_do_not_choose_the_same_name(tmp_path: Path) -> None:
    sources = [make_source(save(tmp_path / str(i) / "a.png", (i, 40, 20))) for i in range(8)]
    out = tmp_path / "out"
    out.mkdir()

    def write(source: Source) -> None:
        with lock_folder(out):
            stem = choose_result_stem(out, source, (".json",))
            sleep(0.01)
            (out / f"{stem}.json").write_text(source.digest)

    with ThreadPoolExecutor(8) as pool:
        list(pool.map(write, sources))
    assert {path.read_text() for path in out.iterdir()} == {source.digest for source in sources}


@pytest.mark.parametrize("name", ["a.json", "a_offset_r.png", "a_edited.png"])
def test_a_pipe_of_such_a_name_is_not_waited_for(tmp_path: Path, name: str) -> None:
    source = make_source(save(tmp_path / "a.png"))
    os.mkfifo(tmp_path / name)
    assert choose_result_stem(tmp_path, source, ENDS) == ("a" if "edited" in name else "a-2")
    numbered = "a_edited-2.png" if "edited" in name else "a_edited.png"
    assert choose_edit_target(source, None, ".png").name == numbered
