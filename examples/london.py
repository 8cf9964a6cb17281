"""63 portraits in one frame, read as skin, and both models of appearance built on them.

`python -m examples.london PORTRAITS [-o FOLDER]`, with the folder of the Face Research Lab London
Set (DeBruine and Jones, CC BY 4.0): NNN_03.jpg and NNN_03.tem with 189 landmarks each. The soft,
even light of that studio stands in for a lightstage; its remaining shading and specular reflection
are read as pigment here. Portraits are warped to their mean landmarks, multiplied by one common
factor, inverted under D65 and the mean camera, and compared as in Figure 8. The full calibration
refuses these pictures: they contain shading and a tone curve, which no linear transform can undo.
`--skins 200` samples so many skins from the hybrid model for synthetic faces, as skins.npz. The
pictures show real people and stay out of the project.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from scipy.interpolate import RBFInterpolator
from scipy.spatial import Delaunay
from skimage.draw import polygon2mask, polygon_perimeter
from skimage.morphology import dilation, disk, erosion

from benchmarks.portrait_faces import read_template
from examples._command import run
from skinnet.appearance import HybridModel, save_maps
from skinnet.cli import main as skinnet
from skinnet.errors import InputError
from skinnet.files import make_folder
from skinnet.images import read_photo, srgb_to_linear
from skinnet.pipeline import ColourSettings, invert_texture
from skinnet.pipeline._source import Source, choose_folder
from skinnet.shape._procedural_head import compute_chart_angles
from skinnet.texture import TextureSpace, WarpedTexture, warp_texture
from train.synthetic.sampling.model_skins import save_model_skins
from train.synthetic.scene import CHART_SIZE
from train.synthetic.skins import ChartPlaces, sample_model_skins

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

PLACES = (
    ((0, 1), (0.34, 0.02)), ((18, 27), (0.475, 0.02)), ((22, 23), (0.205, 0.0)),
    ((71, 82), (0.58, 0.15)), ((74, 79), (0.34, 0.24)), ((76, 77), (0.13, 0.165)),
    ((51, 57), (0.05, 0.03)), ((53, 59), (0.06, -0.16)), ((54, 60), (0.07, -0.32)),
    ((63, 68), (0.14, -0.43)), ((170, 172), (0.065, -0.49)), ((87, 93), (0.205, -0.655)),
    ((90, 90), (0.0, -0.600)), ((89, 91), (0.065, -0.588)), ((96, 96), (0.0, -0.66)),
    ((106, 106), (0.0, -0.738)), ((175, 175), (0.0, -0.98)), ((129, 129), (0.0, -1.10)),
    ((109, 112), (0.98, -0.04)), ((110, 113), (0.98, -0.42)), ((111, 114), (0.95, -0.62)),
    ((126, 132), (0.95, -0.84)), ((136, 142), (0.72, 0.62)), ((139, 139), (0.0, 0.78)),
)  # fmt: skip
"""Landmarks on both sides of the face, and their azimuth and elevation on the synthetic
faces' chart, which describes a place by its direction from the middle of a head."""

FRONTAL = 1.15
"""Azimuth in radians beyond which a frontal portrait shows nothing."""


def average_points(points: Sequence[np.ndarray]) -> np.ndarray:
    """Average the landmarks in texture coordinates, after aligning each portrait by its eyes."""
    aligned = []
    for one in points:
        eyes = one[[0, 1]]
        aligned.append((one - eyes.mean(0)) / np.linalg.norm(eyes[1] - eyes[0]))
    mean = np.mean(aligned, 0) * [1, -1]
    inside = mean[list(OUTLINE)]
    low, high = inside.min(0), inside.max(0)
    return 0.5 + (mean - (low + high) / 2) * (1 - 2 * MARGIN) / (high - low).max()


