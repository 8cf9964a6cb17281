"""Lights and cameras from files, as spectrometers and spreadsheets write them."""

from collections.abc import Callable
from pathlib import Path

import colour
import numpy as np
import pytest
from scipy.special import erf

from skinnet.cli import main
from skinnet.errors import InputError
from skinnet.physics import load_camera, load_light, load_spectrum_to_srgb

BANDS = np.arange(400.0, 721.0, 10.0)
LINES = ((404.7, 1.5), (435.8, 1.5), (546.1, 1.5), (578.0, 2.0), (610.3, 0.6))
"""Wavelength in nm, and area over the continuum, of the lines of a lamp with phosphors."""


def tabulate(path: Path, wavelength: np.ndarray, *columns: np.ndarray) -> Path:
    rows = np.column_stack([wavelength, *columns])
    path.write_text("\n".join(",".join(f"{x:.9g}" for x in row) for row in rows), encoding="utf-8")
    return path


def integrate_lamp(edges: np.ndarray, width: float) -> np.ndarray:
    """The exact integral of the lamp between edges: a sloped continuum and Gaussian lines."""
    whole = 0.02 * edges + 1e-5 * edges**2
    sigma = width / 2.355
    for place, area in LINES:
        whole = whole + 5 * area * erf((edges - place) / (sigma * 2**0.5)) / 2
    return np.diff(whole)


def average_lamp(width: float) -> np.ndarray:
    exact = integrate_lamp(np.append(BANDS - 5, 725.0), width)
    return exact / exact.sum()


def sample_lamp(wavelength: np.ndarray, width: float) -> np.ndarray:
    """What a spectrometer gives: the mean over each of its pixels."""
    middles = (wavelength[1:] + wavelength[:-1]) / 2
    edges = np.array([2 * wavelength[0] - middles[0], *middles, 2 * wavelength[-1] - middles[-1]])
    return integrate_lamp(edges, width) / np.diff(edges)


@pytest.mark.parametrize("name", ["A", "FL2", "FL7", "FL11", "LED-B3", "LED-V1"])
@pytest.mark.parametrize("step", [1, 2.5, 5])
def test_an_illuminant_by_name_and_by_file_is_the_same(
    tmp_path: Path, name: str, step: float
) -> None:
    table = colour.SDS_ILLUMINANTS[name].copy().align(colour.SpectralShape(380, 780, 5))
    wavelength = np.arange(380, 780.01, step)
    power = np.interp(wavelength, table.wavelengths, table.values)
    found = load_light(str(tabulate(tmp_path / "lamp.csv", wavelength, power))).numpy()
    tolerance = 1e-7 if step != 2.5 else 2e-3
    np.testing.assert_allclose(found, load_light(name).numpy(), rtol=0, atol=tolerance)


def merge_lines(power: np.ndarray) -> np.ndarray:
    """Add the two bands at whose edge a line lies, which wide pixels share among both."""
    return np.add.reduceat(power, [i for i in range(33) if i not in (1, 4, 15, 18)])


@pytest.mark.parametrize("width", [0.1, 0.6, 1.5])
@pytest.mark.parametrize("step", [0.1, 0.5, 1, 2, 5])
def test_narrow_lines_keep_their_power(tmp_path: Path, step: float, width: float) -> None:
    wavelength = np.arange(380, 780 + step / 2, step)
    power = sample_lamp(wavelength, width)
    found = load_light(tabulate(tmp_path / "lamp.csv", wavelength, power)).numpy()
    right = merge_lines(average_lamp(width))
    np.testing.assert_allclose(merge_lines(found), right, rtol=3e-3, atol=2e-4)


@pytest.mark.parametrize("order", [1, -1])
def test_the_pixels_of_a_spectrometer_are_irregular(tmp_path: Path, order: int) -> None:
    pixels = np.arange(1100.0)
    wavelength = (345.2 + 0.48 * pixels - 2e-5 * pixels**2)[::order]
    power = sample_lamp(wavelength, 1.5)
    found = load_light(tabulate(tmp_path / "lamp.csv", wavelength, power)).numpy()
    np.testing.assert_allclose(found, average_lamp(1.5), atol=2e-3)


@pytest.mark.parametrize("step", [10, 20])
def test_wide_steps_are_interpolated(tmp_path: Path, step: int) -> None:
    wavelength = np.arange(380.0, 741.0, step)
    power = np.random.default_rng(0).random(len(wavelength)) + 0.1
    found = load_light(tabulate(tmp_path / "lamp.csv", wavelength, power)).numpy()
    exact = np.interp(BANDS, wavelength, power)
    np.testing.assert_allclose(found, exact / exact.sum(), rtol=1e-6)


