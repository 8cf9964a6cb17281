"""The result for one photograph: maps, light, camera, and their summary."""

from dataclasses import dataclass
from os import PathLike
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from skinnet.inference._blood_state import BloodState
from skinnet.inference._decomposition.edit import edit_again, get_source
from skinnet.inference._decomposition.maps import MAP_FILES as MAP_FILES
from skinnet.inference._decomposition.maps import SKIN_THRESHOLD as SKIN_THRESHOLD
from skinnet.inference._decomposition.readings import SkinReadings
from skinnet.inference._decomposition.summary import summarise
from skinnet.inference._pigment_edit import ModelPair


@dataclass(frozen=True, eq=False, repr=False)
class Decomposition(SkinReadings):
    """Maps of the skin in one photograph, its light and its camera.

    image = shading * skin(melanin, hemoglobin) + specular + offset in linear RGB, under `light` and
    with `camera`. With detail this holds for every pixel of skin. Maps are 0
    outside `box`, and outside of the turned square around a tilted head.

    Attributes:
        melanin: Volume fraction of melanosomes in the epidermis, float32 [H, W] in [0, 1].
        hemoglobin: Volume fraction of blood in the dermis, float32 [H, W] in [0, 1].
        shading: Diffuse shading relative to the light, float32 [H, W].
        specular: Specular reflection relative to the light, float32 [H, W].
        mask: Probability of skin, float32 [H, W] in [0, 1].
        offset: Colour that the skin model does not explain, linear sRGB, float32 [H, W, 3].
        light: Weight of each light by name, with sum 1, and `temperature_k`, the colour temperature
            of the daylight in kelvin.
        camera: `components`, the camera's principal components in standard deviations, and
            `white_balance`, its errors as the ratios `r_over_g` and `b_over_g`.
        reconstruction: uint8 sRGB [H, W, 3]; the model's picture of skin with the network's offset,
            blended with the decoder's picture off skin; the photograph itself where nothing was
            read.
        box: The part of the photograph that was read; of a tilted head, the upright rectangle
            around the turned square that was read.
        output_info: Unit, range and description of each map of the network; `describe_map` has
            those of the maps here.
        uncertainty: Standard deviations of the natural logarithms of melanin and hemoglobin at the
            network's resolution, which `melanin_sd`, `hemoglobin_sd` and `interval` are made of.
        colour_space: The colour space in which the photograph was, and how that is known.
        notes: Sentences that the user should read, such as what was assumed of the photograph.
        model: `version` and `trained_on` of the encoder, and `optics`, the preset of the skin's
            constants to which its fractions belong: `SkinDecoder(model["optics"])` renders them.
        face_id: Number of the face, from 1, from left to right among all faces that were found in
            the photograph; None if no face was looked for.
        faces_found: Number of faces that were found in the photograph; None if none was looked for.
        face_parts: Where the parts of the face are; None if no face was looked for. It is what
            `landmarks`, `regions`, `sclera` and `teeth` are made of.
        tilt: Angle in degrees by which the head is turned clockwise; None if no face was looked
            for.
        pixels_read: Number of pixels in the box that were read; None for all of them.
        capture_known: Names of the parts of the capture that were given, such as "white_balance",
            or that a RAW file tells.
        exif: What EXIF states of the shot: `camera`, `flash` (whether it fired), `white_balance`
            (auto or manual) and `light_source`; None is what it does not state.
        skin_chromaticity: Log R/G and log B/G of the mean colour of skin in the photograph, in
            linear sRGB; None without skin.
        provider: What ran the networks: the execution provider's short name, such as cpu or cuda.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet import Decomposer
        >>> Decomposer(threads=1)(astronaut(), detail=False)
        <Decomposition 512 x 512: melanin 0.033 (90%: 0.021 to 0.053),
        hemoglobin 0.03 (90%: 0.016 to 0.055), 17% is skin>
    """

    def edit(
        self,
        melanin: float = 1.0,
        hemoglobin: float = 1.0,
        *,
        mask: NDArray[Any] | None = None,
        state: BloodState | None = None,
    ) -> NDArray[np.uint8]:
        """Multiply the pigments of the photograph that was read, without reading it again.

        Every pixel is that which `Decomposer.edit` gives for this face. For that the photograph is
        kept, and of the network's maps what an edit needs, half a megabyte.

        Args:
            melanin: Factor of melanin in [0, 10].
            hemoglobin: Factor of hemoglobin in [0, 10].
            mask: What to edit of the skin, [H, W], as for `Decomposer.edit`; None for all of it.
            state: What blood does, as for `Decomposer.edit`.

        Returns:
            The edited photograph, uint8 sRGB [H, W, 3].

        Raises:
            InputError: A factor or the mask cannot be used; a capture profile has undone the
                photograph's tone curve; or the model at hand is not that which read it.

        Example:
            >>> from skimage.data import astronaut
            >>> from skinnet import Decomposer
            >>> decomposer = Decomposer(threads=1)
            >>> face = decomposer(astronaut(), detail=False)
            >>> same = face.edit(melanin=2.0) == decomposer.edit(astronaut(), melanin=2.0)
            >>> bool(same.all())
            True
        """
        return edit_again(self, {"melanin": melanin, "hemoglobin": hemoglobin}, mask, state)

    def plot(self) -> Image.Image:
        """Draw the panel: the photograph, all maps with their scales, and the reconstruction.

        It is what `skinnet predict` writes as NAME_panel.png. Scales are fixed, and in percent;
        beside the pigments' names are their means with 90 % intervals. Notebooks show it, and
        `plot().save("panel.png")` writes it.

        Returns:
            A Pillow image of 1608 x 842 pixels.

        Raises:
            InputError: No `Decomposer` has made the decomposition, so its photograph is not known.

        Example:
            >>> from skimage.data import astronaut
            >>> from skinnet import Decomposer
            >>> Decomposer(threads=1)(astronaut(), detail=False).plot().size
            (1608, 842)
        """
        from skinnet.inference.panel import draw_panel  # it stands on decompositions

        return Image.fromarray(draw_panel(get_source(self).picture.srgb, self))

    def save(self, path: str | PathLike[str]) -> None:
        """Write everything to one .npz file, completely or not at all.

        The file holds the photograph too, so that it can be edited and drawn again; keep it as you
        keep the photograph. It has no pickles, and its format has a number.

        Args:
            path: The file; its name ends in .npz.

        Raises:
            InputError: The name does not end in .npz, the file cannot be written, or no
                `Decomposer` has made the decomposition, so its photograph is not known.

        Example:
            >>> from pathlib import Path
            >>> from tempfile import mkdtemp
            >>> from skimage.data import astronaut
            >>> from skinnet import Decomposer, Decomposition
            >>> file = Path(mkdtemp(), "face.npz")
            >>> face = Decomposer(threads=1)(astronaut(), detail=False)
            >>> face.save(file)
            >>> Decomposition.load(file).to_dict() == face.to_dict()
            True
        """
        from skinnet.inference._decomposition.archive import write_archive

        write_archive(self, path)

    @classmethod
    def load(
        cls, path: str | PathLike[str], *, decomposer: ModelPair | None = None
    ) -> "Decomposition":
        """Read a file that `save` wrote; see there for an example.

        Args:
            path: The file.
            decomposer: The `Decomposer` with which to edit, if the shipped model did not read the
                photograph; None for the shipped one, which is opened at the first edit.

        Returns:
            The decomposition: every number is that which was saved.

        Raises:
            InputError: The file is missing, damaged, of another kind or of a newer format.
        """
        from skinnet.inference._decomposition.archive import read_archive

        return cls(**read_archive(path, decomposer))

    def to_dict(self) -> dict[str, Any]:
        """Summarise the maps over skin, with light and camera, in plain types for JSON.

        It is the JSON that `skinnet predict` writes, which has `file` and `input` before it: the
        name of the file, and its path and SHA-256.

        Returns:
            `id` (of the face), `faces_found`, `photo` (size), `colour_space` (`name`,
            `known_from`), `notes`, `box`, `skin_share` (share of skin in what
            was read), `tilt` (degrees; None without a face), `maps` (`unit`, `mean`, `std`, `p5`
            and `p95` of each; None where there is no skin), `pigments` (`mean` of `melanin` and
            `hemoglobin` with its `sd` and the `interval` of the probability `level`), `indices`
            (`l_star`, `a_star`, `b_star`, `typology_angle`, `melanin_index` and `erythema_index`
            with `value`, `sd` and 90 % `interval`, `typology_group`, and `monk_tone` with `value`,
            `interval` and `delta_e`; None as in `indices`),
            `regions` (of each `melanin` and `hemoglobin` with `mean`, `std`, `median`, `sd` and
            `interval`, which are None where it is hidden, `share`, `pixels` and `indices`),
            `landmarks` (a
            list of [x, y] to a tenth of a pixel; None without a face), `light`, `camera`,
            `capture_known` (what was given of them, or a RAW file tells), `exif` (what EXIF states
            of the shot), `provider` (what ran the networks), `version` and `model`.
        """
        return summarise(self)

    def summary(self) -> dict[str, Any]:
        """Summarise the maps: another word for `to_dict`.

        Returns:
            What `to_dict` returns.
        """
        return self.to_dict()

    def _repr_html_(self) -> str:
        """Show it in a notebook: photograph, melanin and hemoglobin, numbers and notes."""
        from skinnet.inference._decomposition.notebook import to_html

        return to_html(self)
