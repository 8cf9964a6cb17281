from pathlib import Path

import numpy as np
import pytest
from flat_decomposer import save

from skinnet.errors import InputError
from skinnet.images import write_png
from skinnet.images._mark import EDITED, Mark
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