@pytest.mark.parametrize(("low", "high"), [(400, 720), (380, 730), (395, 725), (250, 2500)])
def test_the_range_covers_the_bands(tmp_path: Path, low: int, high: int) -> None:
    wavelength = np.arange(low, high + 1.0)
    found = load_light(tabulate(tmp_path / "lamp.csv", wavelength, wavelength)).numpy()
    np.testing.assert_allclose(found, BANDS / BANDS.sum(), rtol=7e-3)


@pytest.mark.parametrize(("low", "high"), [(405, 715), (400, 700), (380, 710), (410, 780)])
def test_a_range_that_ends_too_early_is_refused(tmp_path: Path, low: int, high: int) -> None:
    path = tabulate(tmp_path / "lamp.csv", np.arange(low, high + 1.0), np.arange(low, high + 1.0))
    with pytest.raises(InputError, match=f"covers {low} to {high} nm; 400 to 720 nm are needed"):
        load_light(path)


@pytest.mark.parametrize(("least", "most", "scale"), [(1e-300, 1e300, 1), (1, 1e9, 1e307)])
def test_numbers_of_any_size_are_read(
    tmp_path: Path, least: float, most: float, scale: float
) -> None:
    wavelength = np.array([least, *np.arange(380.0, 781.0, 10), most])
    power = scale * (np.clip(wavelength, 380, 780) / 780)
    found = load_light(tabulate(tmp_path / "lamp.csv", wavelength, power)).numpy()
    np.testing.assert_allclose(found, BANDS / BANDS.sum(), rtol=1e-6)


WAVELENGTH = np.arange(380.0, 781.0, 5)
POWER = 1 + ((WAVELENGTH - 380) / 100) ** 2
RIGHT = sum(np.interp(BANDS + d, WAVELENGTH, POWER) * w for d, w in ((-5, 1), (0, 2), (5, 1)))
RIGHT = RIGHT / RIGHT.sum()


def write_rows(form: Callable[[float, float], str], order: int = 1) -> str:
    pairs = zip(WAVELENGTH[::order].tolist(), POWER[::order].tolist(), strict=True)
    return "\n".join(form(w, p) for w, p in pairs)


def comma(value: float, digits: int = 4) -> str:
    return f"{value:.{digits}f}".replace(".", ",")


OCEAN = (
    "Data from lamp_0001.txt Node\n\nDate: Thu Mar 04 10:21:33 CET 2021\nUser: lab\n"
    "Integration Time (sec): 1,000000E-1\nScans to average: 10\n"
    "Number of Pixels in Spectrum: 2048\n>>>>>Begin Spectral Data<<<<<\n"
)
THORLABS = "[SpectrumHeader]\nDate;20210304\n#AveragedScans;10\n[Data]\n"
AVANTES = "Lamp 1\nIntegration time [ms]: 100,00\n\nWave   ;Power\n[nm]   ;[uW/cm2/nm]\n\n"

