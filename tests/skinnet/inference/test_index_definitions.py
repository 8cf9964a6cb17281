"""Indices of measured spectra, against colour-science and transcriptions of their definitions."""

import csv
import math
from pathlib import Path

import colour
import numpy as np
import pytest
from numpy.typing import NDArray

from skinnet.inference._index_definitions import (
    BANDS,
    compute_erythema_index,
    compute_lab,
    compute_melanin_index,
    compute_typology_angle,
    find_typology_group,
)

D65 = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["D65"]


@pytest.fixture(scope="module")
def spectra(shared_data: Path) -> NDArray[np.float64]:
    folder = shared_data / "spectra"
    if not folder.is_dir():
        pytest.skip("There are no measured spectra beside the repository.")
    with (folder / "nist_forearm_100.csv").open(encoding="utf-8") as file:
        bands = [row for row in csv.reader(file) if row[0].isdecimal()]
    assert [float(row[0]) for row in bands] == BANDS.tolist()
    return np.array([row[1:] for row in bands], float).T


def test_lab_is_that_of_colour_science() -> None:
    xyz = np.random.default_rng(0).uniform(0, 1.2, (200, 3)) ** 3
    white = colour.xy_to_XYZ(D65)
    np.testing.assert_allclose(compute_lab(xyz), colour.XYZ_to_Lab(xyz * white, D65), atol=1e-9)


def test_lab_and_angle_of_measured_skin_are_those_of_colour_science(
    spectra: NDArray[np.float64],
) -> None:
    shape = colour.SpectralShape(400, 720, 10)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape).values
    power = colour.SDS_ILLUMINANTS["D65"].copy().align(shape).values
    xyz = spectra @ (observer * power[:, None])
    white = power @ observer
    lab = compute_lab(xyz / white)
    expected = colour.XYZ_to_Lab(xyz / white[1], colour.XYZ_to_xy(white))
    np.testing.assert_allclose(lab, expected, atol=1e-9)
    for (lightness, _, b), angle in zip(expected, compute_typology_angle(lab), strict=True):
        assert angle == pytest.approx(math.degrees(math.atan((lightness - 50) / b)))  # b > 0


def test_melanin_and_erythema_index_are_as_defined(spectra: NDArray[np.float64]) -> None:
    """E = 100 log(red / green) and M = 100 log(1 / red), at 568 and 655 nm (Shriver & Parra)."""
    for one in spectra:
        red, green = (float(np.interp(nm, BANDS, one)) for nm in (655, 568))
        assert compute_melanin_index(one) == pytest.approx(100 * math.log10(1 / red))
        erythema = 100 * (math.log10(1 / green) - math.log10(1 / red))
        assert compute_erythema_index(one) == pytest.approx(erythema)
    assert compute_melanin_index(spectra).shape == (100,)


def test_indices_of_measured_skin_are_as_large_as_published(spectra: NDArray[np.float64]) -> None:
    """Aoki et al. 2016: 33.3 and 9.8 in Japanese forearms, by a DermaSpectrometer."""
    assert 20 < np.median(compute_melanin_index(spectra)) < 40
    assert 5 < np.median(compute_erythema_index(spectra)) < 25


def test_white_has_no_pigment() -> None:
    white = np.ones(33)
    assert compute_melanin_index(white) == 0 and compute_erythema_index(white) == 0
    np.testing.assert_allclose(compute_lab(np.ones(3)), [100, 0, 0], atol=1e-12)


def test_groups_begin_where_they_are_defined() -> None:
    names = ["very_light", "light", "intermediate", "tan", "brown", "dark"]
    assert [find_typology_group(a) for a in (55.1, 54.9, 40.9, 27.9, 9.9, -30.1)] == names
    assert find_typology_group(-180.0) == "dark"
