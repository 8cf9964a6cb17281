"""The reading and the edit of one subject of a photograph, by an encoder and its decoder."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.images._arguments import check_path
from skinnet.images._shot import read_shot
from skinnet.images.faces._face_parts import find_face_parts
from skinnet.images.picture import Picture
from skinnet.inference._blood_state import BloodState, check_state, place_state
from skinnet.inference._capture_inputs import CaptureLike, Inputs, join_captures, name_known
from skinnet.inference._capture_names import name_camera, name_light
from skinnet.inference._doubts import list_doubts, list_edit_doubts
from skinnet.inference._edit_mask import check_edit_mask
from skinnet.inference._edited import Edited, EditedFace
from skinnet.inference._editing import ColourMeans
from skinnet.inference._face_choice import FaceChoice
from skinnet.inference._head_crop import Arrays
from skinnet.inference._metering import brighten, find_gain, scale_back, shift_exposure
from skinnet.inference._onnx_pair import get_decoder_path, refuse_other_export
from skinnet.inference._onnx_session import check_threads
from skinnet.inference._pigment_edit import (
    EditSource,
    check_factors,
    decode,
    edit_in_place,
    select_edited,
)
from skinnet.inference._providers import choose_providers, note_fallback
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
from skinnet.inference.onnx_model import MAP_NAMES, SHIPPED_ENCODER, OnnxModel, open_model


class SubjectReader:
    """Reads and edits the subjects of photographs; `Decomposer` describes it."""

    def __init__(
        self,
        model: str | Path | None = None,
        threads: int | None = None,
        providers: str | Sequence[str] | None = None,
    ) -> None:
        self.path = SHIPPED_ENCODER if model is None else check_path("A model", model)
        self.threads = check_threads(threads)
        choose_providers(providers)  # a name that is not known is refused at once
        self.providers = providers

    def __getstate__(self) -> dict[str, Any]:
        """What a copy in another process opens the files by."""
        return {name: self.__dict__.get(name) for name in ("path", "threads", "providers")}

    @cached_property
    def encoder(self) -> OnnxModel:
        """The network from photographs to maps."""
        return open_model(self.path, "encoder", self.threads, self.providers)

    @cached_property
    def decoder(self) -> OnnxModel:
        """The skin model from maps to photographs."""
        path = get_decoder_path(self.path)
        decoder = open_model(path, "decoder", self.threads, self.providers)
        refuse_other_export(self.encoder, decoder)
        return decoder

    def load(self) -> None:
        """Open both model files now.

        Raises:
            InputError: One of them cannot be used.
        """
        _ = self.encoder, self.decoder

    def _decompose(
        self, picture: Picture, subject: Subject, name: str, detail: bool, known: Inputs
    ) -> Decomposition:
        """Read one subject of a picture."""
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
                *self._note_provider(),
                *note_transparency(alpha, mask, name),
                *subject.notes,
                *list_doubts(
                    *(who, photo[box.slices], mask, encoder_outputs, name_known(known)), colour
                ),
            ),
            output_info=self.encoder.output_info,
            model=self.encoder.describe(),
            uncertainty=Uncertainty.from_outputs(encoder_outputs, self.encoder.region_share),
            capture_known=name_known(known),
            exif=read_shot(picture.metadata.get("exif", b""))._asdict(),
            skin_chromaticity=colour,
            face_id=subject.face_id,
            faces_found=None if subject.faces is None else len(subject.faces),
            face_parts=None if subject.face is None else find_face_parts(photo, subject.face),
            provider=self.encoder.provider,
            _source=EditSource(
                picture,
                subject.crop,
                select_edited(encoder_outputs),
                self,
                None if subject.face is None else subject.face.landmarks,
            ),
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

    def _edit(
        self,
        picture: Picture,
        factors: Mapping[str, float],
        mask: NDArray[Any] | None = None,
        name: str | None = None,
        *,
        faces: FaceChoice = "largest",
        region: Region = "face",
        capture: CaptureLike | None = None,
        state: BloodState | None = None,
    ) -> Edited:
        """Edit a picture by the factors of `edit_picture`, and say what has changed."""
        check_factors(**factors)
        check_state(state, region)
        name = name or picture.name
        share = None if mask is None else check_edit_mask(mask, picture.pixels.shape, name)
        applied = apply_profile(picture, capture, is_read=False)
        picture, capture = applied.picture, applied.capture
        known, capture_notes = join_captures(picture, capture, self.encoder)
        photo, colour = picture.srgb, picture.as_colour()
        edited = replace(colour, pixels=colour.pixels.copy())
        notes = [*colour.notes, *capture_notes]
        subjects = find_subjects(photo, name, faces, region)
        changed = []
        for subject in subjects:
            subject = self._doubt_white(applied, subject, name, known)
            means, doubts = self._edit_one(
                edited, photo, subject, factors, share, name, known, state
            )
            changed.append(EditedFace(subject.face_id, subject.crop.box, means))
            notes += doubts
        edited = replace(edited, notes=tuple(dict.fromkeys(notes)))
        all_faces = subjects[0].faces
        return Edited(edited, tuple(changed), None if all_faces is None else len(all_faces))

    def _edit_one(
        self,
        colour: Picture,
        photo: NDArray[np.uint8],
        subject: Subject,
        factors: Mapping[str, float],
        share: NDArray[Any] | None,
        name: str,
        known: Inputs,
        state: BloodState | None = None,
    ) -> tuple[ColourMeans, tuple[str, ...]]:
        """Edit one subject in the pixels of `colour`. Returns mean colours, and notes."""
        box = subject.crop.box
        encoder_outputs, skin = self._read(photo, subject, known)
        skin = np.where(subject.crop.find_inside(), skin, np.float32(0))  # as the mask of a reading
        alpha = None if colour.alpha is None else colour.alpha[box.slices]
        colours = measure_chromaticity(photo[box.slices], skin)
        is_white_known = "known_white_balance" in known
        doubts = list_edit_doubts(subject.describe(name), skin, colours, is_white_known)
        outputs = select_edited(encoder_outputs)
        blood = None
        if state is not None and subject.face is not None:
            most = self.encoder.output_info["hemoglobin"].range[1]
            blood = place_state(state, outputs, subject.face.landmarks, box, most)
        means = edit_in_place(
            colour, subject.crop, outputs, skin, factors, self.decoder, share, blood
        )
        return means, (*note_transparency(alpha, skin, name), *subject.notes, *doubts)

    def _read(
        self, photo: NDArray[np.uint8], subject: Subject, known: Inputs
    ) -> tuple[Arrays, NDArray[np.float32]]:
        """Maps and capture of the subject's box, and its mask at the photograph's size."""
        encoder_outputs = self._encode(photo, subject, known)
        skin = find_skin(photo, subject, encoder_outputs["mask"][0])
        return adopt_mask(encoder_outputs, skin, photo[subject.crop.box.slices]), skin

    def _encode(self, photo: NDArray[np.uint8], subject: Subject, known: Inputs) -> Arrays:
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

    def _make_layers(
        self,
        crop: NDArray[np.uint8],
        encoder_outputs: Arrays,
        skin: NDArray[np.float32],
        detail: bool,
    ) -> Layers:
        decoded = decode(self.decoder, encoder_outputs)
        maps = {name: encoder_outputs[name][0] for name in MAP_NAMES} | {"mask": skin}
        height, width = crop.shape[:2]
        if not detail or max(height, width) <= max(decoded.shape[:2]):
            return enlarge_layers(maps, decoded, width, height)
        tops = {name: self.encoder.output_info[name].range[1] for name in MAP_NAMES}
        pigment_tops = tops["melanin"], tops["hemoglobin"]
        table = tabulate_colours(self.decoder, encoder_outputs, pigment_tops)
        return sharpen_layers(crop, maps, decoded, table, tops["shading"], self.threads)

    def _note_provider(self) -> tuple[str, ...]:
        return note_fallback(choose_providers(self.providers), self.encoder.provider)
