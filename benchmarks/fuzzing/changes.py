"""Changes of bytes, text and plain values, as damage and bad will make them."""

import re
from random import Random
from typing import Any

_NUMBER = re.compile(rb"-?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")

_EXTREME_NUMBERS = (
    *(b"0", b"-1", b"1", b"2", b"255", b"256", b"65536", b"2147483647", b"4294967295"),
    *(b"-2147483649", b"9223372036854775807", b"18446744073709551616", b"1" * 400, b"-0", b"0.5"),
    *(b"nan", b"inf", b"-inf", b"1e400", b"1e-400", b"1e38", b"0x10", b"1_000", b"", b"1,5", b"x"),
)

EXTREME_VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, 1, -1, 2, 7, 2**31, 2**63, 10**30, -(2**63), 0.5, -0.0, 1e308),
    *(float("nan"), float("inf"), "", "x", "nan", "1", "é", "\0", "a" * 3000, "../../x"),
    *([], {}, [1], [[1, 2], [3]], {"a": 1}, [None], ["x"], [0.1, 0.2, 0.3], [float("nan")] * 3),
)
"""Values of every plain type, at the ends of their ranges and beyond."""


def change_bytes(data: bytes, rng: Random, other: bytes = b"") -> bytes:
    """Make one to four changes of bytes: flips, cuts, copies, lengths at their ends.

    Args:
        data: The content.
        rng: Source of the changes.
        other: Another content, of which parts are spliced in.
    """
    for _ in range(rng.choice((1, 1, 1, 2, 4))):
        data = rng.choice(_BYTE_CHANGES)(data, rng, other or data)
    return data


def change_text(data: bytes, rng: Random, words: tuple[bytes, ...] = ()) -> bytes:
    """Make one to four changes of text: numbers, lines, words, and sometimes bytes.

    Args:
        data: The text.
        rng: Source of the changes.
        words: Words of the format, which are written over others.
    """
    for _ in range(rng.choice((1, 1, 2, 4))):
        change = rng.choice((*_TEXT_CHANGES, *[_put_word] * bool(words)))
        data = change(data, rng, words)
    return change_bytes(data, rng) if rng.random() < 0.15 else data


def change_value(value: Any, rng: Random) -> Any:
    """Change plain values once, somewhere in their depth.

    Args:
        value: Dictionaries, lists, numbers and text; it is not changed itself.
        rng: Source of the change.
    """
    if isinstance(value, dict) and value and rng.random() < 0.85:
        return _change_dict(value, rng)
    if isinstance(value, list | tuple) and value and rng.random() < 0.85:
        return _change_list(list(value), rng)
    if isinstance(value, int | float) and not isinstance(value, bool) and rng.random() < 0.5:
        return rng.choice((-value, value + 1, value - 1, value * 1000, value / 1000, str(value)))
    if isinstance(value, str) and rng.random() < 0.4:
        return change_text(value.encode("utf-8", "replace"), rng).decode("utf-8", "replace")
    return rng.choice(EXTREME_VALUES)


def _change_dict(value: dict[Any, Any], rng: Random) -> dict[Any, Any]:
    key, changed = rng.choice(list(value)), dict(value)
    match rng.randrange(12):
        case 0:
            del changed[key]
        case 1:
            changed[f"{key}x"] = changed.pop(key)
        case 2:
            changed["unknown"] = rng.choice(EXTREME_VALUES)
        case 3:
            changed[key] = changed[rng.choice(list(value))]
        case _:
            changed[key] = change_value(value[key], rng)
    return changed


def _change_list(value: list[Any], rng: Random) -> list[Any]:
    at = rng.randrange(len(value))
    match rng.randrange(8):
        case 0:
            return value[:at] + value[at + 1 :]
        case 1:
            return [*value, value[at]]
        case 2:
            return value[::-1]
        case _:
            return [*value[:at], change_value(value[at], rng), *value[at + 1 :]]


def _flip(data: bytes, rng: Random, other: bytes) -> bytes:
    changed = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 8, 32)) if data else 0):
        at = _choose_place(data, rng)
        changed[at] = rng.choice((0, 255, 127, 128, changed[at] ^ 1 << rng.randrange(8)))
    return bytes(changed)