def mark_skin(mean: np.ndarray) -> np.ndarray:
    """Mark the skin in the frame, a little inside its outline."""
    rows = SIZE * np.stack([1 - mean[:, 1], mean[:, 0]], 1)
    mask = polygon2mask((SIZE, SIZE), rows[list(OUTLINE)])
    holes = np.any([polygon2mask((SIZE, SIZE), rows[list(hole)]) for hole in HOLES], 0)
    for hole in HOLES:
        # Closed lips enclose nothing but their own line.
        holes[polygon_perimeter(*rows[list(hole)].T, (SIZE, SIZE))] = True
    return erosion(mask, disk(SIZE // 40)) & ~dilation(holes, disk(SIZE // 100))


def warp_portraits(folder: Path) -> tuple[list[Path], list[np.ndarray], np.ndarray]:
    """Warp the portraits' linear RGB into the common frame; mark where it is skin."""
    files = sorted(folder.glob("*.tem"))
    if len(files) < 3:
        raise InputError(
            f"{folder} has {len(files)} portraits with landmarks (NNN_03.jpg and NNN_03.tem), and "
            "three are needed; name the folder of the set."
        )
    points = [read_template(file) for file in files]
    mean = average_points(points)
    # The set's outer points lie on hair and neck: triangles are those of the outline's inside.
    used = np.unique(np.concatenate([OUTLINE, np.arange(109)]))
    triangles = used[Delaunay(mean[used]).simplices]
    space = TextureSpace(mean, triangles, SIZE)
    mask = mark_skin(mean) & space.mask
    images = []
    for file, one in zip(files, points, strict=True):
        photo = read_photo(file.with_suffix(".jpg"))
        height, width = photo.shape[:2]
        uv = np.stack([one[:, 0] / width, 1 - one[:, 1] / height], 1)
        everywhere = np.ones(len(triangles), bool)
        images.append(warp_texture(space, uv[triangles], everywhere, srgb_to_linear(photo)).image)
    return files, images, mask


def find_places(mean: np.ndarray) -> ChartPlaces:
    """Find the texture coordinates of each texel of the chart in the frame of mean landmarks.

    A thin-plate spline starts from directions seen from ahead, as the frame is, so that
    little deformation is left.
    """
    marks = np.array([pair for pair, _ in PLACES])
    right = np.array([place for _, place in PLACES])
    places = np.concatenate([right * [-1, 1], right])
    points = mean[np.concatenate([marks[:, 0], marks[:, 1]])]
    places, once = np.unique(places.round(9) + 0.0, axis=0, return_index=True)
    spline = RBFInterpolator(_project(places), points[once], smoothing=1e-4)
    azimuth, elevation = (axis.double().numpy() for axis in compute_chart_angles(*CHART_SIZE))
    texels = np.stack(np.broadcast_arrays(azimuth, elevation), -1)
    found = spline(_project(texels).reshape(-1, 2)).reshape(*CHART_SIZE, 2)
    return np.where(np.abs(azimuth)[..., None] < FRONTAL, found, np.nan)


def _project(places: np.ndarray) -> np.ndarray:
    """Project the directions of azimuths and elevations on the plane of a frontal picture."""
    azimuth, elevation = places[..., 0], places[..., 1]
    return np.stack([np.cos(elevation) * np.sin(azimuth), np.sin(elevation)], -1)


def write_skins(portraits: Path, output: Path, count: int) -> None:
    """Sample skins for synthetic faces from the hybrid model in that folder."""
    mean = average_points([read_template(file) for file in sorted(portraits.glob("*.tem"))])
    model = HybridModel.load(output / "model" / "hybrid.npz")
    skins = sample_model_skins(model, find_places(mean), count)
    save_model_skins(output / "skins.npz", skins)
    print(f"{output / 'skins.npz'}: {count} skins for synthetic faces")


def main(arguments: list[str] | None = None) -> int:
    """Write the portraits' maps, then build and measure the models; return 2 for bad input."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("portraits", type=Path)
    parser.add_argument("-o", "--output", type=Path, default=Path("runs/london"))
    parser.add_argument("--calibration", default="common", help="common, full, exposure or none")
    parser.add_argument("--skins", type=int, default=0, help="skins to sample for synthetic faces")
    options = parser.parse_args(arguments)
    return run(lambda: study(options.portraits, options.output, options.calibration, options.skins))


def study(portraits: Path, output: Path, calibration: str, skins: int) -> None:
    """Write the portraits' maps, then build and measure the models."""
    files, images, mask = warp_portraits(portraits)
    maps = make_folder(output / "maps", "choose another folder with -o")
    sources = [Source.read([file.with_suffix(".jpg")]) for file in files]
    for file, source in zip(files, sources, strict=True):
        choose_folder(maps, maps, [f"{file.stem}_maps.npz"], source)
    settings = ColourSettings(calibration=calibration)
    colours = settings.calibrate([image[mask].astype(np.float64) for image in images])
    written = []
    rows = zip(files, sources, images, colours.calibration.exposures, strict=True)
    for file, source, image, factor in rows:
        texture, off = invert_texture(WarpedTexture(image, mask), factor, colours, file.stem)
        written.append(maps / f"{file.stem}_maps.npz")
        save_maps(written[-1], texture, colours.colour, source.describe("london", "maps", maps))
        medians = [np.median(one[mask]) for one in (texture.f_mel, texture.f_blood)]
        print(f"{file.stem}: melanin {medians[0]:.3f}, hemoglobin {medians[1]:.3f}, {off:.1%} off")
    for effect in ("false", "true"):
        folder = output / ("model" if effect == "false" else "model_effect")
        words = ["build-model", *map(str, written), "-o", str(folder)]
        if skinnet([*words, f"--appearance.effect={effect}"]):
            raise SystemExit(2)
    if skins:
        write_skins(portraits, output, skins)


if __name__ == "__main__":
    sys.exit(main())
