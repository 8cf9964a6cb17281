"""Fitted faces under four lights, by the spectral renderer Mitsuba 3, beside our own renderer.

    python -m examples.relighting [-o docs/figures/relighting.png] [--size 240] [--samples 64]

The faces are synthetic people whom `examples.lightstage` takes through the whole pipeline into the
folder `--lightstage`; what is there already is not computed again. Columns: `skinnet.render`, then
Mitsuba under D65, A, FL11 and LED-B3, and with twice the hemoglobin and 1.5 times the melanin, as
in Figure 6 of the paper.
"""

import argparse
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from examples import lightstage
from examples._command import check_number, check_picture, run, write_picture
from skinnet.appearance import PigmentEdit, edit_texture, load_maps
from skinnet.appearance.colour import SkinColour
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.errors import InputError
from skinnet.images import linear_to_srgb, resize, to_uint8
from skinnet.inference._tiles import draw_grid, draw_picture
from skinnet.material import MitsubaCapture
from skinnet.mesh import Mesh, read_mesh, write_mesh
from skinnet.pipeline import RelightSettings
from skinnet.pipeline._model_figures import fill_texels
from skinnet.render import frame_face

TARGET = Path("docs/figures/relighting.png")
LIGHTS = ("D65", "A", "FL11", "LED-B3")
CAMERA = "Nikon D200"
MORE_SAMPLES = {"FL11": 8}
"""Factor on the samples of a light in narrow lines, which random wavelengths seldom meet."""

YAW = 20.0
EDITS = {"hemoglobin x 2": (1.0, 2.0), "melanin x 1.5": (1.5, 1.0)}

KEY, SKY = 0.75, 0.45
"""Radiance of a white surface that faces the lamp, and of the sky."""


