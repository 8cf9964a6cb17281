"""Photographs to pigment maps and back with onnxruntime."""

import math
from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from skinnet.errors import InputError
from skinnet.images._shot import read_shot
from skinnet.images.faces._face_parts import find_face_parts
from skinnet.images.photograph import read_picture
from skinnet.images.picture import Picture
from skinnet.images.resizing import resize
from skinnet.images.srgb import srgb_to_linear
from skinnet.inference._capture_inputs import (
    CaptureLike,
    Inputs,
    join_captures,
    name_known,
)
from skinnet.inference._capture_names import name_camera, name_light
from skinnet.inference._doubts import list_doubts
from skinnet.inference._editing import ColourChange, apply_change, compute_change
from skinnet.inference._face_choice import FaceChoice
from skinnet.inference._metering import brighten, find_gain, scale_back, shift_exposure
from skinnet.inference._onnx_pair import get_decoder_path, refuse_other_export
from skinnet.inference._references.profile_use import Applied, apply_profile
from skinnet.inference._skin_chromaticity import measure_chromaticity
from skinnet.inference._skin_mask import adopt_mask, find_skin
from skinnet.inference._subject import Region, Subject, find_subjects
from skinnet.inference._transparency import note_transparency
from skinnet.inference._uncertainty import Uncertainty
from skinnet.inference.decomposition import Decomposition
from skinnet.inference.full_resolution._colour_table import tabulate_colours
from skinnet.inference.full_resolution._layers import Layers, enlarge_layers, sharpen_layers
from skinnet.inference.full_resolution._pasting import paste_layers
from skinnet.inference.onnx_model import (
    CAPTURE_NAMES,
    MAP_NAMES,
    SHIPPED_ENCODER,
    OnnxModel,
    open_model,
)

MAX_FACTOR = 10.0
"""Largest factor of a pigment in an edit."""

ImageLike = str | Path | Image.Image | NDArray[Any] | Picture
_Arrays = Mapping[str, NDArray[np.float32]]


