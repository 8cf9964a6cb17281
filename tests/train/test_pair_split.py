"""The split of people into those that training sees and those that it does not."""

from train.pair_split import choose_kept

PEOPLE = [f"person {number}" for number in range(40)]


def test_the_kept_people_do_not_depend_on_order_or_repetition() -> None:
    kept = choose_kept(PEOPLE, 10)
    assert len(kept) == 10 and kept < set(PEOPLE)
    assert choose_kept([*PEOPLE[::-1], *PEOPLE], 10) == kept


def test_fewer_people_than_are_kept_are_all_kept() -> None:
    assert choose_kept(PEOPLE) == set(PEOPLE)
