"""Hyphens in flags, underscores in YAML, and values that stay."""

from skinnet.inference._command.spelling import spell_flag, spell_flags, spell_keys

GIVEN = [
    "a_b-c.obj",
    "--fit.map_weight=a_b",
    "-o",
    "c_d",
    "--shape-landmarks",
    "e_f-g",
    "--",
    "--x_y-z",
]


def test_names_change_and_values_stay() -> None:
    flags = spell_flags(GIVEN)
    assert flags[1] == "--fit.map-weight=a_b" and flags[4] == "--shape-landmarks"
    keys = spell_keys(flags)
    assert keys[1] == "--fit.map_weight=a_b" and keys[4] == "--shape_landmarks"
    unchanged = (0, 2, 3, 5, 6, 7)
    assert all(flags[place] == keys[place] == GIVEN[place] for place in unchanged)


def test_a_key_is_a_flag() -> None:
    assert spell_flag("fit.map_weight") == "--fit.map-weight"