def draw(options: argparse.Namespace) -> None:
    """Render every person in every light, and write the picture."""
    check_picture(options.output, TARGET, "relighting")
    check_number("size", options.size, 16, 2048)
    check_number("samples", options.samples, 1, 65536)
    choose_variant(options.variant)
    lightstage.study(options.lightstage, options.people, options.texels, [])
    maps = [options.lightstage / f"skinmaps/person_{k:02}_maps.npz" for k in range(options.people)]
    chosen = choose_faces([load_maps(file) for file in maps])
    tiles = [tile for texture, colour in chosen for tile in draw_row(texture, colour, options)]
    sheet = draw_grid(tiles, 1 + len(LIGHTS) + len(EDITS))
    half = resize(sheet, sheet.shape[1] // 2, sheet.shape[0] // 2)
    write_picture(options.output, half, "relighting")


def choose_variant(name: str) -> None:
    """Set a variant of Mitsuba."""
    try:
        import mitsuba
    except ImportError as error:
        raise InputError('It needs the mitsuba extra: pip install "skinnet[mitsuba]"') from error
    if name not in mitsuba.variants():
        raise InputError(f"Mitsuba has no variant {name}; it has {', '.join(mitsuba.variants())}.")
    mitsuba.set_variant(name)


def choose_faces(
    faces: list[tuple[SkinTexture, SkinColour]],
) -> list[tuple[SkinTexture, SkinColour]]:
    """Choose the lightest and the darkest face, and the one between them on a logarithmic scale."""
    melanin = np.log([max(measure_melanin(texture), 1e-3) for texture, _ in faces])
    levels = np.linspace(melanin.min(), melanin.max(), 3)
    return [faces[int(np.abs(melanin - level).argmin())] for level in levels]


def measure_melanin(texture: SkinTexture) -> float:
    """Median fraction of melanosomes."""
    return float(np.median(texture.f_mel[texture.mask]))


def draw_row(
    texture: SkinTexture, colour: SkinColour, options: argparse.Namespace
) -> list[Image.Image]:
    """Draw tiles of one person."""
    mesh = read_mesh(Path(texture.name.replace("_maps.npz", "_face.obj")))
    plain = SkinColour(None, None, colour.optics)
    own = RelightSettings(size=options.size, yaw=YAW, above=SKY, below=SKY).render(
        mesh, fill_texels(texture.albedo(plain), texture.mask)
    )
    tiles = [draw_picture("skinnet.render, D65", own)]
    for light in LIGHTS:
        tiles.append(
            draw_picture(f"Mitsuba, {light}", render(mesh, texture, colour, light, options))
        )
    for name, (melanin, hemoglobin) in EDITS.items():
        edited = edit_texture(texture, colour, PigmentEdit(melanin), PigmentEdit(hemoglobin))
        tiles.append(draw_picture(f"{name}, D65", render(mesh, edited, colour, "D65", options)))
    return tiles


def render(
    mesh: Mesh, texture: SkinTexture, colour: SkinColour, light: str, options: argparse.Namespace
) -> NDArray[np.uint8]:
    """Render a face in a lamp of 6 degrees and an even sky, both of one spectrum."""
    import mitsuba as mi

    capture = MitsubaCapture(light, CAMERA)
    skin = make_skin(capture, texture, colour)
    with TemporaryDirectory() as folder:
        file = Path(folder, "face.obj")
        write_mesh(file, Mesh(mesh.vertices, mesh.triangles, mesh.uv, mesh.uv_triangles))
        scene = mi.load_dict(
            {
                "type": "scene",
                "integrator": {"type": "path", "max_depth": 3},
                "sensor": make_sensor(mesh, capture.film(options.size, options.size)),
                "sky": {"type": "constant", "radiance": capture.light(SKY)},
                "lamp": {
                    "type": "directional",
                    "direction": [0.45, -0.55, -0.75],
                    "irradiance": capture.light(KEY * np.pi),
                },
                "face": {
                    "type": "obj",
                    "filename": str(file),
                    "bsdf": skin,
                },
            }
        )
        samples = options.samples * MORE_SAMPLES.get(light, 1)
        linear = capture.develop(mi.render(scene, spp=samples))
    return to_uint8(linear_to_srgb(linear.astype(np.float32)))


def make_skin(capture: MitsubaCapture, texture: SkinTexture, colour: SkinColour) -> dict[str, Any]:
    """Make glossy skin. The offset is a colour under the scan's own light, camera and filter."""
    f_mel, f_blood = (np.where(texture.mask, one, 0.05) for one in (texture.f_mel, texture.f_blood))
    offset = np.where(texture.mask[..., None], texture.offset, 0)
    matrix = colour.matrix @ colour.calibration.T
    skin = capture.skin(f_mel, f_blood, offset, matrix, colour.optics)
    glossy = {"type": "roughplastic", "int_ior": 1.4, "alpha": 0.35, "diffuse_reflectance": skin}
    return {"type": "twosided", "bsdf": glossy}


def make_sensor(mesh: Mesh, film: dict[str, Any]) -> dict[str, Any]:
    """Make the sensor of the view that our own renderer takes."""
    import mitsuba as mi

    view = frame_face(mesh.vertices, (film["height"], film["width"]), YAW)
    angle = 2 * np.rad2deg(np.arctan(film["height"] / 2 / view.focal))
    target = view.eye - view.rotation[2]
    matrix = mi.ScalarTransform4f().look_at(view.eye.tolist(), target.tolist(), [0, 1, 0])
    return {"type": "perspective", "fov": float(angle), "to_world": matrix, "film": film}


def main(arguments: list[str] | None = None) -> int:
    """Draw the picture; return 2 for arguments that cannot be used."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("-o", "--output", type=Path, default=TARGET)
    parser.add_argument("--lightstage", type=Path, default=Path("runs/figures"))
    parser.add_argument("--people", type=int, default=25)
    parser.add_argument("--texels", type=int, default=512)
    parser.add_argument("--size", type=int, default=240)
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--variant", default="scalar_spectral")
    options = parser.parse_args(arguments)
    return run(lambda: draw(options))


if __name__ == "__main__":
    sys.exit(main())
