"""Makes the .npz of ICT-FaceKit that the synthetic renderer reads, from a checkout of it.

    git clone https://github.com/ICT-VGL/ICT-FaceKit
    python -m tools.ict_facekit ICT-FaceKit -o ict_facekit.npz

The checkout is that of Li et al. 2020 (USC Institute for Creative Technologies, MIT licence). The
.npz holds its neutral head, 100 identities, 53 expressions, materials and landmarks.
"""

import argparse
import json
import sys
from itertools import pairwise
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float, Int

from skinnet.errors import InputError
from skinnet.files import write_atomically
from skinnet.mesh._obj import read_obj_positions

FOLDER, NEUTRAL, INDICES = "FaceXModel", "generic_neutral_mesh.obj", "vertex_indices.json"
FACE_VERTEX_COUNT = 9409
"""The first vertices are those of the face."""


class Triangles(NamedTuple):
    """Corners from 0 in vertices and in texture coordinates, and the name of each material."""

    vertices: Int[np.ndarray, "triangles 3"]
    coordinates: Int[np.ndarray, "triangles 3"]
    material: list[str]


def read_triangles(path: Path) -> Triangles:
    """Read the neutral head's polygons, each cut into triangles that share its first corner."""
    corners, materials, material = list[list[list[int]]](), list[str](), ""
    for line in path.read_text(encoding="utf-8").splitlines():
        word, *rest = line.split() or [""]
        if word == "usemtl":
            material = rest[0]
        elif word == "f":
            first, *others = ([int(one) - 1 for one in each.split("/")[:2]] for each in rest)
            corners += [[first, *pair] for pair in pairwise(others)]
            materials += [material] * (len(rest) - 2)
    vertices, coordinates = np.moveaxis(np.array(corners, np.int32), 2, 0)
    return Triangles(vertices, coordinates, materials)


def read_coordinates(path: Path) -> Float[np.ndarray, "coordinates 2"]:
    """Read the texture coordinates of the neutral head."""
    lines = path.read_text(encoding="utf-8").splitlines()
    return np.array([line.split()[1:3] for line in lines if line.startswith("vt ")], np.float32)


def read_arrays(checkout: Path) -> dict[str, np.ndarray]:
    """Read all arrays of a checkout.

    Args:
        checkout: The folder that `git clone` made, or its FaceXModel.

    Returns:
        The arrays by their names in the .npz; lengths are centimetres, as in the files.

    Raises:
        InputError: If a file is missing or does not fit the others.
    """
    folder = checkout / FOLDER if (checkout / FOLDER).is_dir() else checkout
    for name in (NEUTRAL, INDICES, "identity000.obj"):
        if not (folder / name).is_file():
            raise InputError(f"{folder} has no {name}; name a whole checkout of ICT-FaceKit.")
    listed = json.loads((folder / INDICES).read_text(encoding="utf-8"))
    neutral = read_obj_positions(folder / NEUTRAL).astype(np.float32)
    names = sorted(listed["expressions"])
    triangles = read_triangles(folder / NEUTRAL)
    materials = list(dict.fromkeys(triangles.material))
    identities = sorted(folder.glob("identity[0-9][0-9][0-9].obj"))
    return {
        "verts": neutral,
        "id_modes": _read_modes(identities, neutral),
        "expr_modes": _read_modes([folder / f"{name}.obj" for name in names], neutral),
        "expr_names": np.array(names),
        "tris": triangles.vertices,
        "tris_uv": triangles.coordinates,
        "tri_material": np.array([materials.index(one) for one in triangles.material], np.int16),
        "material_names": np.array(materials),
        "uv": read_coordinates(folder / NEUTRAL),
        "landmarks68": np.array(listed["idx_to_landmark_verts"], np.int32),
        "face_vertex_count": np.array(FACE_VERTEX_COUNT),
    }


def _read_modes(
    files: list[Path], neutral: Float[np.ndarray, "vertices 3"]
) -> Float[np.ndarray, "modes vertices 3"]:
    modes = np.empty((len(files), *neutral.shape), np.float32)
    for number, file in enumerate(files):
        positions = read_obj_positions(file)
        if positions.shape != neutral.shape:
            raise InputError(
                f"{file} has {len(positions):,} vertices, and {NEUTRAL} has {len(neutral):,}; the "
                "files are of different releases or cut short."
            )
        modes[number] = positions - neutral
    return modes


def main(arguments: list[str] | None = None) -> int:
    """Write the .npz; return 2 for a folder that cannot be used."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("checkout", type=Path, help="folder of ICT-FaceKit")
    parser.add_argument("-o", "--output", type=Path, default=Path("ict_facekit.npz"))
    options = parser.parse_args(arguments)
    try:
        if options.output.exists():
            raise InputError(f"{options.output} is there already; give another name with -o.")
        arrays: dict[str, Any] = read_arrays(options.checkout)
        with write_atomically(options.output) as part:
            with part.open("wb") as stream:
                np.savez_compressed(stream, **arrays)
    except (InputError, OSError) as error:
        print(error, file=sys.stderr)
        return 2
    print(f"written: {options.output}")
    return 0


if __name__ == "__main__":
    sys.exit(main())
