import numpy as np
import pytest
from painted_skin import TOP, Maps, paint_maps

from skinnet import SkinDecoder
from skinnet.inference import CAPTURE_NAMES, SHIPPED_ENCODER, OnnxModel, open_model
from skinnet.inference._onnx_pair import get_decoder_path
from skinnet.inference.full_resolution._colour_table import ColourTable, tabulate_colours


@pytest.fixture(scope="session")
def decoder() -> OnnxModel:
    return open_model(get_decoder_path(SHIPPED_ENCODER), "decoder", 1)


@pytest.fixture(scope="session")
def skin(decoder: OnnxModel) -> SkinDecoder:
    return SkinDecoder(decoder.optics, fast=False)


@pytest.fixture(scope="session")
def table(skin: SkinDecoder, decoder: OnnxModel) -> ColourTable:
    capture = skin.camera.standard()._asdict()
    outputs = {name: np.float32(capture[name].numpy())[None] for name in CAPTURE_NAMES}
    return tabulate_colours(decoder, outputs, TOP)


@pytest.fixture(scope="session")
def truth() -> Maps:
    return paint_maps()
