"""The columns are the summary of a face, flattened; nothing of it is left out."""

import pytest
from skimage.data import astronaut

from skinnet.batch import describe_columns, flatten_summary
from skinnet.batch._columns import list_columns
from skinnet.inference import Decomposer


@pytest.mark.slow
def test_every_number_of_a_summary_has_a_column() -> None:
    decomposer = Decomposer(threads=1)
    row = flatten_summary(decomposer(astronaut(), detail=False).summary())
    about = {"key", "file", "status", "reason", "input_sha256"}
    about |= {"source", "source_row", "source_size", "source_modified"}
    assert set(row) | about == set(describe_columns(decomposer.encoder.lights))


def test_names_are_unique_and_need_no_quotes_in_sql() -> None:
    names = [column.name for column in list_columns(["LED-B1"], maps=True)]
    assert len(names) == len(set(names))
    assert all(name.isidentifier() for name in names)
    assert "light_LED_B1" in names and "map_melanin" in names


def test_an_interval_has_two_ends_even_if_it_is_not_known() -> None:
    found = flatten_summary({"nose": {"unit": "m", "interval": None, "sd": 1.0}})
    assert found == {"nose_interval_low": None, "nose_interval_high": None, "nose_sd": 1.0}
