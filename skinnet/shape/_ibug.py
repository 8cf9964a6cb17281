"""The 68 points of iBUG, and the names of those that a fit uses."""

from skinnet.errors import InputError

IBUG = {
    "right_brow_outer": 17,
    "right_brow_inner": 21,
    "left_brow_inner": 22,
    "left_brow_outer": 26,
    "nose_bridge": 27,
    "nose_tip": 30,
    "right_nostril": 31,
    "nose_base": 33,
    "left_nostril": 35,
    "right_eye_outer": 36,
    "right_eye_inner": 39,
    "left_eye_inner": 42,
    "left_eye_outer": 45,
    "mouth_right": 48,
    "mouth_top": 51,
    "mouth_left": 54,
    "mouth_bottom": 57,
    "lips_upper": 62,
    "lips_lower": 66,
    "chin": 8,
}
"""Numbers, among iBUG's 68, of the landmarks of a fit. Right is the person's right, x < 0."""

IBUG_COUNT = 68

_NAMES = {number: name for name, number in IBUG.items()}


def name_ibug_point(number: int) -> str:
    """Give the name of a point of iBUG's 68: one of `IBUG`, else ibug_<number>."""
    return _NAMES.get(number, f"ibug_{number}")


def resolve_name(name: str) -> str:
    """Convert a number of iBUG's to the point's name; other names stay unchanged."""
    number = name.strip().removeprefix("ibug_")
    if not number.isdecimal():
        return name.strip()
    if int(number) >= IBUG_COUNT:
        raise InputError(f"Landmark {name} is none of iBUG's, which go from 0 to {IBUG_COUNT - 1}.")
    return name_ibug_point(int(number))
