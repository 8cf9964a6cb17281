"""Averages of tabulated spectra over bands, which keep the power of narrow lines."""

import numpy as np
from jaxtyping import Float

WIDTH = 10.0
"""Width of the bands in nm."""

_FAR = 1000.0
"""Distance in nm from the bands beyond which a table does not matter."""

_ROUNDING = 1e-6
"""Share of a band that the distance of two rows may exceed it by, from rounding."""


def average_over_bands(
    wavelength: Float[np.ndarray, "rows"],
    values: Float[np.ndarray, "rows columns"],
    bands: Float[np.ndarray, "bands"],
) -> Float[np.ndarray, "bands columns"]:
    """Average the columns of a table over bands of 10 nm.

    A row stands for the wavelengths that are nearest to it. So a table of 5 nm has the weights 1/4,
    1/2, 1/4, one of 10 nm is taken as it is, and the sum over all bands is the integral by the
    trapezoidal rule. Rows that are farther apart than a band are interpolated linearly. A band that
    the table covers in part is averaged over that part.

    Args:
        wavelength: Wavelengths in nm, ascending.
        values: Value of each row, one column a spectrum.
        bands: Centres of the bands in nm, all of them inside the table.

    Returns:
        The averages.
    """
    wavelength, values = _fill_gaps(*_cut(wavelength, values, bands))
    middles = (wavelength[1:] + wavelength[:-1]) / 2
    first, last = 2 * wavelength[0] - middles[0], 2 * wavelength[-1] - middles[-1]
    edges = np.array([first, *middles, last])
    areas = np.cumsum(np.diff(edges)[:, None] * values, axis=0)
    integral = np.concatenate([np.zeros((1, values.shape[1])), areas])
    low, high = (np.clip(bands + side * WIDTH / 2, first, last) for side in (-1, 1))
    columns = [np.interp(high, edges, one) - np.interp(low, edges, one) for one in integral.T]
    return np.stack(columns, 1) / (high - low)[:, None]


def _cut(
    wavelength: Float[np.ndarray, "rows"],
    values: Float[np.ndarray, "rows columns"],
    bands: Float[np.ndarray, "bands"],
) -> tuple[Float[np.ndarray, "fewer"], Float[np.ndarray, "fewer columns"]]:
    """Cut a table far from the bands, so that no gap is too wide to be filled."""
    low, high = max(wavelength[0], bands[0] - _FAR), min(wavelength[-1], bands[-1] + _FAR)
    inside = wavelength[(wavelength > low) & (wavelength < high)]
    kept = np.array([low, *inside, high])
    return kept, np.stack([np.interp(kept, wavelength, one) for one in values.T], 1)


def _fill_gaps(
    wavelength: Float[np.ndarray, "rows"], values: Float[np.ndarray, "rows columns"]
) -> tuple[Float[np.ndarray, "more"], Float[np.ndarray, "more columns"]]:
    """Interpolate rows where two are farther apart than a band."""
    parts = np.ceil(np.diff(wavelength) / WIDTH - _ROUNDING).astype(int).clip(1)
    starts = np.repeat(wavelength[:-1], parts)
    steps = np.repeat(np.diff(wavelength) / parts, parts)
    counts = np.arange(parts.sum()) - np.repeat(np.cumsum(parts) - parts, parts)
    filled = np.append(starts + counts * steps, wavelength[-1])
    return filled, np.stack([np.interp(filled, wavelength, one) for one in values.T], 1)
