import numpy as np
import pytest
from painted_skin import TOP, Maps, paint_maps

from skinnet import SkinDecoder
from skinnet.inference import SHIPPED_ENCODER, get_decoder_path, open_model
from skinnet.inference.full_resolution._colour_table import ColourTable, tabulate_colours


@pytest.fixture(scope="session")
def skin() -> SkinDecoder:
    return SkinDecoder(fast=False)


@pytest.fixture(scope="session")
def table(skin: SkinDecoder) -> ColourTable:
    capture = skin.camera.standard()._asdict()
    outputs = {name: np.float32(value.numpy())[None] for name, value in capture.items()}
    decoder = open_model(get_decoder_path(SHIPPED_ENCODER), "decoder", 1)
    return tabulate_colours(decoder, outputs, TOP)


@pytest.fixture(scope="session")
def truth() -> Maps:
    return paint_maps()
