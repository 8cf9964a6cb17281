"""Pictures of glTF textures."""

import warnings
from io import BytesIO
from typing import Any

import numpy as np
from PIL import Image

from skinnet.errors import InputError
from skinnet.files import READ_ERRORS
from skinnet.images import linear_to_srgb, srgb_to_linear, to_uint8
from skinnet.images._decode import PHOTO_FORMATS
from skinnet.mesh._gltf.container import GltfFile
from skinnet.mesh._gltf.materials import Material
from skinnet.mesh._texture_file import Texture, decode_texture

_PREFERRED = ("EXT_texture_webp", "EXT_texture_avif")
_UNREAD = {
    b"\xabKTX 20\xbb": "KTX2 (KHR_texture_basisu)",
    b"\xabKTX 11\xbb": "KTX",
    b"sB": "Basis Universal",
    b"DDS ": "DDS (MSFT_texture_dds)",
}


def read_base_picture(file: GltfFile, material: Material) -> Texture:
    """Read the picture of a material's base colour, multiplied with its factor.

    Raises:
        InputError: For a picture that is missing, damaged, or of a kind that is not read.
    """
    texture = file.get("textures", material.texture)
    image = file.get("images", _find_image(file, texture))
    name = f"The picture {_name(image)} of {file.path}"
    picture = _decode(_read_bytes(file, image), name, material)
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
        "JPEG textures, or give the texture's picture."
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


def _decode(data: bytes, name: str, material: Material) -> Texture:
    kind = next((kind for magic, kind in _UNREAD.items() if data.startswith(magic)), None)
    if kind is not None:
        raise InputError(
            f"{name} is {kind}, which is not read; export it with PNG or JPEG textures, or give "
            "the texture's picture."
        )
    Image.init()
    formats = [known for known in PHOTO_FORMATS if known in Image.OPEN]
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            image = Image.open(BytesIO(data), formats=formats)
            return decode_texture(_apply_alpha(image, material), name)
    except InputError:
        raise
    except (Image.DecompressionBombError, *READ_ERRORS) as error:
        raise InputError(
            f"{name} cannot be read as a picture ({error}); export it with PNG or JPEG textures."
        ) from error


def _apply_alpha(image: Image.Image, material: Material) -> Image.Image:
    """Drop the alpha that a material ignores; cut off or scale the alpha that it uses."""
    if not image.has_transparency_data and material.alpha == 1:
        return image
    if material.cutoff < 0:
        plain = image.convert("L" if image.mode in ("LA", "La") else "RGB")
        plain.info.pop("transparency", None)
        return plain
    visible = image.convert("RGBA")
    alpha = np.asarray(visible.getchannel("A")) * material.alpha
    if material.cutoff > 0:
        alpha = np.where(alpha >= 255 * material.cutoff, 255, 0)
    visible.putalpha(Image.fromarray(alpha.round().astype(np.uint8)))
    return visible
