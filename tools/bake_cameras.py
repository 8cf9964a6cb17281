"""Write skinnet/images/_raw/cameras.csv: the measured cameras as reading photographs needs them.

    python -m tools.bake_cameras

Reading photographs needs no torch, so that it cannot compute these numbers itself: the coefficients
of each camera in the basis of `SpectralCamera`, and the matrix by which training turns its values
into linear sRGB. With `--stated` the mean of the colour matrices that LibRaw knows of these cameras
is printed, which `skinnet.images._raw.colours` compares other cameras with.
"""

import argparse
import csv
import sys
from collections.abc import Sequence
from io import BytesIO, StringIO
from pathlib import Path

import numpy as np
import torch
from jaxtyping import Float

from skinnet.images._raw.colours import XYZ_TO_SRGB
from skinnet.physics import SpectralCamera, load_cameras, load_light, load_observer
from skinnet.physics.camera import CAMERA_COMPONENTS
from tools.dng import Sensor, write_dng

TARGET = Path(__file__).parents[1] / "skinnet" / "images" / "_raw" / "cameras.csv"
SOURCE = (
    "cameras measured by the Academy Software Foundation (rawtoaces-data, Apache-2.0): their other "
    "names; coefficients of SpectralCamera; rows of the matrix from D65-balanced to linear sRGB"
)

_NAMES: dict[str, tuple[str, ...]] = {
    "Canon Digital Rebel XTi": ("Canon EOS Rebel XTi", "Canon EOS 400D", "Canon EOS Kiss X"),
    "Canon EOS 100D": ("Canon EOS Rebel SL1", "Canon EOS Kiss X7"),
    "Canon EOS 200D": ("Canon EOS Rebel SL2", "Canon EOS Kiss X9"),
    "Canon EOS 200D II": ("Canon EOS 250D", "Canon EOS Rebel SL3", "Canon EOS Kiss X10"),
    "Canon EOS 600D": ("Canon EOS Rebel T3i", "Canon EOS Kiss X5"),
    "Canon EOS R5m2": ("Canon EOS R5 Mark II",),
    "Canon EOS R6m2": ("Canon EOS R6 Mark II",),
    "Hasselblad L1D-20c": ("DJI Mavic 2 Pro",),
    "Hasselblad L2D-20c": ("DJI Mavic 3",),
    "Panasonic DC-GX9": ("Panasonic DC-GX7MK3", "Panasonic Lumix GX9"),
    "Sony DSC-RX100M4": ("Sony RX100 IV",),
    "Sony ILCE-6400": ("Sony a6400",),
    "Sony ILCE-7CM2": ("Sony a7C II",),
    "Sony ILCE-7M3": ("Sony a7 III",),
    "Sony ILCE-7M4": ("Sony a7 IV",),
    "Sony ILCE-7RM2": ("Sony a7R II",),
    "Sony ILCE-7RM3": ("Sony a7R III",),
    "Sony ILCE-7RM4": ("Sony a7R IV",),
    "Sony ILCE-7SM2": ("Sony a7S II",),
    "Sony ILCE-7SM3": ("Sony a7S III",),
    "Sony ILCE-9": ("Sony a9",),
}
"""Names under which makers sell cameras elsewhere, or that users know."""

_EXIF_MAKES = {"Nikon": "NIKON CORPORATION", "Sony": "SONY", "Fujifilm": "FUJIFILM"}

Matrix = Float[np.ndarray, "3 3"]


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the table, or print the mean of LibRaw's matrices."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n")[0])
    parser.add_argument("--stated", action="store_true", help="print the mean of LibRaw's matrices")
    if parser.parse_args(arguments).stated:
        print(np.array2string(average_stated(), precision=3, separator=", "))
    else:
        TARGET.write_text(make_table(), encoding="utf-8", newline="\n")
    return 0


def make_table() -> str:
    """Make the content of the table."""
    text = StringIO()
    text.write(f"# {SOURCE}\n")
    writer = csv.writer(text, lineterminator="\n")
    numbers = [f"c{each}" for each in range(CAMERA_COMPONENTS)]
    numbers += [f"m{row}{column}" for row in range(3) for column in range(3)]
    writer.writerow(("camera", "other_names", *numbers))
    coefficients = project()
    for name, curves in load_cameras().items():
        values = (*coefficients[name], *make_matrix(curves.numpy()).ravel())
        names = ";".join(_NAMES.get(name, ()))
        writer.writerow((name, names, *(f"{value:.4f}" for value in values)))
    return text.getvalue()


def project() -> dict[str, Float[np.ndarray, "components"]]:
    """Project the measured cameras on the basis of cameras, as training does."""
    model = SpectralCamera(dtype=torch.float64)
    basis = model.basis.flatten(1)
    dual = (basis / (basis**2).sum(1, keepdim=True)).T
    return {
        name: ((curves - model.mean).flatten() @ dual).numpy()
        for name, curves in load_cameras().items()
    }


def make_matrix(curves: Float[np.ndarray, "wavelength 3"]) -> Matrix:
    """Make the matrix from values balanced under D65 to linear sRGB.

    It is the least-squares map from sensitivities to the observer, as in `spectrum_to_srgb`.
    """
    white = curves.T @ load_light("D65").numpy()
    to_xyz = np.linalg.lstsq(curves, load_observer().numpy(), rcond=None)[0].T * white
    d65 = np.linalg.inv(XYZ_TO_SRGB).sum(1)
    matrix: Matrix = XYZ_TO_SRGB @ (to_xyz * (d65 / to_xyz.sum(1))[:, None])
    return matrix


def average_stated() -> Matrix:
    """Average the colour matrices that LibRaw knows of the measured cameras."""
    mean: Matrix = np.mean(list(read_stated().values()), 0)
    return mean


def read_stated() -> dict[str, Matrix]:
    """Read the colour matrices that LibRaw knows of the measured cameras, by name."""
    import rawpy

    from skinnet.images._raw.colours import read_stated_matrix

    found = {}
    for name in load_cameras():
        file = write_dng(np.zeros((64, 64, 3)), _describe(name))
        with rawpy.imread(BytesIO(file)) as raw:
            stated = read_stated_matrix(raw)
        if stated is not None:
            found[name] = stated.matrix
    return found


def _describe(name: str) -> Sensor:
    """The camera as the EXIF of its files names it."""
    make, model = name.split(" ", 1)
    if make == "Canon":
        model = name
    if make == "Nikon":
        model = f"NIKON {model}"
    return Sensor(_EXIF_MAKES.get(make, make), model)


if __name__ == "__main__":
    sys.exit(main())
