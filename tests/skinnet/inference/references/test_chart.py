"""Charts come from colour-science or from a CSV file, which is read strictly."""

from pathlib import Path

import colour
import numpy as np
import pytest

from skinnet.errors import InputError
from skinnet.inference._references.chart import Chart, load_chart


def write(path: Path, chart: Chart, columns: dict[str, np.ndarray]) -> Path:
    head = ["name", "row", "column", *columns]
    rows = [
        [f"p{number}", int(row) + 1, int(column) + 1, *(each[number] for each in columns.values())]
        for number, (column, row) in enumerate(chart.cells)
    ]
    lines = [",".join(map(str, line)) for line in (head, *rows)]
    path.write_text("# my chart\n" + "\n".join(lines) + "\n", encoding="utf-8")
    return path


def make_lab(chart: Chart) -> dict[str, np.ndarray]:
    d50 = colour.CCS_ILLUMINANTS["CIE 1931 2 Degree Standard Observer"]["D50"]
    xyz = colour.RGB_to_XYZ(chart.colours, "sRGB", d50)
    return dict(zip("Lab", colour.XYZ_to_Lab(xyz, d50).T, strict=True))


def test_the_classic_chart_has_its_published_colours(classic: Chart) -> None:
    published = colour.CCS_COLOURCHECKERS["BabelColor Average"]
    xyz = colour.xyY_to_XYZ(np.array(list(published.data.values())))
    rgb = colour.XYZ_to_RGB(xyz, "sRGB", published.illuminant)
    lab = [colour.XYZ_to_Lab(colour.RGB_to_XYZ(each, "sRGB")) for each in (classic.colours, rgb)]
    assert np.median(colour.delta_E(*lab)) < 1.5
    assert classic.shape == (6, 4) and np.flatnonzero(classic.neutral).tolist() == [*range(18, 24)]


def test_lab_and_spectra_are_read(tmp_path: Path, classic: Chart) -> None:
    own = load_chart(write(tmp_path / "lab.csv", classic, make_lab(classic)))
    np.testing.assert_allclose(own.colours, classic.colours, atol=2e-3)
    assert own.spectra is None and own.shape == (6, 4)
    columns = {str(band): classic.spectra[:, at] for at, band in enumerate(range(400, 721, 10))}
    spectral = load_chart(write(tmp_path / "spectra.csv", classic, columns))
    np.testing.assert_allclose(spectral.spectra, classic.spectra)
    np.testing.assert_allclose(spectral.colours, classic.colours)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        (lambda text: text.replace("row", "line"), "it needs the columns row and column"),
        (lambda text: text.replace("p3,1,4,", "p3,1,3,"), "not each cell of 4 rows and 6 columns"),
        (lambda text: text.replace("p3,1,4,", "p3,1,four,"), "'four' as its column"),
        (lambda text: text.replace(",L,", ",x,"), "has no colours; it needs"),
        (lambda text: "\n".join(text.split("\n")[:8]), "has 6 patches, and 12 are needed"),
        (lambda text: "", "it needs the columns"),
    ],
)
def test_a_damaged_file_is_refused(tmp_path: Path, classic: Chart, change, sentence: str) -> None:
    path = write(tmp_path / "own.csv", classic, make_lab(classic))
    path.write_text(change(path.read_text()))
    with pytest.raises(InputError, match=sentence):
        load_chart(path)


def test_percent_is_refused(tmp_path: Path, classic: Chart) -> None:
    columns = {"400": 100 * classic.colours[:, 0], "720": classic.colours[:, 1]}
    with pytest.raises(InputError, match="Were they given in percent"):
        load_chart(write(tmp_path / "own.csv", classic, columns))


@pytest.mark.parametrize("name", ["passport", "chart.jpg", "absent.csv"])
def test_a_chart_that_is_not_there_is_named(name: str) -> None:
    with pytest.raises(InputError, match=name):
        load_chart(name)


def test_a_missing_chart_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"There is no chart .*nope\.csv; give classic, or a CSV"):
        load_chart(tmp_path / "nope.csv")
