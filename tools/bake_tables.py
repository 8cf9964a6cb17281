"""Write skinnet/physics/tables from colour-science and the measured tables.

    python -m tools.bake_tables shared/data/tables

The wheel carries plain CSV files on the 33 bands, 400 to 720 nm. Each has its source in its first
line. So neither colour-science nor the raw tables are needed at run time.
"""

import argparse
import csv
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

import colour
import numpy as np
import torch
from numpy.typing import NDArray

from skinnet.physics import SpectralCamera
from skinnet.physics._band_averages import average_over_bands

BANDS = np.arange(400, 721, 10)
TARGET = Path(__file__).parents[1] / "skinnet" / "physics" / "tables"
ILLUMINANTS = ("A", "FL2", "FL7", "FL11", "LED-B1", "LED-B3", "LED-B5", "LED-V1")


MEASURED = ("hemoglobin_250_1000_2nm.csv", "melanin_400_720.csv", "cameras_380_780_5nm.csv")


def main(arguments: Sequence[str] | None = None) -> int:
    """Write every table, from a folder of measured tables; return 2 if one is missing."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("raw", type=Path, help="folder of the measured tables")
    raw: Path = parser.parse_args(arguments).raw
    missing = [name for name in MEASURED if not (raw / name).is_file()]
    if missing:
        print(f"{raw} has no {', '.join(missing)}; name the folder of these.", file=sys.stderr)
        return 2
    write_light_tables()
    write_pigments(raw)
    write_cameras(raw)
    write_camera_basis()
    return 0


def write_light_tables() -> None:
    """Write observer, daylight and illuminants."""
    shape = colour.SpectralShape(400, 720, 10)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape)
    components = colour.colorimetry.SDS_BASIS_FUNCTIONS_CIE_ILLUMINANT_D_SERIES
    daylight = [components[name].copy().align(shape).values for name in ("S0", "S1", "S2")]
    lights = [average_bands(name) for name in ILLUMINANTS]
    write(
        "observer.csv",
        "CIE 1931 2 degree standard observer (CIE 015:2018), through colour-science",
        ("wavelength_nm", "x_bar", "y_bar", "z_bar"),
        np.column_stack([BANDS, observer.values]),
    )
    write(
        "daylight.csv",
        "components of the CIE D series (CIE 015:2018), through colour-science",
        ("wavelength_nm", "s0", "s1", "s2"),
        np.column_stack([BANDS, *daylight]),
    )
    write(
        "illuminants.csv",
        "relative power of CIE illuminants (CIE 015:2018), through colour-science, 10 nm bands",
        ("wavelength_nm", *ILLUMINANTS),
        np.column_stack([BANDS, *lights]),
    )


def average_bands(name: str) -> NDArray[np.float64]:
    """Average the power of an illuminant over each band."""
    # A lamp's narrow lines fall between samples that are 10 nm apart; the table has 5 nm.
    fine = colour.SDS_ILLUMINANTS[name].copy().align(colour.SpectralShape(380, 780, 5))
    return average_over_bands(fine.wavelengths, fine.values[:, None], BANDS.astype(float))[:, 0]


def write_pigments(raw: Path) -> None:
    """Write the extinction of hemoglobin and melanin."""
    hemoglobin = np.loadtxt(raw / "hemoglobin_250_1000_2nm.csv", delimiter=",", skiprows=2)
    melanin = np.loadtxt(raw / "melanin_400_720.csv", delimiter=",", skiprows=1)
    write(
        "hemoglobin.csv",
        "molar extinction, cm^-1/(mol/L), compiled by S. Prahl (OMLC) from Gratzer and Kollias",
        ("wavelength_nm", "oxy", "deoxy"),
        hemoglobin[np.isin(hemoglobin[:, 0], BANDS)],
    )
    write(
        "melanin.csv",
        "extinction, L g^-1 cm^-1, OMLC after Sarna and Swartz",
        ("wavelength_nm", "eumelanin", "pheomelanin"),
        melanin[np.isin(melanin[:, 0], BANDS)],
    )


def write_cameras(raw: Path) -> None:
    """Write the sensitivities of the measured cameras."""
    lines = (raw / "cameras_380_780_5nm.csv").read_text(encoding="utf-8").splitlines()
    head, *rows = csv.reader(line for line in lines if not line.startswith("#"))
    columns = [head.index(str(band)) for band in BANDS]
    write(
        "cameras.csv",
        "spectral sensitivities, Academy Software Foundation rawtoaces-data, Apache-2.0",
        ("camera", "channel", *(str(band) for band in BANDS)),
        [[row[0], row[1], *(float(row[column]) for column in columns)] for row in rows],
    )


def write_camera_basis() -> None:
    """Write mean and components of the measured cameras, for what must not import torch."""
    camera = SpectralCamera(dtype=torch.float64)
    curves = torch.cat([camera.mean[None], camera.basis]).mT.flatten(0, 1).tolist()
    parts = ["mean", *map(str, range(1, len(camera.basis) + 1))]
    write(
        "camera_basis.csv",
        "mean of the measured cameras, and components of one standard deviation (SpectralCamera)",
        ("part", "channel", *(str(band) for band in BANDS)),
        [[parts[row // 3], "RGB"[row % 3], *curve] for row, curve in enumerate(curves)],
    )


def write(name: str, source: str, head: Sequence[str], rows: Iterable[Sequence[object]]) -> None:
    """Write a table with its source in the first line."""
    with (TARGET / name).open("w", newline="", encoding="utf-8") as file:
        file.write(f"# {source}\n")
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(head)
        for row in rows:
            writer.writerow([f"{x:.8g}" if isinstance(x, float) else x for x in row])


if __name__ == "__main__":
    sys.exit(main())
