"""25 synthetic people in a synthetic lightstage, through the whole classic pipeline.

`python -m examples.lightstage [-o FOLDER] [--people 25] [--texels 1024]` needs no data. Melanin
covers the whole range from palest to darkest. The skins are lit by CIE's LED-B3 and seen by a Nikon
D200 through a filter that mixes colours, as the paper's polariser does (section 4.3). The script
writes scans with textures and landmarks and runs the commands that real scans need: maps with the
full calibration, then the hybrid, linear and joint models with their measures. The truth is known,
so the errors of transform and pigments are printed.
"""

import argparse
import json
import shlex
import sys
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import torch
import torch.nn.functional as F

from examples._command import check_number
from examples._command import run as run_command
from skinnet.appearance import SkinColour, load_maps
from skinnet.cli import main as skinnet
from skinnet.errors import InputError
from skinnet.files import READ_ERRORS, make_folder
from skinnet.images import linear_to_srgb, to_uint8
from skinnet.mesh import Mesh, write_mesh
from skinnet.physics import load_spectrum_to_srgb
from skinnet.shape import load_shape_model, write_landmarks
from train.synthetic.casts.head_cast import make_blank_cast
from train.synthetic.painting.face_painting import FaceCharts, paint_face
from train.synthetic.sampling.scene_sampling import sample_scene
from train.synthetic.scene import FaceParameters, map_tensors

LIGHT, CAMERA = "LED-B3", "Nikon D200"
FILTER = np.array([[0.80, 0.05, 0.01], [0.03, 0.86, 0.04], [0.01, 0.06, 0.92]])
"""Colour transform of the polariser, which the commands do not know."""

PIGMENTS = ("f_mel", "f_blood")

_VARIETY = 0.5
"""Standard deviations of the shape model for one of the people. With whole ones, a nose tip or an
eye may lie so far off that trimmed ICP takes it for an outlier, and its texels are then unknown."""


