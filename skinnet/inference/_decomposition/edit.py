"""The photograph of a decomposition with other pigments, without reading it again."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from skinnet.errors import InputError
from skinnet.inference._blood_state import BloodState, check_state, place_state
from skinnet.inference._decomposition.maps import SkinMaps
from skinnet.inference._edit_mask import check_edit_mask
from skinnet.inference._pigment_edit import EditSource, ModelPair, check_factors, edit_in_place


def edit_again(
    maps: SkinMaps,
    factors: Mapping[str, float],
    mask: NDArray[Any] | None,
    state: BloodState | None = None,
) -> NDArray[np.uint8]:
    """Multiply the pigments, as `Decomposition.edit` describes: uint8 sRGB [H, W, 3]."""
    check_factors(**factors)
    check_state(state, "face")
    source = get_source(maps)
    if source.outputs is None:
        raise InputError(
            "A capture profile has undone the tone curve of this photograph for the reading, so "
            "that it cannot be edited from it; use Decomposer.edit with the photograph and the "
            "profile."
        )
    share = None if mask is None else check_edit_mask(mask, maps.mask.shape)
    colour = source.picture.as_colour()
    edited = replace(colour, pixels=colour.pixels.copy())
    skin = maps.mask[source.crop.box.slices]
    decoder = _find_models(maps, source).decoder
    blood = None if state is None else _find_blood(maps, source, state)
    edit_in_place(edited, source.crop, source.outputs, skin, factors, decoder, share, blood)
    return edited.srgb


def _find_blood(maps: SkinMaps, source: EditSource, state: BloodState) -> NDArray[np.float32]:
    """Hemoglobin [1, h, w] in a state."""
    if source.landmarks is None or source.outputs is None:
        raise InputError(
            "A state of blood is laid out by the landmarks of a face, and this decomposition has "
            "none: it is of skin without a face, or of an earlier version's file."
        )
    most = maps.output_info["hemoglobin"].range[1]
    return place_state(state, source.outputs, source.landmarks, source.crop.box, most)


def get_source(maps: SkinMaps) -> EditSource:
    """The photograph that was read, and what is kept of the reading.

    Raises:
        InputError: It is not known.
    """
    if maps._source is None:
        raise InputError(
            "The photograph of this decomposition is not known, since no Decomposer has made it; "
            "read the photograph, and use what is given back."
        )
    return maps._source


def _find_models(maps: SkinMaps, source: EditSource) -> ModelPair:
    """The models that have read the photograph.

    Raises:
        InputError: Those at hand are others.
    """
    if source.models is not None:
        models = source.models
    else:
        from skinnet.inference.decomposer import Decomposer  # it stands on decompositions

        models = Decomposer()
    own = models.encoder.describe()
    if own != maps.model:
        raise InputError(
            f"The photograph was read with another model (version {maps.model.get('version')}, "
            f"{maps.model.get('optics')}) than that at hand (version {own['version']}, "
            f"{own['optics']}); give the one that read it: Decomposition.load(path, decomposer="
            "Decomposer(model))."
        )
    return models
