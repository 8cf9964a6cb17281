"""Faces fitted to scans, with skin of their own or of a hybrid model, as training data."""

from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
import torch.nn.functional as F
from jsonargparse.typing import NonNegativeInt, PositiveInt
from lightning import LightningDataModule
from numpy.typing import NDArray
from torch import Tensor
from torch.utils.data import DataLoader, Dataset

from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.maps_file import load_maps
from skinnet.appearance.skin_texture import SkinTexture
from skinnet.errors import InputError
from skinnet.mesh import read_mesh
from skinnet.network.autoencoder import F_BLOOD_MAX, F_MEL_MAX
from skinnet.physics import SkinDecoder
from skinnet.render import Scene, frame_face, trace_geometry
from train.batch import Batch
from train.stream import StreamLoader, count_seen_samples
from train.synthetic.faces import Drawn
from train.synthetic.head_cache import SPLITS
from train.synthetic.head_cast import facing
from train.synthetic.renderer import Skin, developed, normals, openness
from train.synthetic.scene_sampling import draw_camera, draw_gloss, draw_light
from train.synthetic.shading import shade
from train.synthetic.simulated_camera import pictured

MAPS = "_maps.npz"
TURN, TILT, FIELD = 25.0, 8.0, 24.0
"""Standard deviations of the camera's turn and tilt, and its angle of view, in degrees."""

OIL = 1.0
"""Oil on a face, even all over it, relative to the twin's."""


class View(NamedTuple):
    """What a camera sees of one face, [size, size, ...]: `hit` is 1 where there is any of it, `uv`
    as `grid_sample` counts it, and the rest as in `train.synthetic.head_cast.Buffers`."""

    hit: NDArray[np.float32]
    uv: NDArray[np.float32]
    normal: NDArray[np.int8]
    openness: NDArray[np.uint8]
    seen: NDArray[np.int64]


