"""63 portraits in one frame, read as skin, and both models of appearance built on them.

`python -m examples.london PORTRAITS [-o FOLDER]`, with the folder of the Face Research Lab London
Set (DeBruine and Jones, CC BY 4.0): NNN_03.jpg and NNN_03.tem with 189 landmarks each. The
soft, even light of that studio stands in for a lightstage: shading and gloss that it leaves count
as pigment here. Portraits are warped to their mean landmarks, calibrated together, inverted under
D65 and the mean camera, and compared as in Figure 8. The pictures show real people and stay out of
the project.
"""

import argparse
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy.spatial import Delaunay
from skimage.draw import polygon2mask, polygon_perimeter
from skimage.morphology import dilation, disk, erosion

from skinnet.appearance.mapsfile import save_maps
from skinnet.cli import main as skinnet
from skinnet.images import read_photo, srgb_to_linear
from skinnet.pipeline.calibrate import ColourSettings
from skinnet.pipeline.maps import invert
from skinnet.shape.warp import TextureSpace, Warped, warp_texture

SIZE = 512
MARGIN = 0.02

# Numbers of the set's landmarks along the outline of the skin and of what is not skin inside it.
OUTLINE = (134, 135, 136, 137, 138, 139, 140, 141, 142, 143, 144, 112, 113, 114, 133, 132, 131, 130,
           129, 128, 127, 126, 125, 111, 110, 109)  # fmt: skip
HOLES = (
    (34, 35, 36, 37, 38, 22, 30, 29, 28, 18),
    (39, 40, 41, 42, 43, 27, 33, 32, 31, 23),
    (71, 72, 73, 74, 75, 76, 84, 83),
    (77, 78, 79, 80, 81, 82, 86, 85),
    (87, 94, 95, 96, 97, 98, 93, 103, 102, 101, 100, 99),
)
"""Eyes, brows, and the line between the lips."""


def landmarks(path: Path) -> np.ndarray:
    """Points [189, 2] of a .tem file, in pixels."""
    lines = path.read_text().split("\n")
    return np.array([line.split() for line in lines[1 : int(lines[0]) + 1]], float)


def frame(points: Sequence[np.ndarray]) -> np.ndarray:
    """The mean landmarks in texture coordinates, after the portraits' own places and sizes."""
    aligned = []
    for one in points:
        eyes = one[[0, 1]]
        aligned.append((one - eyes.mean(0)) / np.linalg.norm(eyes[1] - eyes[0]))
    mean = np.mean(aligned, 0) * [1, -1]
    inside = mean[list(OUTLINE)]
    low, high = inside.min(0), inside.max(0)
    return 0.5 + (mean - (low + high) / 2) * (1 - 2 * MARGIN) / (high - low).max()


def skin(mean: np.ndarray) -> np.ndarray:
    """Where there is skin in the frame, a little inside its outline."""
    rows = SIZE * np.stack([1 - mean[:, 1], mean[:, 0]], 1)
    mask = polygon2mask((SIZE, SIZE), rows[list(OUTLINE)])
    holes = np.any([polygon2mask((SIZE, SIZE), rows[list(hole)]) for hole in HOLES], 0)
    for hole in HOLES:
        # Closed lips enclose nothing but their own line.
        holes[polygon_perimeter(*rows[list(hole)].T, (SIZE, SIZE))] = True
    return erosion(mask, disk(SIZE // 40)) & ~dilation(holes, disk(SIZE // 100))


def textures(folder: Path) -> tuple[list[Path], list[np.ndarray], np.ndarray]:
    """The portraits' linear RGB in the common frame, and where it is skin."""
    files = sorted(folder.glob("*.tem"))
    points = [landmarks(file) for file in files]
    mean = frame(points)
    # The set's outer points lie on hair and neck: triangles are those of the outline's inside.
    used = np.unique(np.concatenate([OUTLINE, np.arange(109)]))
    triangles = used[Delaunay(mean[used]).simplices]
    space = TextureSpace(mean, triangles, SIZE)
    mask = skin(mean) & space.mask
    images = []
    for file, one in zip(files, points, strict=True):
        photo = read_photo(file.with_suffix(".jpg"))
        height, width = photo.shape[:2]
        uv = np.stack([one[:, 0] / width, 1 - one[:, 1] / height], 1)
        everywhere = np.ones(len(triangles), bool)
        images.append(warp_texture(space, uv[triangles], everywhere, srgb_to_linear(photo)).image)
    return files, images, mask


def main() -> None:
    """Write the portraits' maps, then build and measure the models."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("portraits", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path("runs/london"))
    parser.add_argument("--calibration", default="full", help="full, exposure or none")
    options = parser.parse_args()
    maps = options.output / "maps"
    maps.mkdir(parents=True, exist_ok=True)
    files, images, mask = textures(options.portraits)
    settings = ColourSettings(calibration=options.calibration)
    colours = settings.calibrated([image[mask].astype(np.float64) for image in images])
    rows = zip(files, images, colours.found.exposures, strict=True)
    for file, image, factor in rows:
        texture, off = invert(Warped(image, mask), factor, colours, file.stem)
        save_maps(maps / f"{file.stem}_maps.npz", texture, colours.colour)
        medians = [np.median(one[mask]) for one in (texture.f_mel, texture.f_blood)]
        print(f"{file.stem}: melanin {medians[0]:.3f}, hemoglobin {medians[1]:.3f}, {off:.1%} off")
    for effect in ("false", "true"):
        output = options.output / ("model" if effect == "false" else "model_effect")
        skinnet(["build-model", str(maps), "-o", str(output), f"--model.effect={effect}"])


if __name__ == "__main__":
    main()
