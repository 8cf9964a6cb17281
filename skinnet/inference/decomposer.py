"""Photographs to pigment maps and back with onnxruntime; torch is not needed."""

import math
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from skinnet.errors import InputError, NoFaceError
from skinnet.images.box import Box
from skinnet.images.faces import find_face, frame_head
from skinnet.images.photograph import as_photo
from skinnet.images.resizing import resize
from skinnet.images.srgb import srgb_to_linear, to_uint8
from skinnet.inference._editing import apply_gain, colour_gain, edge_fade
from skinnet.inference.decomposition import Decomposition
from skinnet.inference.full_resolution._colour_table import tabulate
from skinnet.inference.full_resolution._layers import Layers, sharpen
from skinnet.inference.onnx_model import (
    CAPTURE_NAMES,
    MAP_NAMES,
    SHIPPED_ENCODER,
    OnnxModel,
    get_decoder_path,
    open_model,
)

__all__ = ["Decomposer", "Decomposition"]

MAX_FACTOR = 10.0
"""Largest factor of a pigment in an edit."""

_LEAST_SIDE = 16
_DECODED = (*MAP_NAMES, *CAPTURE_NAMES)

ImageLike = str | Path | Image.Image | NDArray[Any]


class Decomposer:
    """Takes photographs of faces apart into melanin, hemoglobin, light and shape.

    `Decomposer()(image)` gives a `Decomposition`. `model` is an encoder file, X.onnx, with its
    decoder X.decoder.onnx beside it; None is the shipped one. `threads` (None: all cores) bounds
    the processor's cores in use. The files are opened once, at the first photograph.
    """

    def __init__(self, model: str | Path | None = None, threads: int | None = None):
        if threads is not None and threads < 1:
            raise InputError(f"threads is at least 1, or None for all cores; got {threads}.")
        self.path = SHIPPED_ENCODER if model is None else Path(model)
        self.threads = threads

    @cached_property
    def encoder(self) -> OnnxModel:
        """The network from photographs to maps."""
        return open_model(self.path, "encoder", self.threads)

    @cached_property
    def decoder(self) -> OnnxModel:
        """The skin model from maps to photographs."""
        return open_model(get_decoder_path(self.path), "decoder", self.threads)

    def load(self) -> None:
        """Open both files now. Raises `InputError` if one cannot be used."""
        _ = self.encoder, self.decoder

    def __call__(
        self,
        image: ImageLike,
        whole_image: bool = False,
        name: str | None = None,
        detail: bool = True,
    ) -> Decomposition:
        """Decompose a path, a Pillow image or an array, as `skinnet.images.as_photo` takes it.

        Looks at the square around the largest face, or at everything if `whole_image`; `name`
        stands for the image in errors. With `detail`, maps of skin have that of the photograph
        (`skinnet.inference.full_resolution`); without it they are the network's, enlarged. Raises
        `InputError` for an image or a model file that cannot be used, `NoFaceError` without a face.
        """
        photo = as_photo(image)
        box = _look_at(photo, whole_image, name or _name(image))
        codes = self._encode(photo, box)
        decoded = self._decode(codes)
        reconstruction = photo.copy()
        reconstruction[box.slices] = resize(to_uint8(decoded), box.width, box.height)
        maps = {name: _place(codes[name][0], photo, box) for name in (*MAP_NAMES, "mask")}
        if detail and max(box.width, box.height) > self.encoder.working_size:
            self._sharpen(photo, box, codes, maps | {"reconstruction": reconstruction})
        return Decomposition(
            **maps,
            light=self._light(codes),
            camera=_camera(codes),
            reconstruction=reconstruction,
            box=box,
            outputs=self.encoder.outputs,
            model={"version": self.encoder.version, "trained_on": self.encoder.trained_on},
        )

    def edit(
        self,
        image: ImageLike,
        melanin: float = 1.0,
        hemoglobin: float = 1.0,
        whole_image: bool = False,
        name: str | None = None,
    ) -> NDArray[np.uint8]:
        """The photograph, uint8 sRGB [H, W, 3], with its pigments multiplied by these factors.

        Works at full size: texture and gloss stay, and pixels that are not skin keep their values.
        Raises `InputError` for factors outside [0, 10], and as `__call__` does.
        """
        for pigment, factor in (("melanin", melanin), ("hemoglobin", hemoglobin)):
            if not (math.isfinite(factor) and 0 <= factor <= MAX_FACTOR):
                raise InputError(
                    f"{pigment} is multiplied by a number in [0, {MAX_FACTOR:g}]; got {factor:g}. "
                    "1 leaves it as it is, 2 doubles it."
                )
        photo = as_photo(image)
        box = _look_at(photo, whole_image, name or _name(image))
        codes = self._encode(photo, box)
        gain = self._gain(codes, melanin, hemoglobin)
        edited = photo.copy()
        mask = codes["mask"][0] * edge_fade(gain.shape[:2], box, photo.shape[:2])
        edited[box.slices] = apply_gain(photo[box.slices], gain, codes["specular"][0], mask)
        return edited

    def _encode(self, photo: NDArray[np.uint8], box: Box) -> dict[str, NDArray[np.float32]]:
        scale = self.encoder.working_size / max(box.width, box.height)
        width, height = (max(_LEAST_SIDE, round(n * scale)) for n in (box.width, box.height))
        return self.encoder.run({"image": resize(photo[box.slices], width, height)[None]})

    def _decode(self, codes: dict[str, NDArray[np.float32]]) -> NDArray[np.float32]:
        images = self.decoder.run({name: codes[name] for name in _DECODED})["image"]
        clipped: NDArray[np.float32] = np.clip(images[0], 0, 1)
        return clipped

    def _sharpen(
        self,
        photo: NDArray[np.uint8],
        box: Box,
        codes: dict[str, NDArray[np.float32]],
        full: dict[str, NDArray[Any]],
    ) -> None:
        tops = {name: self.encoder.outputs[name].range[1] for name in MAP_NAMES}
        table = tabulate(self.decoder, codes, (tops["melanin"], tops["hemoglobin"]))
        layers = Layers(**{name: values[box.slices] for name, values in full.items()})
        maps = {name: codes[name][0] for name in (*MAP_NAMES, "mask")}
        sharpen(layers, photo[box.slices], maps, table, tops["shading"], self.threads)

    def _gain(
        self, codes: dict[str, NDArray[np.float32]], melanin: float, hemoglobin: float
    ) -> NDArray[np.float32]:
        bare = codes | {
            "shading": np.ones_like(codes["shading"]),
            "specular": np.zeros_like(codes["specular"]),
            "offset": np.zeros_like(codes["offset"]),
        }
        factors = {"melanin": np.float32(melanin), "hemoglobin": np.float32(hemoglobin)}
        scaled = {name: np.clip(codes[name] * factors[name], 0, 1) for name in factors}
        before, after = (srgb_to_linear(self._decode(maps)) for maps in (bare, bare | scaled))
        return colour_gain(before, after, codes["mask"][0])

    def _light(self, codes: dict[str, NDArray[np.float32]]) -> dict[str, float]:
        weights = codes["light"][0].tolist()
        if len(weights) != len(self.encoder.lights):
            raise InputError(
                f"{self.path} names {len(self.encoder.lights)} lights and weighs {len(weights)}; "
                "export it again."
            )
        named = dict(zip(self.encoder.lights, weights, strict=True))
        return named | {"temperature_k": float(codes["temperature"][0])}


