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
from skinnet.appearance.mapsfile import load_maps
from skinnet.appearance.subjects import SkinTexture
from skinnet.autoencoder import F_BLOOD_MAX, F_MEL_MAX, SHADING_MAX, SkinMaps
from skinnet.capture import Capture
from skinnet.decoder import SkinDecoder
from skinnet.errors import InputError
from skinnet.render.camera import front
from skinnet.render.scene import Scene as Rays
from skinnet.render.visibility import geometry
from skinnet.shape.meshfile import read_mesh
from train.batch import Batch
from train.brush import column
from train.render import photographed, shaded
from train.scene import Scene, draw_conditions
from train.stream import StreamLoader
from train.synthetic import seen_samples

_SPLITS = {"train": 0, "val": 1, "test": 2}
MAPS = "_maps.npz"
TURN, TILT, FIELD = 25.0, 8.0, 24.0
"""Standard deviations of the camera's turn and tilt, and its angle of view, in degrees."""


class View(NamedTuple):
    """What a camera sees of one face, [size, size, ...]: where, facing where, how open to the sky.

    `uv` is as `grid_sample` counts it, `normal` in the camera's axes, `hit` the share of a pixel.
    """

    uv: NDArray[np.float32]
    normal: NDArray[np.float32]
    open: NDArray[np.float32]
    hit: NDArray[np.float32]


class FittedScenes(Dataset[Scene]):
    """Faces, cameras, lights and skins drawn from (seed, split, index)."""

    def __init__(self, faces: "FittedFaces", split: str, samples: int):
        self.faces, self.samples = faces, samples
        self.key = (faces.seed, _SPLITS[split])

    def __len__(self) -> int:
        return self.samples

    def __getitem__(self, index: int) -> Scene:
        draw = np.random.default_rng([*self.key, index])
        view = int(draw.integers(len(self.faces.views)))
        skin, mask = self.faces.skin(view // self.faces.shots, draw)
        seen = self.faces.views[view]
        scene = draw_conditions(draw, self.faces.size) | {"skin": skin, "known": mask[None]}
        wall = draw.uniform(0.02, 0.9) * np.exp(draw.normal(0, 0.1, 3))
        scene |= {**seen._asdict(), "wall": wall.clip(0.005, 1)}
        return {name: np.asarray(value, np.float32) for name, value in scene.items()}


class FittedFaces(LightningDataModule):
    """Scans fitted by `skinnet maps`, seen from many sides in many lights, with their true maps.

    Every face is rendered once from `shots` sides by ray casting; lights, cameras and exposure are
    drawn fresh on every step and rendered on the device that trains. Lamps cast no shadows; hollows
    are dimmed by the share of the sky that they see.

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
    def described(self) -> str:
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
        seen = partial(seen_samples, self.trainer, self.batch_size)
        return StreamLoader(FittedScenes(self, "train", samples), self.batch_size, samples, seen)

    def val_dataloader(self) -> DataLoader[Scene]:
        return DataLoader(FittedScenes(self, "val", self.samples["val"]), self.batch_size)

    def test_dataloader(self) -> DataLoader[Scene]:
        return DataLoader(FittedScenes(self, "test", self.samples["val"]), self.batch_size)

    def on_after_batch_transfer(self, batch: Any, dataloader_idx: int) -> Batch:
        scenes: dict[str, Tensor] = batch
        return render_fitted(scenes, self.decoder.to(scenes["uv"].device))


def shrunk(texture: SkinTexture, texels: int) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
    """Means of the known texels [5, n, n] (blood, melanin, offset) and their share [n, n]."""
    known = torch.from_numpy(texture.mask)[None, None].float()
    features = torch.from_numpy(texture.features()).reshape(1, 5, *texture.mask.shape)
    share = F.adaptive_avg_pool2d(known, texels)
    mean = F.adaptive_avg_pool2d(features, texels) / share.clamp_min(1e-6)
    return mean[0].numpy(), share[0, 0].numpy()


def shots(mesh: Path, count: int, size: int, draw: np.random.Generator) -> list[View]:
    """A textured face from some sides, the first from ahead."""
    rays = Rays(read_mesh(mesh))
    angles = draw.normal(0, (TURN, TILT), (count, 2)).clip((-60, -20), (60, 20))
    angles[0] = 0
    return [_shot(rays, size, *one) for one in angles]


def _shot(rays: Rays, size: int, turn: float, tilt: float) -> View:
    view = front(rays.mesh.vertices, (size, size), float(turn), float(tilt), FIELD)
    seen = geometry(rays, view)
    assert seen.uv is not None  # NAME_face.obj has texture coordinates
    outward = seen.side[:, 0] > 0
    planes = np.zeros((size, size, 7), np.float32)
    place = np.column_stack([2 * seen.uv[:, 0] - 1, 1 - 2 * seen.uv[:, 1]])
    normal = seen.normal @ view.rotation.T
    planes[seen.hit] = np.column_stack([place, normal, seen.openness(), outward])
    return View(planes[..., :2], planes[..., 2:5], planes[..., 5], planes[..., 6])


@torch.no_grad()
def render_fitted(scene: dict[str, Tensor], decoder: SkinDecoder) -> Batch:
    """Photographs of a batch of drawn scenes with their truth, as `train.render.render` gives."""
    over = F.grid_sample(
        torch.cat([scene["skin"], scene["known"]], 1), scene["uv"], align_corners=False
    )
    blood, melanin, offset, known = over.split([1, 1, 3, 1], 1)
    hit = scene["hit"][:, None]
    share = hit * (known > 0.5)
    normal = scene["normal"].movedim(-1, 1)
    oil = torch.full_like(share, 0.5)
    shading, specular = shaded(scene, normal, oil, scene["open"][:, None])
    # Eyes and mouth are holes or unknown; the wall is lit evenly.
    other = column(scene["wall_light"]) * scene["wall"][:, :, None, None] * (1 - hit)
    other = other + hit * 0.05 * shading
    truth = SkinMaps(
        melanin[:, 0].clamp(0, F_MEL_MAX),
        blood[:, 0].clamp(0, F_BLOOD_MAX),
        (share * shading)[:, 0].clamp_max(SHADING_MAX),
        (share * specular)[:, 0].clamp_max(1),
        (share * shading * offset + (1 - share) * other).clamp(-1, 1),
        share[:, 0],
    )
    capture = Capture(*(scene[name] for name in Capture._fields))
    linear = decoder.compose(*truth[:5], capture)
    return Batch(photographed(scene, linear), truth.mask, truth, capture)
