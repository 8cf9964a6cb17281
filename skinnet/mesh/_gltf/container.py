"""glTF and GLB files: their JSON, and the bytes of their buffers and pictures."""

import base64
import json
import re
import struct
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from urllib.parse import unquote_to_bytes

from skinnet.errors import InputError, _clip
from skinnet.files._reading import read_file
from skinnet.mesh._foreign_name import describe_absence, find_foreign_file
from skinnet.mesh._gltf.extensions import check_required, refuse_compression

_MAGIC = b"glTF"
_JSON, _BINARY = 0x4E4F534A, 0x004E4942


@dataclass(frozen=True)
class GltfFile:
    """An open file: its JSON document, the binary chunk of a GLB, and notes on what was assumed."""

    path: Path
    document: dict[str, Any]
    binary: bytes | None = None
    notes: list[str] = field(default_factory=list)
    _buffers: dict[int, bytes] = field(default_factory=dict)

    def get(self, kind: str, index: Any) -> dict[str, Any]:
        """Get element `index` of a list at the top of the document, such as "accessors"."""
        listed = self.document.get(kind, [])
        if not isinstance(index, int) or not 0 <= index < len(listed):
            raise self.damage(f"it has {len(listed)} {kind}, and refers to number {index}")
        element = listed[index]
        if not isinstance(element, dict):
            raise self.damage(f"number {index} of its {kind} is no object")
        return {key: value for key, value in element.items() if value is not None}

    def damage(self, fault: str) -> InputError:
        """Make the error for a file that is not as glTF 2.0 says."""
        return describe_damage(self.path, fault)

    def read_view(self, index: Any) -> bytes:
        """Read the bytes of a buffer view."""
        view = self.get("bufferViews", index)
        number, start, length = view.get("buffer"), view.get("byteOffset", 0), view["byteLength"]
        if "uri" not in self.get("buffers", number) and not self._is_binary(number):
            refuse_compression(self.path, view)
        data = self._read_buffer(number)
        if start < 0 or length < 0 or start + length > len(data):
            raise self.damage(
                f"its buffer view {index} ends at byte {start + length:,} of a buffer of "
                f"{len(data):,}"
            )
        return data[start : start + length]

    def read_uri(self, uri: str, kind: str) -> bytes:
        """Read what a URI refers to: data in the URI itself, or a file beside this one."""
        if uri.startswith("data:"):
            return self._decode_data_uri(uri, kind)
        if re.match(r"https?:|//", uri):
            raise InputError(
                f"{self.path} names its {kind} by the address {uri}; download it, or export the "
                "mesh as one .glb file."
            )
        found = self._find(uri, kind)
        try:
            return read_file(found)
        except OSError as error:
            raise InputError(
                f"{found}, a {kind} of {self.path}, cannot be read ({error}); check the file."
            ) from error

    def _find(self, uri: str, kind: str) -> Path:
        found = find_foreign_file(uri.encode(), [self.path.absolute().parent])
        if found is None:
            more = ", give the picture with --texture" if kind == "picture" else ""
            raise InputError(
                f"{self.path} names the {kind} {_shorten(uri)!r}, and "
                f"{describe_absence(uri.encode(), self.path.parent)}; put it beside the mesh"
                f"{more}, or export the mesh as one .glb file."
            )
        if found.moved:
            note = f"{self.path} names the {kind} {uri!r}, which is not there; "
            self.notes.append(f"{note}{found.path} is taken, which has its name.")
        return found.path

    def _is_binary(self, number: Any) -> bool:
        return number == 0 and self.binary is not None

    def _read_buffer(self, number: Any) -> bytes:
        if number not in self._buffers:
            buffer = self.get("buffers", number)
            if "uri" in buffer:
                data = self.read_uri(buffer["uri"], "buffer")
            elif self._is_binary(number) and self.binary is not None:
                data = self.binary
            else:
                raise self.damage(f"its buffer {number} has no data")
            stated = buffer.get("byteLength", len(data))
            if stated > len(data):
                name = _shorten(buffer.get("uri", "its binary chunk"))
                raise self.damage(
                    f"its buffer {number} ({name}) has {len(data):,} of {stated:,} bytes"
                )
            self._buffers[number] = data
        return self._buffers[number]

    def _decode_data_uri(self, uri: str, kind: str) -> bytes:
        head, comma, body = uri.partition(",")
        data = unquote_to_bytes(body)
        if not comma:
            raise self.damage(f"a data URI of a {kind} has no data")
        if not head.lower().endswith(";base64"):
            return data
        packed = re.sub(rb"[\s=]", b"", data).translate(bytes.maketrans(b"-_", b"+/"))
        try:
            return base64.b64decode(packed + b"=" * (-len(packed) % 4), validate=True)
        except ValueError as error:
            raise self.damage(f"a data URI of a {kind} is not base64 ({error})") from error