def _look_at(photo: NDArray[np.uint8], whole_image: bool, name: str) -> Box:
    height, width = photo.shape[:2]
    if whole_image:
        return Box(0, 0, width, height)
    face = find_face(photo)
    if face is None:
        raise NoFaceError(
            f"No face was found in {name}; a frontal, upright one is looked for. --whole-image "
            "(in Python whole_image=True) goes on without one."
        )
    return frame_head(face, width, height)


def _name(image: ImageLike) -> str:
    return str(image) if isinstance(image, str | Path) else "the image"


def _camera(codes: dict[str, NDArray[np.float32]]) -> dict[str, Any]:
    r_over_g, b_over_g = np.exp(codes["white_balance"][0].astype(np.float64)).tolist()
    return {
        "components": codes["camera"][0].tolist(),
        "white_balance": {"r_over_g": r_over_g, "b_over_g": b_over_g},
    }


def _place(small: NDArray[np.float32], photo: NDArray[np.uint8], box: Box) -> NDArray[np.float32]:
    """A map [h, w] or [h, w, 3] of the box in an array of the photograph's size, 0 outside."""
    full = np.zeros((*photo.shape[:2], *small.shape[2:]), np.float32)
    inside = full[box.slices]
    if small.ndim == 2:
        inside[...] = resize(small, box.width, box.height)
    else:
        for channel in range(small.shape[2]):
            inside[..., channel] = resize(small[..., channel], box.width, box.height)
    return full