def _cut(data: bytes, rng: Random, other: bytes) -> bytes:
    return data[: _choose_place(data, rng)] if data else data


def _remove(data: bytes, rng: Random, other: bytes) -> bytes:
    at = rng.randrange(len(data) + 1)
    return data[:at] + data[at + _choose_length(rng) :]


def _repeat(data: bytes, rng: Random, other: bytes) -> bytes:
    at, length = rng.randrange(len(data) + 1), _choose_length(rng)
    return data[: at + length] + data[at : at + length] * rng.choice((1, 1, 50)) + data[at:]


def _splice(data: bytes, rng: Random, other: bytes) -> bytes:
    at, start = rng.randrange(len(data) + 1), rng.randrange(len(other) + 1)
    part = other[start : start + _choose_length(rng)]
    return data[:at] + part + data[at + rng.choice((0, len(part))) :]


def _set_integer(data: bytes, rng: Random, other: bytes) -> bytes:
    """Set a number of 1, 2, 4 or 8 bytes to one that a length or an offset should not be."""
    size, order = rng.choice((1, 2, 4, 4, 8)), rng.choice(("big", "little"))
    if len(data) < size:
        return data
    most, at = 256**size - 1, min(_choose_place(data, rng), len(data) - size)
    old = int.from_bytes(data[at : at + size], order)  # type: ignore[arg-type]
    new = rng.choice((0, 1, most, most - 1, most // 2, most // 2 + 1, len(data), old + 1, old * 2))
    return data[:at] + (new & most).to_bytes(size, order) + data[at + size :]  # type: ignore[arg-type]


def _append(data: bytes, rng: Random, other: bytes) -> bytes:
    return data + rng.choice((bytes(100), other[:200], rng.randbytes(64), b"\n" * 1000))


_BYTE_CHANGES = (_flip, _flip, _cut, _remove, _repeat, _splice, _set_integer, _set_integer, _append)


def _choose_place(data: bytes, rng: Random) -> int:
    """A place of the content; half of them are in the head, where formats state their sizes."""
    return rng.randrange(len(data) if rng.random() < 0.5 else min(len(data), 300))


def _choose_length(rng: Random) -> int:
    return rng.choice((1, 2, 4, 8, 16, 100, 1000))


def _change_number(data: bytes, rng: Random, words: tuple[bytes, ...]) -> bytes:
    found = list(_NUMBER.finditer(data[:200_000]))
    if not found:
        return data
    one = rng.choice(found)
    return data[: one.start()] + rng.choice(_EXTREME_NUMBERS) + data[one.end() :]


def _change_line(data: bytes, rng: Random, words: tuple[bytes, ...]) -> bytes:
    lines = data.split(b"\n")
    at, other = rng.randrange(len(lines)), rng.randrange(len(lines))
    match rng.randrange(6):
        case 0:
            del lines[at]
        case 1:
            lines[at] = b"\n".join([lines[at]] * rng.choice((2, 2, 1000)))
        case 2:
            lines[at], lines[other] = lines[other], lines[at]
        case 3:
            lines[at] = lines[at][: rng.randrange(len(lines[at]) + 1)]
        case 4:
            lines[at] += rng.choice((b" 1", b" # \xdf", b"\\", b"\r", b"," * 50, b" " * 3000))
        case _:
            lines[at] = lines[at] + lines[other]
    return b"\n".join(lines)


def _put_word(data: bytes, rng: Random, words: tuple[bytes, ...]) -> bytes:
    parts = re.split(rb"(\s+)", data)
    parts[rng.randrange(len(parts))] = rng.choice(words)
    return b"".join(parts)


def _put_bytes(data: bytes, rng: Random, words: tuple[bytes, ...]) -> bytes:
    at = rng.randrange(len(data) + 1)
    odd = (
        b"\xff\xfe",
        b"\xdf",
        b"\0",
        b"\xef\xbb\xbf",
        b"\x85",
        b"\xe2\x80\xa8",
        b"\x1b[2J",
        b"\r",
    )
    return (
        data[:at] + rng.choice((*odd, b'"', b"'", b"{", b"[" * 2000, b"}", b"<", b"&")) + data[at:]
    )


_TEXT_CHANGES = (_change_number, _change_number, _change_line, _change_line, _put_bytes)
