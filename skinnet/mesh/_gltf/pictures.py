"""Pictures of glTF textures."""

from dataclasses import replace
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images import linear_to_srgb, srgb_to_linear, to_uint8
from skinnet.images._decode import decode_file
from skinnet.images.picture import Picture
from skinnet.mesh._gltf.container import GltfFile
from skinnet.mesh._gltf.materials import Material
from skinnet.mesh._texture_file import Texture, check_colour

_PREFERRED = ("EXT_texture_webp", "EXT_texture_avif")
_UNREAD = {
    b"\xabKTX 20\xbb": "KTX2 (KHR_texture_basisu)",
    b"\xabKTX 11\xbb": "KTX",
    b"sB": "Basis Universal",
    b"DDS ": "DDS (MSFT_texture_dds)",
}


def read_base_picture(file: GltfFile, material: Material) -> Texture:
    """Read the picture of a material's base colour, multiplied with its factor.

    What was assumed of it is added to the file's notes.

    Raises:
        InputError: For a picture that is missing, damaged, or of a kind that is not read.
    """
    texture = file.get("textures", material.texture)
    image = file.get("images", _find_image(file, texture))
    name = f"The picture {_name(image)} of {file.path}"
    picture = _decode(_read_bytes(file, image), name, material, file.notes)
    if (material.factor == 1).all():
        return picture
    levels = srgb_to_linear(np.arange(256, dtype=np.uint8))[:, None] * material.factor
    table = to_uint8(linear_to_srgb(levels))
    return np.stack([table[picture[..., k], k] for k in range(3)], -1)


def _find_image(file: GltfFile, texture: dict[str, Any]) -> Any:
    extensions = texture.get("extensions", {})
    sources = [extensions[name]["source"] for name in _PREFERRED if name in extensions]
    sources += [texture["source"]] if "source" in texture else []
    if sources:
        return sources[0]
    kinds = ", ".join(extensions) or "no picture"
    raise InputError(
        f"{file.path} has its base colour as {kinds}, which is not read; export it with PNG or "
        "JPEG textures, or give the picture with --texture."
    )


def _name(image: dict[str, Any]) -> str:
    uri = image.get("uri", "")
    named = uri if uri and not uri.startswith("data:") else image.get("name", "")
    return repr(named) if named else "inside"


def _read_bytes(file: GltfFile, image: dict[str, Any]) -> bytes:
    if "uri" in image:
        return file.read_uri(image["uri"], "picture")
    if "bufferView" not in image:
        raise file.damage("a picture has neither a file nor data")
    return file.read_view(image["bufferView"])


def _decode(data: bytes, name: str, material: Material, notes: list[str]) -> Texture:
    kind = next((kind for magic, kind in _UNREAD.items() if data.startswith(magic)), None)
    if kind is not None:
        raise InputError(
            f"{name} is {kind}, which is not read; export it with PNG or JPEG textures, or give "
            "the picture with --texture."
        )
    picture = decode_file(BytesIO(data), name, upright=False)
    notes += picture.notes
    space = picture.colour_space
    # glTF says that statements of the colour space are ignored, so tools leave them as they were in
    # the camera's file, and there they are true.
    if not space.name.startswith("sRGB"):
        notes.append(
            f"{name} is in {space.name} ({space.known_from}), and is read so; viewers of glTF "
            "take it as sRGB."
        )
    colour = replace(picture, alpha=_compute_alpha(picture, material)).srgb
    check_colour(colour, name)
    return colour


def _compute_alpha(picture: Picture, material: Material) -> NDArray[Any] | None:
    """Drop the alpha that a material ignores; cut off or scale the alpha that it uses."""
    if material.cutoff < 0 or (picture.alpha is None and material.alpha == 1):
        return None
    dtype = picture.pixels.dtype
    top = np.iinfo(dtype).max
    stored = (
        np.full(picture.pixels.shape[:2], top, dtype) if picture.alpha is None else picture.alpha
    )
    alpha = stored * material.alpha
    if material.cutoff > 0:
        alpha = np.where(alpha >= top * material.cutoff, top, 0)
    return np.rint(alpha).astype(dtype)
