"""What a change of the pigments does to the chroma of skin: derivatives from the decoder."""

import numpy as np
from numpy.typing import NDArray

from skinnet.inference.full_resolution._colour_table import ColourTable, tabulate_colours
from skinnet.inference.onnx_model import OnnxModel

_STEP = 0.05
"""Half of the step in log fractions over which derivatives are taken."""

_CONTRAST = 1.4
"""How much tone curves and saturation enlarge differences of log colour: the slope of the chroma
of synthetic faces in wide captures on what the decoder says, without tone curve."""

_NEUTRAL = 6504.0
"""Colour temperature of the daylight, in kelvin, under which derivatives are taken."""


def compute_chroma(log_colour: NDArray[np.float64]) -> NDArray[np.float64]:
    """Compute log R/G and log B/G [..., 2] of log RGB [..., 3]."""
    chroma: NDArray[np.float64] = log_colour[..., ::2] - log_colour[..., 1:2]
    return chroma


def tabulate_daylight(encoder: OnnxModel, decoder: OnnxModel) -> ColourTable:
    """Tabulate the colours of skin under D65 with the mean camera."""
    inputs = {one.name: one.shape for one in decoder.session.get_inputs()}
    capture = {
        "light": np.eye(1, len(encoder.lights), dtype=np.float32),
        "temperature": np.full(1, _NEUTRAL, np.float32),
        "camera": np.zeros((1, inputs["camera"][-1]), np.float32),
        "white_balance": np.zeros((1, 2), np.float32),
    }
    melanin, hemoglobin = (encoder.output_info[name].range[1] for name in ("melanin", "hemoglobin"))
    return tabulate_colours(decoder, capture, (melanin, hemoglobin))


def differentiate_chroma(
    table: ColourTable, log_pigments: NDArray[np.float64], gloss: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Differentiate the chroma of skin by its log pigments.

    The specular reflection at the surface is white and does not change: it dilutes what pigments
    do, most of all in dark skin.

    Args:
        table: Linear RGB of bare skin.
        log_pigments: Natural logarithms of melanin and hemoglobin [N, 2].
        gloss: Specular reflection over shading [N].

    Returns:
        Derivatives [N, chroma, pigment].
    """
    columns = []
    for step in _STEP * np.eye(2):
        ends = (_look_up(table, log_pigments + way * step, gloss) for way in (1, -1))
        high, low = (compute_chroma(np.log(colour)) for colour in ends)
        columns.append(_CONTRAST * (high - low) / (2 * _STEP))
    return np.stack(columns, -1)


def _look_up(
    table: ColourTable, log_pigments: NDArray[np.float64], gloss: NDArray[np.float64]
) -> NDArray[np.float64]:
    melanin, hemoglobin = np.exp(log_pigments).astype(np.float32).T
    colour: NDArray[np.float64] = np.maximum(table(melanin, hemoglobin), 1e-4) + gloss[:, None]
    return colour