class Decomposer:
    """Decomposes photographs of faces into melanin, hemoglobin, shading, light and camera.

    The model files are opened once, at the first photograph.

    Args:
        model: An encoder, X.onnx, with its decoder X.decoder.onnx in the same folder; None for the
            one that comes with the package.
        threads: Number of threads; None for all cores.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet.inference import Decomposer
        >>> decomposition = Decomposer()(astronaut())
        >>> skin = decomposition.mask > 0.5
        >>> 0.01 < float(decomposition.melanin[skin].mean()) < 0.1
        True
    """

    def __init__(self, model: str | Path | None = None, threads: int | None = None) -> None:
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
        decoder = open_model(get_decoder_path(self.path), "decoder", self.threads)
        refuse_other_export(self.encoder, decoder)
        return decoder

    def load(self) -> None:
        """Open both model files now.

        Raises:
            InputError: One of them cannot be used.
        """
        _ = self.encoder, self.decoder

    @overload
    def __call__(
        self,
        image: ImageLike,
        whole_image: bool = False,
        name: str | None = None,
        detail: bool = True,
        *,
        faces: None = None,
        region: Region = "face",
        capture: CaptureLike | None = None,
    ) -> Decomposition: ...

    @overload
    def __call__(
        self,
        image: ImageLike,
        whole_image: bool = False,
        name: str | None = None,
        detail: bool = True,
        *,
        faces: FaceChoice,
        region: Region = "face",
        capture: CaptureLike | None = None,
    ) -> list[Decomposition]: ...

    def __call__(
        self,
        image: ImageLike,
        whole_image: bool = False,
        name: str | None = None,
        detail: bool = True,
        *,
        faces: FaceChoice | None = None,
        region: Region = "face",
        capture: CaptureLike | None = None,
    ) -> Decomposition | list[Decomposition]:
        """Decompose a photograph.

        Args:
            image: A path, a Pillow image, an array or a `Picture`; `skinnet.images.read_picture`
                says what they may be.
            whole_image: Another word for `region="skin"`.
            name: Name of the image in error messages; the path by default.
            detail: Whether to add the photograph's detail to the maps; without it they are the
                network's maps, enlarged, which is faster.
            faces: "all", "largest", or how many of the largest faces to read; None for the largest
                one alone.
            region: "face", or "skin" to read whatever skin the photograph shows, such as a forearm,
                without a search for a face.
            capture: What is known of the light and the camera: a `Capture`, or a `CaptureProfile`
                of the session, whose tone curve is undone; None: nothing. Of a RAW file it is
                known, too, that it is linear, and which camera took it if that is a measured one.

        Returns:
            Maps of the photograph's size, light and camera. If `faces` is given, a list of them,
            one for each face, from left to right.

        Raises:
            InputError: An argument, the image or a model file cannot be used; the image has no
                colour: it is grey, or toned in sepia, cyanotype and the like; the face is too
                small, mostly outside the image, or drawn; or no skin was found.
            NoFaceError: No face was found.

        Example:
            >>> from skimage.data import astronaut
            >>> from skinnet.inference import Decomposer
            >>> [each.face_id for each in Decomposer()(astronaut(), faces="all")]
            [1]
        """
        applied = apply_profile(_as_picture(image), capture)
        picture, capture = applied.picture, applied.capture
        name = name or _name_image(image)
        known, notes = join_captures(picture, capture, self.encoder)
        picture = replace(picture, notes=(*picture.notes, *notes))
        subjects = find_subjects(picture.srgb, name, faces, "skin" if whole_image else region)
        subjects = [self._doubt_white(applied, each, name, known) for each in subjects]
        read = [self._decompose(picture, subject, name, detail, known) for subject in subjects]
        read = [applied.restore(each) for each in read]
        return read[0] if faces is None else read

    def edit(
        self,
        image: ImageLike,
        melanin: float = 1.0,
        hemoglobin: float = 1.0,
        whole_image: bool = False,
        name: str | None = None,
        *,
        faces: FaceChoice = "largest",
        region: Region = "face",
        capture: CaptureLike | None = None,
    ) -> NDArray[np.uint8]:
        """Multiply the pigments of a photograph.

        The edit works at full resolution: texture and specular reflection stay, and pixels that are
        not skin keep their exact values.

        Args:
            image: A path, a Pillow image, an array or a `Picture`; `skinnet.images.read_picture`
                says what they may be.
            melanin: Factor of melanin in [0, 10].
            hemoglobin: Factor of hemoglobin in [0, 10].
            whole_image: Another word for `region="skin"`.
            name: Name of the image in error messages; the path by default.
            faces: "all", "largest", or how many of the largest faces to edit.
            region: "face", or "skin" to edit whatever skin the photograph shows.
            capture: What is known of the light and the camera; None: nothing.

        Returns:
            The edited photograph, uint8 sRGB [H, W, 3].

        Raises:
            InputError: An argument, the image or a model file cannot be used, or the image cannot
                be read, as when it is called.
            NoFaceError: No face was found.

        Example:
            >>> from skimage.data import astronaut
            >>> from skinnet.inference import Decomposer
            >>> edited = Decomposer().edit(astronaut(), melanin=2.0)
            >>> bool(edited[125, 224].mean() < astronaut()[125, 224].mean())  # the nose
            True
        """
        picture = _as_picture(image)
        name = name or _name_image(image)
        return self.edit_picture(
            *(picture, melanin, hemoglobin, whole_image, name),
            faces=faces,
            region=region,
            capture=capture,
        ).srgb

    def edit_picture(
        self,
        picture: Picture,
        melanin: float = 1.0,
        hemoglobin: float = 1.0,
        whole_image: bool = False,
        name: str | None = None,
        *,
        faces: FaceChoice = "largest",
        region: Region = "face",
        capture: CaptureLike | None = None,
    ) -> Picture:
        """Multiply the pigments of a picture, which keeps its depth, colour space and alpha.

        Args:
            picture: A picture from `skinnet.images.read_picture`.
            melanin: Factor of melanin in [0, 10].
            hemoglobin: Factor of hemoglobin in [0, 10].
            whole_image: Another word for `region="skin"`.
            name: Name of the picture in error messages; its own by default.
            faces: "all", "largest", or how many of the largest faces to edit.
            region: "face", or "skin" to edit whatever skin the photograph shows.
            capture: What is known of the light and the camera; None: nothing.

        Returns:
            The edited picture. Pixels that are not skin keep their stored values.

        Raises:
            InputError: An argument or a model file cannot be used, or the picture cannot be read,
                as when it is called.
            NoFaceError: No face was found.

        Example:
            >>> from skimage.data import astronaut
            >>> from skinnet.images import read_picture
            >>> from skinnet.inference import Decomposer
            >>> picture = read_picture(astronaut())
            >>> edited = Decomposer().edit_picture(picture, melanin=2.0)
            >>> bool((edited.pixels[0] == picture.pixels[0]).all())  # the wall
            True
        """
        factors = {"melanin": melanin, "hemoglobin": hemoglobin}
        _check_factors(**factors)
        applied = apply_profile(picture, capture, is_read=False)
        picture, capture = applied.picture, applied.capture
        known, capture_notes = join_captures(picture, capture, self.encoder)
        name = name or picture.name
        photo, colour = picture.srgb, picture.as_colour()
        edited = replace(colour, pixels=colour.pixels.copy())
        notes = [*colour.notes, *capture_notes]
        for subject in find_subjects(photo, name, faces, "skin" if whole_image else region):
            subject = self._doubt_white(applied, subject, name, known)
            notes += self._edit_in_place(edited, photo, subject, factors, name, known)
        return replace(edited, notes=tuple(dict.fromkeys(notes)))

    def _decompose(
        self, picture: Picture, subject: Subject, name: str, detail: bool, known: Inputs
    ) -> Decomposition:
        photo, box = picture.srgb, subject.crop.box
        encoder_outputs, skin = self._read(photo, subject, known)
        layers = self._make_layers(photo[box.slices], encoder_outputs, skin, detail)
        inside = subject.crop.find_inside()
        pasted = paste_layers(layers, photo, box, inside)
        alpha = None if picture.alpha is None else picture.alpha[box.slices]
        mask, who = pasted["mask"][box.slices], subject.describe(name)
        colour = measure_chromaticity(photo[box.slices], mask)
        return Decomposition(
            **pasted,
            light=name_light(encoder_outputs, self.encoder),
            camera=name_camera(encoder_outputs),
            box=box,
            pixels_read=int(np.count_nonzero(inside)),
            tilt=None if subject.face is None else subject.face.tilt,
            colour_space=picture.colour_space,
            notes=(
                *picture.notes,
                *note_transparency(alpha, mask, name),
                *subject.notes,
                *list_doubts(
                    *(who, photo[box.slices], mask, encoder_outputs, name_known(known)), colour
                ),
            ),
            output_info=self.encoder.output_info,
            model={
                "version": self.encoder.version,
                "trained_on": self.encoder.trained_on,
                "optics": self.encoder.optics,
            },
            uncertainty=Uncertainty.from_outputs(encoder_outputs, self.encoder.region_share),
            capture_known=name_known(known),
            exif=read_shot(picture.metadata.get("exif", b""))._asdict(),
            skin_chromaticity=colour,
            face_id=subject.face_id,
            faces_found=None if subject.faces is None else len(subject.faces),
            face_parts=None if subject.face is None else find_face_parts(photo, subject.face),
        )

    def _doubt_white(self, applied: Applied, subject: Subject, name: str, known: Inputs) -> Subject:
        """Note that a white balance that is known does not fit what is seen without it."""
        if "known_white_balance" not in known:
            return subject
        linear = {key: value for key, value in known.items() if key == "known_linear"}
        blind = self._encode(applied.picture.srgb, subject, linear)["white_balance"][0]
        told = known["known_white_balance"][0].tolist()
        notes = applied.doubt(subject.describe(name), blind.tolist(), told)
        return subject._replace(notes=(*subject.notes, *notes))

    def _edit_in_place(
        self,
        colour: Picture,
        photo: NDArray[np.uint8],
        subject: Subject,
        factors: Mapping[str, float],
        name: str,
        known: Inputs,
    ) -> tuple[str, ...]:
        """Multiply the pigments of one subject in the pixels of `colour`. Returns notes."""
        box = subject.crop.box
        encoder_outputs, skin = self._read(photo, subject, known)
        change = self._compute_change(encoder_outputs, factors)
        fade = subject.crop.fade(change.loss.shape[:2], photo.shape)
        mask = skin if fade.min() == 1 else skin * resize(fade, box.width, box.height)
        alpha = None if colour.alpha is None else colour.alpha[box.slices]
        crop = replace(colour, pixels=colour.pixels[box.slices], alpha=alpha)
        apply_change(crop, change, encoder_outputs["specular"][0], mask)
        return (
            *note_transparency(alpha, skin, name),
            *subject.notes,
        )

    def _read(
        self, photo: NDArray[np.uint8], subject: Subject, known: Inputs
    ) -> tuple[_Arrays, NDArray[np.float32]]:
        """Maps and capture of the subject's box, and its mask at the photograph's size."""
        encoder_outputs = self._encode(photo, subject, known)
        skin = find_skin(photo, subject, encoder_outputs["mask"][0])
        return adopt_mask(encoder_outputs, skin, photo[subject.crop.box.slices]), skin

    def _encode(self, photo: NDArray[np.uint8], subject: Subject, known: Inputs) -> _Arrays:
        """Maps [1, h, w] of the subject's box, and its capture [1, ...], at the working size."""
        size = self.encoder.working_size
        cut = subject.crop.cut(photo, size)
        encoder_outputs = self.encoder.run({"image": cut[None], **known})
        gain = find_gain(cut, encoder_outputs["mask"][0], known)
        if gain != 1:
            cut = subject.crop.cut(brighten(photo, gain), size)
            inputs: dict[str, Any] = {"image": cut[None], **shift_exposure(known, gain)}
            encoder_outputs = scale_back(self.encoder.run(inputs), gain)
        outputs = subject.crop.turn_back(encoder_outputs, size)
        return outputs | {"mask": subject.keep_own_skin(outputs["mask"][0])[None]}

    def _decode(self, encoder_outputs: _Arrays) -> NDArray[np.float32]:
        """The decoder's picture, sRGB [h, w, 3] in [0, 1]."""
        inputs = {name: encoder_outputs[name] for name in (*MAP_NAMES, *CAPTURE_NAMES)}
        clipped: NDArray[np.float32] = np.clip(self.decoder.run(inputs)["image"][0], 0, 1)
        return clipped

    def _make_layers(
        self,
        crop: NDArray[np.uint8],
        encoder_outputs: _Arrays,
        skin: NDArray[np.float32],
        detail: bool,
    ) -> Layers:
        decoded = self._decode(encoder_outputs)
        maps = {name: encoder_outputs[name][0] for name in MAP_NAMES} | {"mask": skin}
        height, width = crop.shape[:2]
        if not detail or max(height, width) <= max(decoded.shape[:2]):
            return enlarge_layers(maps, decoded, width, height)
        tops = {name: self.encoder.output_info[name].range[1] for name in MAP_NAMES}
        pigment_tops = tops["melanin"], tops["hemoglobin"]
        table = tabulate_colours(self.decoder, encoder_outputs, pigment_tops)
        return sharpen_layers(crop, maps, decoded, table, tops["shading"], self.threads)

    def _compute_change(
        self, encoder_outputs: _Arrays, factors: Mapping[str, float]
    ) -> ColourChange:
        bare = dict(encoder_outputs) | {
            "shading": np.ones_like(encoder_outputs["shading"]),
            "specular": np.zeros_like(encoder_outputs["specular"]),
            "offset": np.zeros_like(encoder_outputs["offset"]),
        }
        scaled = {
            name: np.clip(bare[name] * np.float32(factor), 0, 1) for name, factor in factors.items()
        }
        before, after = (srgb_to_linear(self._decode(maps)) for maps in (bare, bare | scaled))
        return compute_change(before, after, encoder_outputs["mask"][0])


def _check_factors(**factors: float) -> None:
    for pigment, factor in factors.items():
        if not (math.isfinite(factor) and 0 <= factor <= MAX_FACTOR):
            raise InputError(
                f"{pigment} is multiplied by a number in [0, {MAX_FACTOR:g}]; got {factor:g}. "
                "1 leaves it as it is, 2 doubles it."
            )


def _as_picture(image: ImageLike) -> Picture:
    return image if isinstance(image, Picture) else read_picture(image)


def _name_image(image: ImageLike) -> str:
    if isinstance(image, Picture):
        return image.name
    return str(image) if isinstance(image, str | Path) else "the image"