FILES = {
    "plain.csv": write_rows(lambda w, p: f"{w},{p}"),
    "header.CSV": "wavelength,power\n" + write_rows(lambda w, p: f"{w},{p}"),
    "units.csv": "Wavelength,Power\nnm,W/m2/nm\n" + write_rows(lambda w, p: f"{w:g},{p}"),
    "comments.txt": "# a lamp\n% of ours\n" + write_rows(lambda w, p: f"{w} {p}") + "\n# end\n",
    "savetxt.txt": "# wavelength power\n" + write_rows(lambda w, p: f"{w:.18e} {p:.18e}"),
    "descending.csv": write_rows(lambda w, p: f"{w},{p}", -1),
    "tabs.tsv": "nm\tpower\n" + write_rows(lambda w, p: f"{w}\t{p}"),
    "columns.dat": write_rows(lambda w, p: f"   {w:8.2f}    {p:12.6f}  "),
    "spaces.csv": write_rows(lambda w, p: f"{w}, {p}"),
    "decimal_commas.csv": write_rows(lambda w, p: f"{comma(w, 1)};{comma(p)}"),
    "three_decimals.csv": "nm;W\n" + write_rows(lambda w, p: f"{w:.0f};{comma(p, 3)}"),
    "comma_tabs.txt": write_rows(lambda w, p: f"{comma(w)}\t{comma(p)}"),
    "comma_spaces.txt": write_rows(lambda w, p: f"{comma(w, 1)}   {comma(p)}"),
    "quoted.csv": '"nm","power"\n' + write_rows(lambda w, p: f'"{w}","{p}"'),
    "quoted_commas.csv": write_rows(lambda w, p: f'"{comma(w, 1)}","{comma(p)}"'),
    "excel.csv": "sep=;\nnm;power\n" + write_rows(lambda w, p: f"{w};{p};;"),
    "trailing.csv": "nm,power,,\n" + write_rows(lambda w, p: f"{w},{p},,"),
    "carriage.csv": write_rows(lambda w, p: f"{w},{p}").replace("\n", "\r"),
    "windows.csv": write_rows(lambda w, p: f"{w},{p}").replace("\n", "\r\n") + "\r\n\r\n",
    "percent.csv": "nm,power (%)\n" + write_rows(lambda w, p: f"{w},{p}%"),
    "scientific.csv": write_rows(lambda w, p: f"{w:E},{p * 1e-9:.9E}"),
    "with_unit.txt": "uSpectrum\n" + write_rows(lambda w, p: f"{w:g}nm\t{p}"),
    "reversed.csv": "power,wavelength (nm)\n" + write_rows(lambda w, p: f"{p},{w}"),
    "micrometres.csv": "wavelength (um),W\n" + write_rows(lambda w, p: f"{w / 1000:.4f},{p}"),
    "micro_bare.csv": write_rows(lambda w, p: f"{w / 1000:.4f},{p}"),
    "angstrom.csv": "wavelength [Å],W\n" + write_rows(lambda w, p: f"{w * 10:g},{p}"),
    "angstrom_bare.csv": write_rows(lambda w, p: f"{w * 10:g},{p}"),
    "metres.csv": "wavelength (m),W\n" + write_rows(lambda w, p: f"{w * 1e-9:.6e},{p}"),
    "ocean.txt": OCEAN
    + write_rows(lambda w, p: f"{comma(w, 2)}\t{comma(p)}")
    + "\n>>>>>End Processed Spectral Data<<<<<\n",
    "thorlabs.csv": THORLABS + write_rows(lambda w, p: f"{w};{p}") + "\n[EndOfFile]\n",
    "avantes.ttt": AVANTES + write_rows(lambda w, p: f"{comma(w, 1)};{comma(p)}"),
}


@pytest.mark.parametrize("name", FILES)
def test_a_file_of_the_same_numbers_is_the_same_light(tmp_path: Path, name: str) -> None:
    (tmp_path / name).write_text(FILES[name], encoding="utf-8", newline="")
    found = load_light(str(tmp_path / name)).numpy()
    np.testing.assert_allclose(found, RIGHT, rtol=1e-3)


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16", "utf-16-le", "utf-16-be", "latin-1"])
def test_the_encoding_is_found(tmp_path: Path, encoding: str) -> None:
    text = "Wellenlänge (nm);µW\n" + write_rows(lambda w, p: f"{comma(w, 1)};{comma(p)}")
    (tmp_path / "lamp.csv").write_bytes(text.encode(encoding))
    np.testing.assert_allclose(load_light(tmp_path / "lamp.csv").numpy(), RIGHT, rtol=1e-3)


def test_dark_noise_is_no_light(tmp_path: Path) -> None:
    rng = np.random.default_rng(0)
    wavelength = np.arange(350.0, 1000.0, 0.4)
    bright = np.exp(-(((wavelength - 560) / 30) ** 2))
    noisy = bright + rng.normal(0, 0.01, len(wavelength))
    assert noisy.min() < -0.02
    found = load_light(tabulate(tmp_path / "led.csv", wavelength, noisy)).numpy()
    assert found.min() >= 0
    exact = load_light(tabulate(tmp_path / "exact.csv", wavelength, bright)).numpy()
    np.testing.assert_allclose(found, exact, atol=1e-3)


CURVES = np.exp(-(((WAVELENGTH[:, None] - [600, 540, 460]) / 40) ** 2)) + 1e-3


def camera_text(heading: str, order: str, separator: str = ",") -> str:
    columns = CURVES[:, ["rgb".index(channel) for channel in order]]
    rows = [separator.join(map(str, (w, *row))) for w, row in zip(WAVELENGTH, columns, strict=True)]
    return "\n".join([heading, *rows])


