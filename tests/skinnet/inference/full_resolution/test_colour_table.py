import numpy as np
import torch
from painted_skin import TOP

from skinnet import SkinDecoder
from skinnet.images import srgb_to_linear
from skinnet.inference import CAPTURE_NAMES, SHIPPED_ENCODER, open_model
from skinnet.inference._onnx_pair import get_decoder_path
from skinnet.inference.full_resolution._colour_table import ColourTable


def test_the_table_equals_the_decoder(skin: SkinDecoder, table: ColourTable) -> None:
    rng = np.random.default_rng(0)
    melanin, hemoglobin = (rng.uniform(0, top, (50, 60)).astype(np.float32) for top in TOP)
    melanin[0], hemoglobin[:, 0], melanin[-1] = 0, 0, TOP[0]
    with torch.no_grad():
        exact = skin(torch.from_numpy(melanin), torch.from_numpy(hemoglobin)).permute(1, 2, 0)
    # The decoder's pictures are clipped at black, which the darkest skin reaches in blue.
    np.testing.assert_allclose(table(melanin, hemoglobin), exact.clamp(min=0).numpy(), atol=2e-4)


def test_colours_between_nodes_equal_those_of_the_file(
    skin: SkinDecoder, table: ColourTable
) -> None:
    rng = np.random.default_rng(1)
    shape = (1, 80, 90)
    melanin, hemoglobin = (top * rng.random(shape, np.float32) ** 2 for top in TOP)
    capture = skin.camera.standard()._asdict()
    inputs = {name: np.float32(capture[name].numpy())[None] for name in CAPTURE_NAMES} | {
        "melanin": np.float32(melanin),
        "hemoglobin": np.float32(hemoglobin),
        "shading": np.full(shape, 0.25, np.float32),
        "specular": np.zeros(shape, np.float32),
        "offset": np.zeros((*shape, 3), np.float32),
    }
    image = open_model(get_decoder_path(SHIPPED_ENCODER), "decoder", 1).run(inputs)["image"]
    colours = table(inputs["melanin"], inputs["hemoglobin"])
    np.testing.assert_allclose(colours, 4 * srgb_to_linear(image), atol=2e-4)


def test_derivatives_are_those_of_the_table(table: ColourTable) -> None:
    melanin, hemoglobin = np.float32([[0.03, 0.2]]), np.float32([[0.04, 0.1]])
    by_melanin, by_root = table.differentiate_log(melanin, hemoglobin)
    changed = np.log(table(melanin + 0.002, hemoglobin)) - np.log(table(melanin, hemoglobin))
    np.testing.assert_allclose(0.002 * by_melanin, changed, rtol=0.15)
    raised = (np.sqrt(hemoglobin) + np.float32(0.01)) ** 2
    changed = np.log(table(melanin, raised)) - np.log(table(melanin, hemoglobin))
    np.testing.assert_allclose(0.01 * by_root, changed, rtol=0.15)
    assert (by_melanin < 0).all() and (by_root[..., 1] < 0).all()
