"""The edit of photographs: the pigments of their skin, multiplied."""

from collections.abc import Iterable
from typing import Any, overload

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.images.photograph import read_picture
from skinnet.images.picture import Picture
from skinnet.inference._blood_state import BloodState, check_state
from skinnet.inference._capture_inputs import CaptureLike
from skinnet.inference._face_choice import FaceChoice
from skinnet.inference._image_list import ImageLike, is_many, locate_errors, name_all, name_image
from skinnet.inference._pigment_edit import check_factors
from skinnet.inference._subject import Region
from skinnet.inference._subject_reader import SubjectReader


class PhotoEditor(SubjectReader):
    """Edits photographs; `Decomposer` describes it."""

    @overload
    def edit(  # type: ignore[overload-overlap]  # a path is also an iterable of letters
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
        mask: NDArray[Any] | None = None,
        state: BloodState | None = None,
    ) -> NDArray[np.uint8]: ...

    @overload
    def edit(
        self,
        image: Iterable[ImageLike],
        melanin: float = 1.0,
        hemoglobin: float = 1.0,
        whole_image: bool = False,
        name: str | None = None,
        *,
        faces: FaceChoice = "largest",
        region: Region = "face",
        capture: CaptureLike | None = None,
        mask: NDArray[Any] | None = None,
        state: BloodState | None = None,
    ) -> list[NDArray[np.uint8]]: ...

    def edit(
        self,
        image: ImageLike | Iterable[ImageLike],
        melanin: float = 1.0,
        hemoglobin: float = 1.0,
        whole_image: bool = False,
        name: str | None = None,
        *,
        faces: FaceChoice = "largest",
        region: Region = "face",
        capture: CaptureLike | None = None,
        mask: NDArray[Any] | None = None,
        state: BloodState | None = None,
    ) -> NDArray[np.uint8] | list[NDArray[np.uint8]]:
        """Multiply the pigments of a photograph, or of several.

        The edit works at full resolution: texture and specular reflection stay, and pixels that are
        not skin keep their exact values.

        Args:
            image: A photograph, or several, as for a call.
            melanin: Factor of melanin in [0, 10].
            hemoglobin: Factor of hemoglobin in [0, 10].
            whole_image: Another word for `region="skin"`.
            name: Name of the image in error messages, as for a call.
            faces: "all", "largest", or how many of the largest faces to edit.
            region: "face", or "skin" to edit whatever skin the photograph shows.
            capture: What is known of the light and the camera; None: nothing.
            mask: What to edit of the skin, [H, W] as the upright photograph: bool, floats in
                [0, 1], or uint8 or uint16 whose largest value is 1. Half of it is half of the edit.
            state: What blood does, before it is multiplied, such as
                `DynamicModel.load().change({"flush": 0.7})` of `skinnet.appearance`.

        Returns:
            The edited photograph, uint8 sRGB [H, W, 3]; of several, a list of them, in order.

        Raises:
            InputError: An argument, the image or a model file cannot be used, or the image cannot
                be read, as when it is called; or a mask is given for several images.
            NoFaceError: No face was found.

        Example:
            >>> from skimage.data import astronaut
            >>> from skinnet.inference import Decomposer
            >>> edited = Decomposer().edit(astronaut(), melanin=2.0)
            >>> bool(edited[125, 224].mean() < astronaut()[125, 224].mean())  # the nose
            True
        """
        factors = {"melanin": melanin, "hemoglobin": hemoglobin}
        region = "skin" if whole_image else region
        given: Any = image
        if not is_many(given):
            picture = read_picture(given, name)
            name = name_image(given, name) or "the image"
            return self._edit(
                *(picture, factors, mask, name),
                faces=faces,
                region=region,
                capture=capture,
                state=state,
            ).picture.srgb
        if mask is not None:
            raise InputError(
                "A mask belongs to one image; edit them one by one to give each its own."
            )
        check_factors(**factors)
        check_state(state, region)
        edited = []
        for one, called, place in name_all(given, name):
            with locate_errors(one, called, place):
                picture = read_picture(one, called)
                edited.append(
                    self._edit(
                        *(picture, factors, None, called),
                        faces=faces,
                        region=region,
                        capture=capture,
                        state=state,
                    ).picture.srgb
                )
        return edited

    def edit_picture(
        self,
        picture: ImageLike,
        melanin: float = 1.0,
        hemoglobin: float = 1.0,
        whole_image: bool = False,
        name: str | None = None,
        *,
        faces: FaceChoice = "largest",
        region: Region = "face",
        capture: CaptureLike | None = None,
        mask: NDArray[Any] | None = None,
        state: BloodState | None = None,
    ) -> Picture:
        """Multiply the pigments of a picture, which keeps its depth, colour space and alpha.

        Args:
            picture: A picture from `skinnet.images.read_picture`, or what that reads.
            melanin: Factor of melanin in [0, 10].
            hemoglobin: Factor of hemoglobin in [0, 10].
            whole_image: Another word for `region="skin"`.
            name: Name of the picture in error messages; its own by default.
            faces: "all", "largest", or how many of the largest faces to edit.
            region: "face", or "skin" to edit whatever skin the photograph shows.
            capture: What is known of the light and the camera; None: nothing.
            mask: What to edit of the skin, [H, W] as the upright photograph: bool, floats in
                [0, 1], or uint8 or uint16 whose largest value is 1. Half of it is half of the edit.
            state: What blood does, before it is multiplied, such as
                `DynamicModel.load().change({"flush": 0.7})` of `skinnet.appearance`.

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
        return self._edit(
            *(read_picture(picture), factors, mask, name),
            faces=faces,
            region="skin" if whole_image else region,
            capture=capture,
            state=state,
        ).picture
