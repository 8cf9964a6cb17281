"""The number of workers fits the cores, the memory and the photographs."""

import pytest

from skinnet.errors import InputError
from skinnet.images._walk import Found
from skinnet.inference._workers import worker_count
from skinnet.inference._workers.worker_count import choose_count, count_cores, measure_memory

MANY = [Found(f"{number}.jpg") for number in range(100)]


@pytest.fixture(autouse=True)
def machine(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(worker_count, "count_cores", lambda: 8)
    monkeypatch.setattr(worker_count, "measure_memory", lambda: 64 << 30)


def test_by_default_each_core_has_one_and_few_photographs_have_fewer() -> None:
    assert [choose_count(None, MANY[:count]) for count in (0, 1, 5, 6, 12, 100)] == [
        *(1, 1, 1, 2, 4, 8)
    ]
    assert choose_count(None, [*MANY[:5], Found("absent", InputError("absent"))]) == 1


def test_little_memory_has_fewer(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(worker_count, "measure_memory", lambda: (2 << 30) + 1)
    assert choose_count(None, MANY) == 2


def test_what_is_asked_for_counts_up_to_the_photographs() -> None:
    assert [choose_count(asked, MANY[:3]) for asked in (1, 2, 3, 200)] == [1, 2, 3, 3]
    assert choose_count(4, MANY, ["cuda", "cpu"]) == 4


def test_standard_input_is_read_here() -> None:
    assert choose_count(4, [*MANY, Found("-")]) == 1


def test_a_frozen_program_has_no_interpreter(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.frozen", True, raising=False)
    assert choose_count(4, MANY) == 1


@pytest.mark.parametrize("asked", [0, -1, 257])
def test_other_numbers_are_refused(asked: int) -> None:
    with pytest.raises(InputError, match=rf"from 1 to 256; got {asked}\. This computer has 8"):
        choose_count(asked, MANY)


def test_this_computer_has_cores_and_memory() -> None:
    assert count_cores() >= 1
    assert measure_memory() > 1 << 28
