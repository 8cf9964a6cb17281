"""glTF files made piece by piece, as the specification says."""

import base64
import io
import json
import struct
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

COMPONENTS = {"i1": 5120, "u1": 5121, "i2": 5122, "u2": 5123, "u4": 5125, "f4": 5126}
WIDTHS = {1: "SCALAR", 2: "VEC2", 3: "VEC3", 4: "VEC4", 16: "MAT4"}

SQUARE = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], np.float32)
SQUARE_UV = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32)
"""In glTF's convention: v points down."""
SQUARE_TRIANGLES = np.array([0, 1, 2, 0, 2, 3], np.uint16)


def encode(pixels: np.ndarray, kind: str = "PNG", **options: Any) -> bytes:
    file = io.BytesIO()
    Image.fromarray(pixels).save(file, kind, **options)
    return file.getvalue()


def checks(rows: int = 4, columns: int = 4, seed: int = 0, side: int = 16) -> np.ndarray:
    """Blocks of `side` pixels, each of a colour of its own."""
    rng = np.random.default_rng(seed)
    blocks = rng.integers(30, 226, (rows, columns, 3), np.uint8)
    return blocks.repeat(side, 0).repeat(side, 1)


class GltfBuilder:
    """Collects the parts of a document; every array is a buffer view of its own."""

    def __init__(self) -> None:
        self.document: dict[str, Any] = {"asset": {"version": "2.0"}}
        self.data = b""

    def add(self, kind: str, **element: Any) -> int:
        self.document.setdefault(kind, []).append(element)
        return len(self.document[kind]) - 1

    def add_view(self, data: bytes, **options: Any) -> int:
        self.data += bytes(-len(self.data) % 4)
        start, self.data = len(self.data), self.data + data
        return self.add("bufferViews", buffer=0, byteOffset=start, byteLength=len(data), **options)

    def add_array(self, values: np.ndarray, **options: Any) -> int:
        view = self.add_view(np.ascontiguousarray(values).tobytes())
        return self.add("accessors", bufferView=view, **describe(values), **options)

    def add_picture(self, data: bytes, mime: str = "image/png", **texture: Any) -> int:
        """A texture whose image is in a buffer view."""
        image = self.add("images", bufferView=self.add_view(data), mimeType=mime)
        return self.add("textures", **{"source": image, **texture})

    def add_material(self, texture: int | None = None, **base: Any) -> int:
        """A material with a base colour; `base` are properties of pbrMetallicRoughness."""
        if texture is not None:
            base.setdefault("baseColorTexture", {"index": texture})
        return self.add("materials", name="skin", pbrMetallicRoughness=base)

    def add_square(self, material: int | None = None, **changes: Any) -> dict[str, Any]:
        """Add a unit square as a mesh at a node of the scene, and return its primitive."""
        primitive: dict[str, Any] = {
            "attributes": {
                "POSITION": self.add_array(SQUARE),
                "TEXCOORD_0": self.add_array(SQUARE_UV),
            },
            "indices": self.add_array(SQUARE_TRIANGLES),
        }
        if material is not None:
            primitive["material"] = material
        primitive.update(changes)
        self.add_node(mesh=self.add("meshes", primitives=[primitive]))
        return primitive

    def add_node(self, **node: Any) -> int:
        """Add a node to the scene."""
        number = self.add("nodes", **node)
        scenes = self.document.setdefault("scenes", [{"nodes": []}])
        scenes[0]["nodes"].append(number)
        self.document.setdefault("scene", 0)
        return number

    def require(self, *names: str) -> None:
        for key in ("extensionsUsed", "extensionsRequired"):
            self.document.setdefault(key, []).extend(names)

    def write_glb(self, path: Path) -> Path:
        if self.data:
            self.document["buffers"] = [
                {"byteLength": len(self.data)},
                *self.document.get("buffers", [])[1:],
            ]
        text = json.dumps(self.document).encode()
        text += b" " * (-len(text) % 4)
        binary = self.data + bytes(-len(self.data) % 4)
        body = struct.pack("<II", len(text), 0x4E4F534A) + text
        body += struct.pack("<II", len(binary), 0x004E4942) + binary
        path.write_bytes(struct.pack("<4sII", b"glTF", 2, 12 + len(body)) + body)
        return path

    def write_gltf(self, path: Path, uri: str | None = None, file: str | None = None) -> Path:
        """Write with the buffer in a data URI, or named as `uri` and stored as `file`."""
        packed = "data:application/octet-stream;base64," + base64.b64encode(self.data).decode()
        self.document["buffers"] = [{"byteLength": len(self.data), "uri": uri or packed}]
        if uri is not None:
            target = path.parent / (file or uri)
            target.parent.mkdir(parents=True, exist_ok=True)
            target.write_bytes(self.data)
        path.write_text(json.dumps(self.document), encoding="utf-8")
        return path


def describe(values: np.ndarray) -> dict[str, Any]:
    width = values.shape[1] if values.ndim > 1 else 1
    return {
        "componentType": COMPONENTS[values.dtype.str[1:]],
        "type": WIDTHS[width],
        "count": len(values),
    }