def paint_person(number: int, people: int, texels: int) -> dict[str, np.ndarray]:
    """Paint one person's pigments and features that are not skin, [texels, texels]."""
    rng = np.random.default_rng([25, number])
    scene = sample_scene(rng, make_blank_cast(8).to_buffers())
    # Melanin covers its range evenly, in another order than the numbers.
    f_mel = 0.012 * 16 ** ((7 * number % people + rng.random()) / people)
    face = map_tensors(lambda value: value[None], _simplify(scene.face, f_mel))
    size = (texels, texels)
    charts = paint_face(face)
    painted = FaceCharts(*(F.interpolate(part, size, mode="bilinear") for part in charts))
    pores = torch.from_numpy(rng.normal(size=(2, 1, texels // 4, texels // 4)).astype(np.float32))
    pores = F.interpolate(pores, size, mode="bicubic")[:, 0].mul(0.04).exp()
    return {
        "f_mel": (painted.melanin[0, 0] * pores[0]).clamp(1e-4, 0.42).numpy(),
        "f_blood": (painted.hemoglobin[0, 0] * pores[1]).clamp(1e-4, 0.14).numpy(),
        "paint": painted.cover_colour[0].numpy(),
        "cover": painted.cover[0, 0].numpy(),
        "variates": rng.normal(size=64),
    }


def _simplify(face: FaceParameters, f_mel: float) -> FaceParameters:
    """Remove beard and make-up, thin the brows, and set the melanin."""
    melanin = face.skin.melanin._replace(fraction=torch.tensor(f_mel))
    zero = torch.tensor(0.0)
    beard = face.hair.beard._replace(beard=zero, stubble=zero)
    return face._replace(
        skin=face.skin._replace(melanin=melanin),
        hair=face.hair._replace(brow=torch.tensor(0.3), beard=beard),
        features=face.features._replace(make_up=zero),
    )


def write_person(path: Path, truth: dict[str, np.ndarray], colour: SkinColour, people: int) -> None:
    """Write a scan of that person as OBJ with PNG and landmarks, and the true maps as .npz."""
    model = load_shape_model()
    alpha = _VARIETY * truth["variates"][: len(model.variances)] * np.sqrt(model.variances)
    mesh = model.build_mesh(alpha)
    flat = [torch.from_numpy(truth[name]).flatten()[None] for name in PIGMENTS]
    skin = colour.skin(*flat)[0].reshape(3, *truth["f_mel"].shape).numpy()
    rgb = (1 - truth["cover"]) * skin + truth["cover"] * truth["paint"]
    texture = to_uint8(linear_to_srgb(np.moveaxis(rgb, 0, -1)))
    textured = Mesh(mesh.vertices, mesh.triangles, mesh.uv, mesh.uv_triangles, texture)
    pigments = {name: truth[name] for name in PIGMENTS}
    numbers = np.array([people, len(truth["f_mel"])])
    np.savez(path.with_name(f"{path.stem}_truth.npz"), numbers=numbers, **pigments)
    marks = {name: mesh.vertices[vertex] for name, vertex in model.landmarks.items()}
    write_landmarks(path.with_name(f"{path.stem}_landmarks.csv"), marks)
    # Last, so that a person whose scan is there is complete.
    write_mesh(path, textured)


def is_painted(scan: Path, people: int, texels: int) -> bool:
    """Whether a scan was painted with these numbers before; another file of its name is refused."""
    truth = scan.with_name(f"{scan.stem}_truth.npz")
    if not scan.exists() and not truth.exists():
        return False
    try:
        with np.load(truth, allow_pickle=False) as file:
            known = file["numbers"].tolist() == [people, texels]
    except READ_ERRORS:
        known = False
    if not known:
        raise InputError(
            f"{scan} is there already and was not painted for {people} people with {texels} "
            "texels; choose another folder with -o, or move it away."
        )
    return True


def run(*words: object) -> None:
    """Print a command and run it."""
    arguments = [str(word) for word in words]
    print("$ skinnet", shlex.join(arguments), flush=True)
    if skinnet(arguments):
        raise SystemExit(2)


def report(scans: list[Path], maps: Path) -> None:
    """Print the errors of the transform and of the pigments."""
    found = np.array(json.loads((maps / f"{scans[0].stem}_maps.json").read_text())["transform"])
    error = np.linalg.norm(found - FILTER) / np.linalg.norm(FILTER)
    print(f"transform: relative error {error:.4f}; found {found.round(3).tolist()}")
    for name in PIGMENTS:
        true, read = [], []
        for scan in scans:
            texture, _ = load_maps(maps / f"{scan.stem}_maps.npz")
            with np.load(scan.with_name(f"{scan.stem}_truth.npz")) as truth:
                true.append(np.median(truth[name]))
            read.append(np.median(getattr(texture, name)[texture.mask]))
        relation = np.corrcoef(true, read)[0, 1]
        off = np.sqrt(np.mean((np.array(read) - true) ** 2))
        print(f"{name}: median of each person, r {relation:.3f}, RMSE {off:.4f}")


def main(arguments: list[str] | None = None) -> int:
    """Paint people, write their scans, run the commands; return 2 for bad arguments."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("-o", "--output", type=Path, default=Path("runs/lightstage"))
    parser.add_argument("--people", type=int, default=25)
    parser.add_argument("--texels", type=int, default=1024)
    options = parser.parse_args(arguments)
    return run_command(lambda: study(options.output, options.people, options.texels))


def study(
    folder: Path, people: int, texels: int, effects: Sequence[str] = ("false", "true")
) -> None:
    """Paint people, and run the commands on their scans; a model for each scaling of features."""
    check_number("people", people, 3, 999)
    check_number("texels", texels, 16, 8192)
    make_folder(folder, "choose another folder with -o")
    colour = SkinColour(load_spectrum_to_srgb(LIGHT, CAMERA).numpy(), FILTER)
    scans = [folder / f"person_{number:02}.obj" for number in range(people)]
    painted = [is_painted(scan, people, texels) and scan.is_file() for scan in scans]
    for number, scan in enumerate(scans):
        if not painted[number]:
            write_person(scan, paint_person(number, people, texels), colour, people)
    light = ["--colour.light", LIGHT, "--colour.camera", CAMERA, "--colour.calibration", "full"]
    maps = folder / "skinmaps"
    run("maps", *scans, *light, f"--warp.size={texels}", "--warp.own_uv=true", "-o", maps)
    report(scans, maps)
    files = [maps / f"{scan.stem}_maps.npz" for scan in scans]
    for effect in effects:
        output = folder / ("model" if effect == "false" else "model_effect")
        run("build-model", *files, "-o", output, f"--appearance.effect={effect}", "--joint=true")


if __name__ == "__main__":
    sys.exit(main())
