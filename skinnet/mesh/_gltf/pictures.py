"""Pictures of glTF textures."""

from dataclasses import replace
from io import BytesIO
from typing import Any

import numpy as np
from jaxtyping import Float

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
    picture = _decode(_read_bytes(file, image), name, file.notes)
    stored = replace(picture, alpha=None).srgb
    check_colour(stored, name)
    colour = _multiply(stored, material.factor)
    if material.cutoff == 0 and material.alpha < 1:
        file.notes.append(
            f"{file.path}: {material.name} is transparent (alpha {material.alpha:.3g}); it is read "
            "as opaque."
        )
    alpha = _compute_alpha(picture, material)
    if alpha is None or alpha.min() == 1:
        return colour
    file.notes.append(f"{name} is transparent in places; these are blended with white.")
    return to_uint8(1 + (colour / 255 - 1) * alpha[..., None])


def _multiply(texture: Texture, factor: Float[np.ndarray, "3"]) -> Texture:
    """Multiply sRGB with a linear factor."""
    if (factor == 1).all():
        return texture
    levels = srgb_to_linear(np.arange(256, dtype=np.uint8))[:, None] * factor
    table = to_uint8(linear_to_srgb(levels))
    return np.stack([table[texture[..., k], k] for k in range(3)], -1)


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


def _decode(data: bytes, name: str, notes: list[str]) -> Picture:
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
    return picture


def _compute_alpha(picture: Picture, material: Material) -> Float[np.ndarray, "_ _"] | None:
    """Compute the opacity that the material makes of a picture's alpha; None if it ignores it."""
    if material.cutoff < 0 or picture.alpha is None:
        return None
    alpha = picture.alpha / np.iinfo(picture.alpha.dtype).max
    if material.cutoff == 0:
        return alpha
    return (alpha * material.alpha >= material.cutoff).astype(np.float64)
