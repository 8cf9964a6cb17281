"""Messages of protobuf, such as ONNX files, as lists of fields that can be changed and written."""

from random import Random

from benchmarks.fuzzing.changes import change_bytes

_VARINT, _FIXED64, _BYTES, _FIXED32 = 0, 1, 2, 5
_EXTREMES = (0, 1, 2, 3, 7, 127, 255, 2**31 - 1, 2**31, 2**32, 2**63 - 1, 2**63, 2**64 - 1)

Field = tuple[int, int, int | bytes]
"""Number, wire type and content of a field."""


def change_message(data: bytes, rng: Random, depth: int = 0) -> bytes:
    """Change one field of a message, of its messages, and so on; all lengths fit.

    Args:
        data: A message.
        rng: Source of the change.
        depth: How many messages are around this one.
    """
    fields = read_fields(data)
    if not fields or (depth > 0 and rng.random() < 0.08):
        return change_bytes(data, rng)
    at, other = rng.randrange(len(fields)), rng.randrange(len(fields))
    number, wire, content = fields[at]
    match rng.randrange(14):
        case 0:
            del fields[at]
        case 1:
            fields.insert(other, fields[at])
        case 2:
            fields[at] = (
                (number, wire, fields[other][2]) if wire == fields[other][1] else fields[at]
            )
        case 3:
            fields[at] = (rng.choice((0, 1, 2, 5, 8, 14, 20, 30)), wire, content)
        case _ if isinstance(content, bytes):
            inner = change_message if _is_message(content) else change_leaf
            changed = (
                inner(content, rng, depth + 1) if inner is change_message else inner(content, rng)
            )
            fields[at] = (number, wire, changed)
        case _:
            assert isinstance(content, int)
            new = rng.choice((*_EXTREMES, content + 1, max(content - 1, 0)))
            fields[at] = (number, wire, new)
    return write_fields(fields)


def change_leaf(content: bytes, rng: Random) -> bytes:
    """Change text or numbers: floats of single precision to those that weights cannot be."""
    if len(content) >= 4 and len(content) % 4 == 0 and rng.random() < 0.5:
        at = 4 * rng.randrange(len(content) // 4)
        new = rng.choice(
            (
                b"\0\0\xc0\x7f",
                b"\0\0\x80\x7f",
                b"\0\0\x80\xff",
                b"\xff" * 4,
                bytes(4),
                b"\xca\xf2\x49\x71",
                b"\0\0\xc8\x42",
                b"\1\0\0\0",
            )
        )
        return content[:at] + new * rng.choice((1, 1, 8)) + content[at + 4 :]
    return change_bytes(content, rng)


def read_fields(data: bytes) -> list[Field]:
    """The fields of a message; none if it is no message."""
    fields: list[Field] = []
    at = 0
    while at < len(data):
        tag, at = _read_varint(data, at)
        number, wire = tag >> 3, tag & 7
        if at < 0 or number == 0:
            return []
        if wire == _BYTES:
            length, at = _read_varint(data, at)
            if at < 0 or at + length > len(data):
                return []
            fields.append((number, wire, data[at : at + length]))
            at += length
        elif wire == _VARINT:
            value, at = _read_varint(data, at)
            fields.append((number, wire, value))
        elif wire in (_FIXED32, _FIXED64):
            size = 4 if wire == _FIXED32 else 8
            fields.append((number, wire, int.from_bytes(data[at : at + size], "little")))
            at += size
        else:
            return []
        if at < 0 or at > len(data):
            return []
    return fields


def write_fields(fields: list[Field]) -> bytes:
    """Write a message."""
    out = bytearray()
    for number, wire, content in fields:
        out += _write_varint(number << 3 | wire)
        if isinstance(content, bytes):
            out += _write_varint(len(content)) + content
        elif wire == _VARINT:
            out += _write_varint(content)
        else:
            size = 4 if wire == _FIXED32 else 8
            out += (content % 256**size).to_bytes(size, "little")
    return bytes(out)


def _is_message(content: bytes) -> bool:
    return len(content) < 6_000_000 and bool(read_fields(content))


def _read_varint(data: bytes, at: int) -> tuple[int, int]:
    """A number, and the place after it; -1 if it is cut short."""
    value = 0
    for shift in range(0, 70, 7):
        if at >= len(data):
            return 0, -1
        value |= (data[at] & 0x7F) << shift
        at += 1
        if data[at - 1] < 0x80:
            return value, at
    return 0, -1


def _write_varint(value: int) -> bytes:
    value %= 2**64
    out = bytearray()
    while value > 0x7F:
        out.append(value & 0x7F | 0x80)
        value >>= 7
    return bytes([*out, value])