class FittedLots(Dataset[Drawn]):
    """Faces, cameras, lights and skins drawn from (seed, split, index)."""

    def __init__(self, faces: "FittedFaces", split: str, samples: int):
        self.faces, self.samples = faces, samples
        self.key = (faces.seed, SPLITS[split])

    def __len__(self) -> int:
        return self.samples

    def __getitem__(self, index: int) -> Drawn:
        draw = np.random.default_rng([*self.key, index])
        view = int(draw.integers(len(self.faces.views)))
        skin, mask = self.faces.skin(view // self.faces.shots, draw)
        wall = draw.uniform(0.02, 0.9) * np.exp(draw.normal(0, 0.1, 3))
        lot: dict[str, object] = {"skin": skin, "known": mask[None], "wall": wall.clip(0.005, 1)}
        lot |= draw_gloss(draw) | draw_light(draw) | draw_camera(draw, self.faces.size)
        drawn = {name: np.asarray(value, np.float32) for name, value in lot.items()}
        return self.faces.views[view]._asdict() | drawn


class FittedFaces(LightningDataModule):
    """Scans fitted by `skinnet maps`, seen from many sides in many lights, with their true maps.

    Every face is ray-cast once from `shots` sides; lights, cameras and exposure are those of
    `SyntheticFaces`, drawn afresh on every step and rendered on the device that trains. Faces throw
    shadows on themselves, and hollows see less of the sky.

    Args:
        folder: of NAME_maps.npz with NAME_face.obj, as `skinnet maps` writes them.
        model: hybrid.npz of `skinnet build-model` in the same texture space; half of the faces then
            wear a skin drawn from it.
        size: side of the square pictures in pixels.
        texels: side of the skin textures that pictures are made of.
        batch_size: pictures in a batch of each process.
        shots: sides from which each face is seen.
        train_samples: pictures that are called an epoch.
        val_samples: pictures of the validation set.
        seed: of all that is drawn.
    """

    def __init__(
        self,
        folder: str,
        model: str | None = None,
        size: PositiveInt = 128,
        texels: PositiveInt = 256,
        batch_size: PositiveInt = 32,
        shots: PositiveInt = 16,
        train_samples: PositiveInt = 6400,
        val_samples: PositiveInt = 128,
        seed: NonNegativeInt = 0,
    ):
        super().__init__()
        self.folder, self.model_file = Path(folder), None if model is None else Path(model)
        self.size, self.texels, self.batch_size, self.shots = size, texels, batch_size, shots
        self.samples = {"train": train_samples, "val": val_samples}
        self.seed = seed
        self.decoder = SkinDecoder()
        self.model: HybridModel | None = None
        self.skins: list[tuple[NDArray[np.float32], NDArray[np.float32]]] = []
        self.views: list[View] = []

    @property
    def description(self) -> str:
        """What a model card says of these data."""
        own = f"{len(self.skins)} fitted scans, seed {self.seed}, {self.size} px"
        return own if self.model is None else f"{own}, half with skin of {self.model_file}"

    def setup(self, stage: str) -> None:
        if self.views:
            return
        files = sorted(self.folder.glob(f"*{MAPS}"))
        pairs = [
            (file, file.with_name(file.name.removesuffix(MAPS) + "_face.obj")) for file in files
        ]
        pairs = [(maps, mesh) for maps, mesh in pairs if mesh.is_file()]
        if not pairs:
            raise InputError(
                f"{self.folder} holds no NAME{MAPS} with NAME_face.obj; make them with skinnet "
                "maps."
            )
        if self.model_file is not None:
            self.model = HybridModel.load(self.model_file)
        draw = np.random.default_rng([self.seed, 3])
        for maps, mesh in pairs:
            self.skins.append(shrunk(load_maps(maps)[0], self.texels))
            self.views += shots(mesh, self.shots, self.size, draw)

    def skin(
        self, face: int, draw: np.random.Generator
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Channels [5, n, n] of a face's skin and where they are known, its own or drawn."""
        if self.model is None or draw.random() < 0.5:
            return self.skins[face]
        deviations = np.sqrt(self.model.statistics.variances)
        return shrunk(
            self.model.texture(deviations * draw.normal(size=len(deviations))), self.texels
        )

    def train_dataloader(self) -> StreamLoader:
        samples = self.samples["train"]
        seen = partial(count_seen_samples, self.trainer, self.batch_size)
        return StreamLoader(FittedLots(self, "train", samples), self.batch_size, samples, seen)

    def val_dataloader(self) -> DataLoader[Drawn]:
        return DataLoader(FittedLots(self, "val", self.samples["val"]), self.batch_size)

    def test_dataloader(self) -> DataLoader[Drawn]:
        return DataLoader(FittedLots(self, "test", self.samples["val"]), self.batch_size)

    def on_after_batch_transfer(self, batch: Any, dataloader_idx: int) -> Batch:
        lot: dict[str, Tensor] = batch
        testing = self.trainer is not None and self.trainer.testing
        decoder = self.decoder.to(lot["uv"].device)
        return render_fitted(lot, decoder, "test" if testing else "train")


def shrunk(texture: SkinTexture, texels: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Means of the known texels [5, n, n] (blood, melanin, offset) and their share [n, n]."""
    known = torch.from_numpy(texture.mask)[None, None].float()
    features = torch.from_numpy(texture.features()).reshape(1, 5, *texture.mask.shape)
    share = F.adaptive_avg_pool2d(known, texels)
    mean = F.adaptive_avg_pool2d(features, texels) / share.clamp_min(1e-6)
    return mean[0].numpy(), share[0, 0].numpy()


def shots(mesh: Path, count: int, size: int, draw: np.random.Generator) -> list[View]:
    """A textured face from some sides, the first from ahead."""
    scene = Scene(read_mesh(mesh))
    if scene.mesh.uv is None:
        raise InputError(f"{mesh} has no texture coordinates; `skinnet maps` writes such faces.")
    angles = draw.normal(0, (TURN, TILT), (count, 2)).clip((-60, -20), (60, 20))
    angles[0] = 0
    return [_shot(scene, size, *one) for one in angles]


def _shot(scene: Scene, size: int, turn: float, tilt: float) -> View:
    camera = frame_face(scene.mesh.vertices, (size, size), float(turn), float(tilt), FIELD)
    found = trace_geometry(scene, camera)
    assert found.uv is not None  # NAME_face.obj has texture coordinates
    view = View(
        np.zeros((size, size), np.float32),
        np.zeros((size, size, 2), np.float32),
        np.zeros((size, size, 3), np.int8),
        np.zeros((size, size), np.uint8),
        np.full((size, size), -1, np.int64),
    )
    at = found.hit
    view.hit[at] = found.side[:, 0] > 0
    view.uv[at] = np.column_stack([2 * found.uv[:, 0] - 1, 1 - 2 * found.uv[:, 1]])
    view.normal[at], view.openness[at], seen = facing(found, camera.rotation)
    view.seen[at] = seen.view(np.int64)
    return view


@torch.no_grad()
def render_fitted(lot: dict[str, Tensor], decoder: SkinDecoder, split: str = "train") -> Batch:
    """Photographs of a batch of lots with their truth, as `train.synthetic` gives."""
    over = F.grid_sample(torch.cat([lot["skin"], lot["known"]], 1), lot["uv"], align_corners=False)
    blood, melanin, offset, known = over.split([1, 1, 3, 1], 1)
    melanin, blood = melanin[:, 0].clamp(0, F_MEL_MAX), blood[:, 0].clamp(0, F_BLOOD_MAX)
    hit = lot["hit"][:, None]
    share = hit * (known > 0.5)
    lit = shade(lot, normals(lot), openness(lot), lot["seen"], torch.full_like(share, OIL))
    matrix, capture = pictured(lot, decoder.camera, split)
    white = matrix.sum(-2)[:, :, None, None]
    # Eyes and mouth are holes or unknown; the wall is lit evenly.
    other = white * (lot["wall"][:, :, None, None] * (1 - hit) + hit * 0.05 * lit.diffuse)
    skin = Skin(melanin, blood, decoder.albedo(melanin, blood, matrix), share, lit)
    rest = share * lit.diffuse * offset + (1 - share) * other
    return developed(lot, skin, rest, white, capture)