@pytest.mark.parametrize(
    ("heading", "order", "separator"),
    [
        ("", "rgb", ","),
        ("wavelength,r,g,b", "rgb", ","),
        ("wavelength,b,g,r", "bgr", ","),
        ("Wavelength (nm),Blue,Green,Red", "bgr", ","),
        ("nm,G,R,B", "grb", ","),
        ("# wavelength, sensB, sensG, sensR", "bgr", ","),
        ("wavelength,D200_B,D200_G,D200_R", "bgr", ","),
        ("Wellenlänge;Blau;Grün;Rot", "bgr", ";"),
        ("nm\tbleu\tvert\trouge", "bgr", "\t"),
    ],
)
def test_the_columns_of_a_camera_have_names(
    tmp_path: Path, heading: str, order: str, separator: str
) -> None:
    (tmp_path / "a.csv").write_text(camera_text("", "rgb"))
    (tmp_path / "b.csv").write_text(camera_text(heading, order, separator), encoding="utf-8")
    right, found = (load_camera(tmp_path / f"{name}.csv").numpy() for name in "ab")
    np.testing.assert_allclose(found, right, rtol=1e-12)
    assert (np.diff(BANDS @ found) < -40).all()


@pytest.mark.parametrize(("step", "error"), [(0.5, 4e-4), (1, 1.5e-3), (2, 3e-3), (5, 0.03)])
def test_a_camera_is_averaged_over_the_bands(tmp_path: Path, step: float, error: float) -> None:
    """Narrow filters, against the exact mean of a Gaussian over each band."""
    wavelength = np.arange(380, 780 + step / 2, step)
    centres, sigma = np.array([601.5, 538.0, 466.0]), 6.0
    curves = np.exp(-(((wavelength[:, None] - centres) / sigma) ** 2) / 2)
    found = load_camera(tabulate(tmp_path / "camera.csv", wavelength, *curves.T)).numpy()
    edges = np.append(BANDS - 5, 725.0)
    exact = np.diff(erf((edges[:, None] - centres) / (sigma * 2**0.5)), axis=0)
    np.testing.assert_allclose(found, exact / exact.sum(0), atol=error)


@pytest.mark.parametrize(
    ("heading", "order", "words"),
    [
        ("", "bgr", "mean wavelengths are 4.* red, green and blue descend"),
        ("wavelength,r,g,b", "bgr", "descend"),
        ("nm,A,D65,FL11", "rgb", "columns A, D65, FL11.*name them r, g and b"),
        ("nm,x_bar,y_bar,z_bar", "rgb", "name them r, g and b"),
        ("nm,r,g,g", "rgb", "name them r, g and b"),
        ("nm,QE red,QE green,QE blue", "rgb", "counts photons"),
    ],
)
def test_columns_of_another_order_are_refused(
    tmp_path: Path, heading: str, order: str, words: str
) -> None:
    (tmp_path / "a.csv").write_text(camera_text(heading, order))
    with pytest.raises(InputError, match=words):
        load_camera(tmp_path / "a.csv")


def test_a_light_is_no_camera_and_a_camera_no_light(tmp_path: Path) -> None:
    (tmp_path / "camera.csv").write_text(camera_text("nm,r,g,b", "rgb"))
    (tmp_path / "light.csv").write_text(FILES["header.CSV"])
    with pytest.raises(InputError, match=r"camera.csv needs 2 columns.*has 4 columns, nm, r, g, b"):
        load_light(tmp_path / "camera.csv")
    with pytest.raises(InputError, match=r"light.csv needs 4 columns.*has 2 columns, wavelength"):
        load_camera(tmp_path / "light.csv")


