"""What an ONNX file states about itself, read without onnxruntime, which may be too old for it.

A file is a `ModelProto` of the ONNX schema in protobuf's wire format: fields with a number, a wire
type and, for all but integers, a length. The graph is passed over by its length.
"""

from collections.abc import Iterator, Mapping
from io import BufferedIOBase, BytesIO
from pathlib import Path
from typing import BinaryIO, NamedTuple

from skinnet.files._reading import open_file

_INTEGER, _FIXED64, _BYTES, _FIXED32 = 0, 1, 2, 5
_FIELDS = {1: _INTEGER, 5: _INTEGER, **dict.fromkeys((2, 3, 4, 6, 7, 8, 14, 20, 25, 26), _BYTES)}
"""Wire types of the fields of `ModelProto`; another field is that of another kind of file."""

_IR_VERSION, _PRODUCER, _PRODUCER_VERSION, _OPSET, _METADATA = 1, 2, 3, 8, 14
_LONGEST = 1 << 18
"""Longer fields are not read: the graph above all."""


class Header(NamedTuple):
    """What a file states.

    Attributes:
        ir_version: Version of the file format.
        producer: Program that made it, with its version; empty if the file does not say.
        opsets: Version of each set of operators, by domain; "" is that of ONNX itself.
        metadata: Entries of the program that made it.
        missing_bytes: Bytes that the file lacks at least; 0 if it is complete.
    """

    ir_version: int
    producer: str
    opsets: Mapping[str, int]
    metadata: Mapping[str, str]
    missing_bytes: int


class _Field(NamedTuple):
    number: int
    wire: int
    integer: int
    content: bytes
    missing_bytes: int

    @property
    def text(self) -> str:
        return self.content.decode("utf-8", "replace")


def read_header(path: Path) -> Header | None:
    """Read the header of a file.

    Args:
        path: The file.

    Returns:
        The header; None if the file is not in ONNX format.
    """
    fields = []
    with open_file(path) as file:
        for field in _read_fields(file, path.stat().st_size):
            if _FIELDS.get(field.number) != field.wire:
                return None
            fields.append(field)
    numbers = {field.number: field.integer for field in fields}
    texts = {f.number: f.text for f in fields if f.number in (_PRODUCER, _PRODUCER_VERSION)}
    if not numbers.get(_IR_VERSION):
        return None
    producer = f"{texts.get(_PRODUCER, '')} {texts.get(_PRODUCER_VERSION, '')}".strip()
    opsets, metadata = (
        [_read_pair(field.content) for field in fields if field.number == number]
        for number in (_OPSET, _METADATA)
    )
    return Header(
        numbers[_IR_VERSION],
        producer,
        {key.text: value.integer for key, value in opsets},
        {key.text: value.text for key, value in metadata},
        fields[-1].missing_bytes,
    )


def _read_pair(message: bytes) -> tuple[_Field, _Field]:
    """The two fields of a set of operators or of an entry; they may be absent."""
    fields = {field.number: field for field in _read_fields(BytesIO(message), len(message))}
    absent = _Field(0, _BYTES, 0, b"", 0)
    return fields.get(1, absent), fields.get(2, absent)


def _read_fields(
    file: BufferedIOBase | BytesIO | BinaryIO, size: int, longest: int = _LONGEST
) -> Iterator[_Field]:
    """The fields of a message; the last one lacks bytes if the message is cut short."""
    while file.tell() < size:
        tag = _read_integer(file)
        number, wire = (0, 0) if tag is None else (tag >> 3, tag & 7)
        if wire in (_FIXED32, _FIXED64):
            length: int | None = 4 if wire == _FIXED32 else 8
        else:
            length = _read_integer(file)
        if tag is None or length is None:
            yield _Field(number, wire, 0, b"", 1)
            return
        if wire == _INTEGER:
            yield _Field(number, wire, length, b"", 0)
            continue
        start = file.tell()
        content = file.read(length) if length <= longest else b""
        yield _Field(number, wire, 0, content, max(0, start + length - size))
        file.seek(min(start + length, size))


def _read_integer(file: BufferedIOBase | BytesIO | BinaryIO) -> int | None:
    """An integer of seven bits a byte, the lowest first; None at the end of the file."""
    value = 0
    for shift in range(0, 70, 7):
        byte = file.read(1)
        if not byte:
            return None
        value |= (byte[0] & 0x7F) << shift
        if byte[0] < 0x80:
            return value
    return 0
