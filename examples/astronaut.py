"""Melanin and hemoglobin of a photograph, and two edits of them, with the shipped model.

    python -m examples.astronaut          # writes demo/astronaut.png

The photograph is NASA's portrait of Eileen Collins, public domain, which comes with scikit-image.
"""

from pathlib import Path

from skimage.data import astronaut

from skinnet import Decomposer
from skinnet.images._png_file import write_png
from skinnet.inference._tiles import draw_grid, draw_picture, draw_pigment_map

TARGET = Path("demo/astronaut.png")


def main() -> None:
    """Write a row of tiles: photograph, two maps, reconstruction, two edits."""
    decomposer = Decomposer()
    photo = astronaut()
    decomposition = decomposer(photo)
    head = decomposition.box.slices
    mask = decomposition.mask[head]

    # Half as much melanin again looks like a tan, twice the blood like a flush.
    tanned = decomposer.edit(photo, melanin=1.5)
    flushed = decomposer.edit(photo, hemoglobin=2.0)

    tiles = [
        draw_picture("photograph", photo[head]),
        draw_pigment_map("melanin", decomposition.melanin[head], mask),
        draw_pigment_map("hemoglobin", decomposition.hemoglobin[head], mask),
        draw_picture("reconstruction", decomposition.reconstruction[head]),
        draw_picture("melanin x 1.5", tanned[head]),
        draw_picture("hemoglobin x 2", flushed[head]),
    ]
    TARGET.parent.mkdir(exist_ok=True)
    write_png(TARGET, draw_grid(tiles, 6))

    for name, numbers in decomposition.to_dict()["maps"].items():
        print(f"{name:12} {numbers['mean']:8.4f} +- {numbers['std']:.4f} {numbers['unit']}")
    print(f"written: {TARGET}")


if __name__ == "__main__":
    main()