BAD = {
    "two_lamps": ("nm,A,B\n400,1,2\n720,1,2", "needs 2 columns.*nm, A, B"),
    "wide": ("nm,400,410,720\npower,1,2,3", "has no table of numbers"),
    "numbered": ("0,400,1\n1,560,1\n2,720,1", "needs 2 columns"),
    "comma_twice": ("400,0,1,5\n720,0,1,5", "needs 2 columns"),
    "mixed": ("400.5;1,5\n720;1,5", "decimals or thousands"),
    "thousands": ('nm,power\n400,"1,200"\n560,998\n720,"1,100"', "decimals or thousands"),
    "missing": ("400,1\n560,\n720,1", "line 2, has a value that is missing"),
    "nan": ("400,1\n560,NaN\n720,1", "line 2, has a value that is missing"),
    "overflow": ("400,1\n560,over\n720,1", "line 2: '560,over' is not 2 numbers"),
    "typing": ("400,1\n56o,1\n720,1", "line 2: '56o,1' is not 2 numbers"),
    "two_tables": ("nm,A\n400,1\n720,1\nnm,B\n400,1\n720,1", "line 4: 'nm,B'"),
    "two_spectra": ("390,1\n560,1\n730,1\n391,1\n560,1\n731,1", "go up and down"),
    "twice": ("400,1\n560,1\n560,2\n720,1", "a wavelength twice, 560 nm"),
    "negative": ("400,1\n560,-.2\n720,1", "negative"),
    "dark_not_taken": ("400,-.04\n560,-.04\n600,1\n610,-.04\n720,-.04", "more than noise"),
    "dark": ("400,0\n560,0\n720,0", "is zero from 400 to 720 nm"),
    "wavenumber": ("wavenumber (cm-1),power\n1000,1\n13000,1\n30000,1", "convert it to wavelen"),
    "terahertz": ("THz,power\n380,1\n760,1", "convert it to wavelengths"),
    "energy": ("energy (eV),power\n0.3,1\n4,1", "convert it to wavelengths"),
    "contradiction": ("wavelength (um),power\n380,1\n780,1", "look like nm"),
    "photons": ("nm,photon flux (umol/m2/s)\n380,1\n780,1", "counts photons"),
    "quantum": ("nm,PPFD\n380,1\n780,1", "counts photons"),
    "cgats": ('CGATS.17\nBEGIN_DATA_FORMAT\nnm p\nEND_DATA_FORMAT\nBEGIN_DATA\n380 1', "a CGATS"),
    "argyll": ('SPECT   \n\nORIGINATOR "Argyll spotread"\nBEGIN_DATA\n1 2 3', "a CGATS file"),
    "spdx": ('<?xml version="1.0"?><IESTM2714 version="1.0">', "an XML"),
    "json": ('{"wavelength": [400, 720]}', "a JSON file"),
    "sheet": ("PK\x03\x04 sheet", "a spreadsheet"),
    "one_line": ("[" + 99999 * "1, " + "1]", "has no table of numbers"),
    "one_row": ("560,1", "covers 560 to 560 nm"),
    "words": ("a lamp of ours", "has no table of numbers"),
    "empty": ("", "has no table of numbers"),
}  # fmt: skip


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_read_is_named(tmp_path: Path, name: str) -> None:
    text, words = BAD[name]
    (tmp_path / "bad.csv").write_text(text)
    with pytest.raises(InputError, match=f"bad.csv.*{words}"):
        load_light(tmp_path / "bad.csv")


@pytest.mark.parametrize("ending", [".csv", ".CSV", ".txt", ".tsv", ".spd", ".dat", ""])
def test_a_path_is_no_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, ending: str) -> None:
    monkeypatch.chdir(tmp_path)
    path = Path(f"A{ending}")
    path.write_text(FILES["plain.csv"], encoding="utf-8")
    np.testing.assert_allclose(load_light(path).numpy(), RIGHT, rtol=1e-3)
    np.testing.assert_allclose(load_light(f"./{path}").numpy(), RIGHT, rtol=1e-3)
    by_name = load_light(str(path)).numpy()
    right = RIGHT if ending else load_light("a").numpy()
    np.testing.assert_allclose(by_name, right, rtol=1e-3)


def test_an_absent_file_is_named(tmp_path: Path) -> None:
    for path in (tmp_path / "absent.csv", tmp_path, tmp_path / "A"):
        with pytest.raises(InputError, match="cannot be read as a text file; check the path"):
            load_light(path)
    with pytest.raises(InputError, match="no light 'FL99'"):
        load_light("FL99")


def test_a_fluorescent_lamp_gives_the_colours_of_its_name(tmp_path: Path) -> None:
    table = colour.SDS_ILLUMINANTS["FL11"].copy().align(colour.SpectralShape(380, 780, 5))
    path = tabulate(tmp_path / "FL11.csv", table.wavelengths, table.values)
    named, filed = (load_spectrum_to_srgb(light, "Nikon D200") for light in ("FL11", path))
    np.testing.assert_allclose(filed.numpy(), named.numpy(), rtol=1e-5, atol=1e-8)


def test_the_command_reports_a_bad_file(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "bad.csv").write_text(BAD["two_lamps"][0])
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
    light = str(tmp_path / "bad.csv")
    assert main(["maps", str(tmp_path / "a.obj"), "--colour.light", light]) == 2
    said = capsys.readouterr().err
    assert "bad.csv needs 2 columns" in said and "Traceback" not in said


@pytest.mark.parametrize("gap", [(450, 550), (500, 690), (380, 480)])
def test_a_table_with_a_wide_gap_is_refused(tmp_path: Path, gap: tuple[int, int]) -> None:
    rows = [nm for nm in range(380, 781, 5) if not gap[0] < nm < gap[1]]
    path = tmp_path / "a.csv"
    path.write_text("".join(f"{nm},1.0\n" for nm in rows))
    with pytest.raises(InputError, match=rf"no row between {gap[0]} and {gap[1]} nm; .*Complete"):
        load_light(str(path))
