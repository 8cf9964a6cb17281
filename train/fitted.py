"""Faces fitted to scans, with skin of their own or of a hybrid model, as training data."""

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import torch
from jsonargparse.typing import NonNegativeInt, PositiveInt
from lightning import LightningDataModule
from numpy.typing import NDArray
from torch.utils.data import DataLoader, Dataset

from skinnet.appearance.hybrid import HybridModel
from skinnet.appearance.maps_file import load_maps
from skinnet.errors import InputError
from skinnet.physics import SkinDecoder
from train.batch import Batch
from train.fitted_scenes import (
    FittedScene,
    FittedView,
    average_texels,
    cast_views,
    render_fitted,
)
from train.preset import check_preset
from train.stream import StreamLoader, count_seen_samples
from train.synthetic.casts.head_cache import SPLITS
from train.synthetic.sampling.face_sampling import sample_specular
from train.synthetic.sampling.scene_sampling import sample_camera, sample_light
from train.synthetic.scene import map_tensors

_MAPS = "_maps.npz"


class FittedScenes(Dataset[FittedScene]):
    """Random scenes of fitted faces, sampled from (seed, split, index).

    Args:
        faces: The faces, after their `setup`.
        split: Train, val or test.
        samples: Number of scenes.
    """

    def __init__(self, faces: "FittedFaces", split: str, samples: int) -> None:
        self.faces, self.samples = faces, samples
        self.key = (faces.seed, SPLITS[split])

    def __len__(self) -> int:
        return self.samples

    def __getitem__(self, index: int) -> FittedScene:
        rng = np.random.default_rng([*self.key, index])
        view = int(rng.integers(len(self.faces.views)))
        texture, known = self.faces.sample_texture(view // self.faces.shots, rng)
        wall = rng.uniform(0.02, 0.9) * np.exp(rng.normal(0, 0.1, 3))
        return FittedScene(
            self.faces.views[view],
            torch.from_numpy(texture),
            torch.from_numpy(known)[None],
            torch.from_numpy(wall.clip(0.005, 1)).float(),
            map_tensors(torch.Tensor.float, sample_specular(rng)),
            sample_light(rng),
            sample_camera(rng, self.faces.size),
        )


class FittedFaces(LightningDataModule):
    """Scans fitted by `skinnet maps`, rendered from many sides in many lights, with true maps.

    Every face is ray-cast once from `shots` sides. Lights, cameras and exposure are those of
    `SyntheticFaces`, sampled anew on every step and rendered on the device that trains. Faces cast
    shadows on themselves, and concave places receive less light from the sky.

    Args:
        folder: Folder of NAME_maps.npz with NAME_face.obj, as `skinnet maps` writes them.
        model: File hybrid.npz of `skinnet build-model` in the same texture space; half of the faces
            then have a skin sampled from it.
        size: Side of the square pictures in pixels.
        texels: Side of the skin textures that are rendered.
        batch_size: Pictures in a batch of each process.
        shots: Sides from which each face is seen.
        train_samples: Pictures in an epoch of training.
        val_samples: Pictures of the validation set.
        seed: Seed of all that is sampled.
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
    ) -> None:
        super().__init__()
        self.folder, self.model_file = Path(folder), None if model is None else Path(model)
        self.size, self.texels, self.batch_size, self.shots = size, texels, batch_size, shots
        self.samples = {"train": train_samples, "val": val_samples}
        self.seed = seed
        self.preset: str | None = None
        self.decoder: SkinDecoder | None = None
        self.model: HybridModel | None = None
        self.textures: list[tuple[NDArray[np.float32], NDArray[np.float32]]] = []
        self.views: list[FittedView] = []

    @property
    def description(self) -> str:
        """Return one line on these data for the files of a model."""
        text = f"{len(self.textures)} fitted scans, seed {self.seed}, {self.size} px"
        return text if self.model is None else f"{text}, half with skin of {self.model_file}"

    def setup(self, stage: str) -> None:
        """Read the faces and cast their views, for any stage.

        Raises:
            InputError: If the folder holds no maps with their face, or one cannot be read.
        """
        if self.views:
            return
        files = sorted(self.folder.glob(f"*{_MAPS}"))
        pairs = [
            (file, file.with_name(file.name.removesuffix(_MAPS) + "_face.obj")) for file in files
        ]
        pairs = [(maps, mesh) for maps, mesh in pairs if mesh.is_file()]
        if not pairs:
            raise InputError(
                f"{self.folder} holds no NAME{_MAPS} with NAME_face.obj; make them with skinnet "
                "maps."
            )
        if self.model_file is not None:
            self.model = HybridModel.load(self.model_file)
            self._use_preset(self.model.colour.optics, self.model_file)
        rng = np.random.default_rng([self.seed, 3])
        for maps, mesh in pairs:
            texture, colour = load_maps(maps)
            self._use_preset(colour.optics, maps)
            self.textures.append(average_texels(texture, self.texels))
            self.views += cast_views(mesh, self.shots, self.size, rng)

    def _use_preset(self, preset: str, file: Path) -> None:
        """Render with the preset that the maps were inverted with; all have the same."""
        check_preset(self.trainer, preset, str(file))
        if self.preset not in (None, preset):
            raise InputError(
                f"{file} was made with the preset {preset}, other files with {self.preset}; make "
                "all of them with one --colour.optics."
            )
        self.preset, self.decoder = preset, self.decoder or SkinDecoder(preset)

    def sample_texture(
        self, face: int, rng: np.random.Generator
    ) -> tuple[NDArray[np.float32], NDArray[np.float32]]:
        """Take a face's own skin texture, or one of the model for half of the faces.

        Args:
            face: Number of the face.
            rng: Random numbers.

        Returns:
            Texture and known share, as `average_texels` gives them.
        """
        if self.model is None or rng.random() < 0.5:
            return self.textures[face]
        deviations = np.sqrt(self.model.statistics.variances)
        beta = deviations * rng.normal(size=len(deviations))
        return average_texels(self.model.texture(beta), self.texels)

    def train_dataloader(self) -> StreamLoader:
        """Load the training scenes of an epoch."""
        samples = self.samples["train"]
        seen = partial(count_seen_samples, self.trainer, self.batch_size)
        return StreamLoader(FittedScenes(self, "train", samples), self.batch_size, samples, seen)

    def val_dataloader(self) -> DataLoader[FittedScene]:
        """Load the validation scenes."""
        return DataLoader(FittedScenes(self, "val", self.samples["val"]), self.batch_size)

    def test_dataloader(self) -> DataLoader[FittedScene]:
        """Load the test scenes, which have cameras of their own."""
        return DataLoader(FittedScenes(self, "test", self.samples["val"]), self.batch_size)

    def on_after_batch_transfer(self, batch: Any, dataloader_idx: int) -> Batch:
        """Render a batch of scenes on the device that it was sent to."""
        scene: FittedScene = batch
        testing = self.trainer is not None and self.trainer.testing
        assert self.decoder is not None  # setup has read the maps.
        decoder = self.decoder.to(scene.wall.device)
        return render_fitted(scene, decoder, "test" if testing else "train")
