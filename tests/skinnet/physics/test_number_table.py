"""Tables of numbers in text files of any kind."""

from pathlib import Path

import numpy as np
import pytest

from skinnet.errors import InputError
from skinnet.physics._number_table import NumberTable, read_number_table


def read(folder: Path, text: str) -> NumberTable:
    (folder / "table.txt").write_text(text, encoding="utf-8")
    return read_number_table(folder / "table.txt", 2, "needs 2 columns")


@pytest.mark.parametrize(
    "text",
    ["1,2.5\n3,4", "1;2,5\n3;4,0", "1\t2.5\n3\t4", " 1  2.5\n 3  4 ", "1,2.5,\n3,4,,",
     '"1","2,5"\n3,4'],
)  # fmt: skip
def test_separators_and_decimals_are_found(tmp_path: Path, text: str) -> None:
    np.testing.assert_array_equal(read(tmp_path, text).values, [[1, 2.5], [3, 4]])


def test_headings_have_a_name_for_each_column(tmp_path: Path) -> None:
    table = read(tmp_path, "# made by us, in May\n# a, b\n[nm], [W]\n\n1,2\n# note\n3,4\n\nend")
    assert table.find_headings() == [["made by us", "in May"], ["a", "b"], ["[nm]", "[W]"]]
    assert table.lines == [5, 7]


def test_a_blank_cell_is_not_a_number(tmp_path: Path) -> None:
    table = read(tmp_path, "1,\n3,4\n5,n/a")
    np.testing.assert_array_equal(np.isnan(table.values[:, 1]), [True, False, True])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("1,2\n3,4x\n", "line 2: '3,4x' is not 2 numbers"),
        ("1,2\nnew\n3,4", "line 2: 'new' is not 2 numbers"),
        ("1;2,5\n3;4.5", "decimals or thousands"),
        ("a,b", "no table of numbers; it needs 2 columns"),
    ],
)
def test_what_is_no_table_is_refused(tmp_path: Path, text: str, words: str) -> None:
    with pytest.raises(InputError, match=f"table.txt.*{words}"):
        read(tmp_path, text)