def open_gltf(path: Path) -> GltfFile:
    """Open a glTF or GLB file, whichever its content is, and check what it requires.

    Raises:
        InputError: For a file that is damaged, of another version, or that requires an extension
            which is not read.
    """
    try:
        data = read_file(path)
    except OSError as error:
        raise InputError(f"{path} cannot be read ({error}); check the file.") from error
    if not data:
        raise InputError(f"{path} is empty (0 bytes); was it copied completely?")
    text, binary = _split_chunks(path, data) if data.startswith(_MAGIC) else (data, None)
    document = _parse(path, text)
    _check_version(path, document)
    check_required(path, document)
    return GltfFile(path, document, binary)


def _split_chunks(path: Path, data: bytes) -> tuple[bytes, bytes | None]:
    """Split a GLB into its JSON and its binary chunk."""
    if len(data) < 20:
        raise describe_damage(path, f"it has {len(data)} bytes, less than the header of a GLB file")
    version, length = struct.unpack_from("<II", data, 4)
    if version != 2:
        raise _other_version(path, str(version))
    if length > len(data):
        raise describe_damage(
            path, f"it has {len(data):,} of the {length:,} bytes that its header states"
        )
    chunks: dict[int, bytes] = {}
    place = 12
    while place + 8 <= length:
        size, kind = struct.unpack_from("<II", data, place)
        if place + 8 + size > len(data):
            raise describe_damage(path, f"a chunk of {size:,} bytes goes beyond its end")
        chunks.setdefault(kind, data[place + 8 : place + 8 + size])
        # Sizes are multiples of four; where one is not, writers differ on whether padding follows.
        place += 8 + size
        padding = -size % 4
        if data[place + padding + 4 : place + padding + 8] == b"BIN\0":
            place += padding
    if _JSON not in chunks:
        raise describe_damage(path, "it has no JSON chunk")
    return chunks[_JSON], chunks.get(_BINARY)


def _parse(path: Path, text: bytes) -> dict[str, Any]:
    try:
        plain = text.decode("utf-8-sig").rstrip("\0 \r\n\t")
        document = json.loads(plain, parse_float=_parse_number)
    except (ValueError, RecursionError) as error:
        raise describe_damage(
            path, f"its JSON begins with {text[:24]!r} and is broken: {error}"
        ) from error
    if not isinstance(document, dict):
        raise describe_damage(path, "its JSON is not an object")
    return document


def _parse_number(text: str) -> int | float:
    """Parse a number; some writers give integers as 1.0."""
    number = float(text)
    return int(number) if number.is_integer() and abs(number) < 2**53 else number


def _check_version(path: Path, document: dict[str, Any]) -> None:
    asset = document.get("asset")
    stated = asset if isinstance(asset, dict) else {}
    # glTF 1.0 has objects where 2.0 has lists, and need not state its version.
    older = any(isinstance(document.get(kind), dict) for kind in ("meshes", "nodes", "accessors"))
    version = str(stated.get("minVersion", stated.get("version", "1.0" if older else "2.0")))
    major, _, minor = version.partition(".")
    if older or major != "2" or ("minVersion" in stated and minor not in ("", "0")):
        raise _other_version(path, version)


def _other_version(path: Path, version: str) -> InputError:
    return InputError(
        f"{path} is glTF {_clip(version)}, and only glTF 2.0 is read; convert it (gltf-pipeline "
        "does), or export it again."
    )


def describe_damage(path: Path, fault: str) -> InputError:
    """Make the error for a file that is not as glTF 2.0 says."""
    return InputError(f"{path} cannot be read as a mesh: {fault}; copy or export it again.")


def _shorten(name: str) -> str:
    return name if len(name) <= 200 else f"{name[:200]}..."
