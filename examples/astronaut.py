"""A photograph read as skin, then tanned and flushed, with the shipped model.

    python -m examples.astronaut          # writes demo/astronaut.png

The photograph is NASA's portrait of Eileen Collins, public domain, which comes with scikit-image.
"""

from pathlib import Path

from skimage.data import astronaut

from skinnet import Decomposer
from skinnet.images.photograph import write_png
from skinnet.inference.panel import picture, pigment, sheet

TARGET = Path("demo/astronaut.png")


def main() -> None:
    """Write the strip: photograph, two maps, reconstruction, two edits."""
    decompose = Decomposer()
    photograph = astronaut()
    found = decompose(photograph)
    face = found.box.slices

    # Half as much melanin again is a tan, twice the blood a flush; nothing else is touched.
    tanned = decompose.edit(photograph, melanin=1.5)
    flushed = decompose.edit(photograph, hemoglobin=2.0)

    tiles = [
        picture("photograph", photograph[face]),
        pigment(found, "melanin"),
        pigment(found, "hemoglobin"),
        picture("reconstruction", found.reconstruction[face]),
        picture("melanin x 1.5", tanned[face]),
        picture("hemoglobin x 2", flushed[face]),
    ]
    TARGET.parent.mkdir(exist_ok=True)
    write_png(TARGET, sheet(tiles, 6))

    for name, numbers in found.summary()["maps"].items():
        print(f"{name:12} {numbers['mean']:8.4f} +- {numbers['std']:.4f} {numbers['unit']}")
    print(f"written: {TARGET}")


if __name__ == "__main__":
    main()
