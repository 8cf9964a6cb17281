"""Synthetic faces as training data: heads are cast once and rendered anew on every step."""

from functools import cached_property, partial
from pathlib import Path
from typing import Any

import numpy as np
from jsonargparse.typing import NonNegativeInt, PositiveInt
from lightning import LightningDataModule, Trainer
from torch.utils.data import DataLoader, Dataset, default_collate

from skinnet.physics import SkinDecoder
from train.batch import Batch
from train.preset import check_preset
from train.stream import StreamLoader, count_seen_samples
from train.synthetic.casts.head_cache import SPLITS, load_or_cast_heads
from train.synthetic.casts.head_cast import HeadCast
from train.synthetic.labels import BEARD, BODY, MATERIALS
from train.synthetic.painting.paintings import collate_scenes, stack
from train.synthetic.photography.renderer import render
from train.synthetic.sampling.body_sampling import sample_body
from train.synthetic.sampling.measured_skins import MeasuredSkins
from train.synthetic.sampling.model_skins import ModelSkins, apply_model_skin, load_model_skins
from train.synthetic.sampling.scene_sampling import Person, meter_skin, sample_person, sample_scene
from train.synthetic.sampling.style_sampling import fit_long_beard
from train.synthetic.scene import FaceParameters, HeadBuffers, SceneParameters, map_tensors
from train.synthetic.variety import Captures, Variety

STAGES = {"fit": ("train", "val"), "validate": ("val",), "test": ("test",)}
"""Splits whose heads a stage of training needs."""

COLLATE = {"mild": default_collate, "any": collate_scenes}
"""How a variety's scenes become a batch."""


class SyntheticScenes(Dataset[SceneParameters]):
    """Random scenes of given heads, sampled from (seed, split, index): the same on every machine.

    Scenes use the heads in turn. Each head is used equally often if the number of samples is a
    multiple of the number of heads.

    Args:
        heads: Buffers of all heads, stacked.
        split: Train, val or test.
        samples: Number of scenes.
        seed: Seed of the scenes.
        skins: Skins of a hybrid model, one of which half of the faces then have. All else in the
            scenes is the same with skins and without.
        domain_randomised: As in `sample_scene`; for training alone.
        measured: Blood and nuisance of measured skins; None: blood is uniform in its logarithm, and
            all skins are those of the preset.
        variety: Which kind of faces; the heads must be of the same.
        captures: Which kind of lights and cameras.
    """

    def __init__(
        self,
        heads: HeadBuffers,
        split: str,
        samples: int,
        seed: int,
        skins: ModelSkins | None = None,
        domain_randomised: bool = False,
        measured: MeasuredSkins | None = None,
        variety: Variety = "mild",
        captures: Captures = "mild",
    ) -> None:
        self.variety, self.captures = variety, captures
        self.heads, self.samples, self.skins = heads, samples, skins
        self.measured = measured
        self.domain_randomised = domain_randomised
        self.key = (seed, SPLITS[split], 7)

    def __len__(self) -> int:
        return self.samples

    def __getitem__(self, index: int) -> SceneParameters:
        number = index % len(self.heads.label)
        head = map_tensors(lambda values: values[number], self.heads)
        key = [*self.key, index]
        rng = np.random.default_rng(key)
        scene = sample_scene(rng, head, self.domain_randomised, self.variety, self.captures)
        scene = scene._replace(face=self._measure(scene.face, key))
        return scene if self.variety == "mild" else self._add_paintings(scene, key)

    def _measure(self, face: FaceParameters, key: list[int]) -> FaceParameters:
        """Give a face a measured skin and the skin of a model, if there are such."""
        if self.measured is not None:
            face = self.measured.apply(face, np.random.default_rng([*key, 2]))
        if self.skins is not None:
            face = apply_model_skin(face, np.random.default_rng([*key, 1]), self.skins)
        return face

    def _add_paintings(self, scene: SceneParameters, key: list[int]) -> SceneParameters:
        """Stack the faces and surroundings of all paintings that the picture shows."""
        numbers = np.unique(scene.head.label.numpy() // MATERIALS).tolist()
        people = {0: (scene.face, scene.surroundings)}
        for person in {one % BODY for one in numbers} - {0}:
            people[person] = self._sample_person([*key, 4, person])
        for person, (face, clothes) in people.items():
            if bool((scene.head.label == BEARD + MATERIALS * person).any()):
                people[person] = fit_long_beard(face), clothes
        faces, surroundings = zip(*(people[one % BODY] for one in numbers), strict=True)
        skins = [
            sample_body(np.random.default_rng([*key, 3, one]), face) if one >= BODY else face
            for one, face in zip(numbers, faces, strict=True)
        ]
        camera = meter_skin(scene.camera, scene.head)
        return scene._replace(face=stack(skins), surroundings=stack(surroundings), camera=camera)

    def _sample_person(self, key: list[int]) -> Person:
        face, surroundings = sample_person(
            np.random.default_rng(key), self.domain_randomised, self.variety
        )
        return self._measure(face, key), surroundings


class SyntheticFaces(LightningDataModule):
    """Synthetic faces with all ground truth under varied skin, light, camera and exposure.

    Geometry is ray-cast once and kept on disk. All else is sampled anew on every step and rendered
    on the device that trains. Training never repeats a picture, and its skin is
    domain-randomised: it may be darker and oilier than that of the other splits. Validation and
    test have heads of their own, test has cameras of its own, and both are the same in every run.

    Args:
        size: Side of the square pictures in pixels.
        batch_size: Pictures in a batch of each process.
        heads: Heads of the training set.
        val_heads: Heads of the validation set.
        test_heads: Heads of the test set.
        train_samples: Pictures in an epoch of training.
        val_samples: Pictures of the validation set.
        test_samples: Pictures of the test set.
        ict: ICT-FaceKit's model as an .npz; without it all heads are procedural.
        geometry: Folder in which the heads are kept.
        skins: .npz of `python -m train.synthetic.skins` or `examples/london.py`: skins sampled from
            a hybrid model, one of which half of the faces then have. Without it all skins are
            painted.
        optics: Preset of the skin's optical constants, which must be that of the model. With
            `measured`, each face has the blood and the nuisance of a skin of `SkinPrior`.
        seed: Seed of everything that is sampled.
        workers: Processes that cast heads and sample scenes; 0 does both in the training process.
        variety: `mild` for one nearly upright face a picture, or `any` for faces and skin as people
            photograph them.
        captures: `mild` for careful cameras in white light, or `wide` for the lights, cameras and
            processing of photographs by anybody.
        portrait_heads: Heads of `mild` geometry, upright and framed as portraits, in the training
            set besides `heads` of the variety `any`.
    """

    def __init__(
        self,
        size: PositiveInt = 160,
        batch_size: PositiveInt = 32,
        heads: PositiveInt = 800,
        val_heads: PositiveInt = 64,
        test_heads: PositiveInt = 128,
        train_samples: PositiveInt = 6400,
        val_samples: PositiveInt = 128,
        test_samples: PositiveInt = 512,
        ict: str | None = None,
        geometry: str = "runs/geometry",
        skins: str | None = None,
        optics: str = "measured",
        seed: NonNegativeInt = 0,
        workers: NonNegativeInt = 0,
        variety: Variety = "mild",
        captures: Captures = "mild",
        portrait_heads: NonNegativeInt = 0,
    ) -> None:
        super().__init__()
        self.size, self.batch_size = size, batch_size
        self.heads = {"train": heads, "val": val_heads, "test": test_heads}
        self.samples = {"train": train_samples, "val": val_samples, "test": test_samples}
        self.ict = None if ict is None else Path(ict)
        self.geometry, self.seed, self.workers = Path(geometry), seed, workers
        self.variety: Variety = variety
        self.captures: Captures = captures
        self.portrait_heads = portrait_heads
        self.skins_file = None if skins is None else Path(skins)
        self.skins: ModelSkins | None = None
        self.optics = optics
        self.buffers: dict[str, HeadBuffers] = {}

    @cached_property
    def decoder(self) -> SkinDecoder:
        """The colours of skin, of the preset."""
        # Not in the constructor, whose errors the parser replaces with its own.
        return SkinDecoder(self.optics)

    @cached_property
    def measured(self) -> MeasuredSkins | None:
        """Blood and nuisance of faces; None for presets that have no prior."""
        return MeasuredSkins() if self.optics == "measured" else None

    @property
    def description(self) -> str:
        """Return one line on these data for the files of a model."""
        kind = "procedural heads" if self.ict is None else "ICT-FaceKit and procedural heads"
        if self.variety != "mild":
            kind = f"scenes of {kind} of the variety {self.variety}"
        if self.portrait_heads:
            kind = f"{kind} and {self.portrait_heads} portraits"
        if self.captures != "mild":
            kind = f"{kind} in {self.captures} captures"
        heads = f"{self.heads['train']} {kind} of skinnet's synthetic renderer"
        text = f"{heads}, seed {self.seed}, {self.size} px"
        return text if self.skins_file is None else f"{text}, half with skins of {self.skins_file}"

    def prepare_data(self) -> None:
        """Cast the heads that are missing, in one process of each machine."""
        assert self.trainer is not None and self.trainer.state.fn is not None
        for split in STAGES[self.trainer.state.fn.value]:
            self._load_heads(split)

    def setup(self, stage: str) -> None:
        """Load the heads that a stage needs, or cast them: fit, validate or test.

        Raises:
            InputError: For skins that cannot be read, or a model with another preset.
        """
        check_preset(self.trainer, self.optics, "Synthetic faces")
        if self.skins is None and self.skins_file is not None:
            self.skins = load_model_skins(self.skins_file)
        for split in STAGES[stage]:
            if split not in self.buffers:
                self.buffers[split] = self._load_heads(split).to_buffers()

    def _load_heads(self, split: str) -> HeadCast:
        own = self._load_or_cast(split, self.heads[split], self.variety)
        if split != "train" or not self.portrait_heads:
            return own
        portraits = self._load_or_cast(split, self.portrait_heads, "mild")
        # Heads are used in turn, and every batch should have both kinds.
        order = np.random.default_rng(self.seed).permutation(len(own.label) + len(portraits.label))
        return HeadCast(*(np.concatenate(pair)[order] for pair in zip(own, portraits, strict=True)))

    def _load_or_cast(self, split: str, count: int, variety: Variety) -> HeadCast:
        return load_or_cast_heads(
            *(self.geometry, self.size, count, split, self.seed, self.ict),
            workers=max(self.workers, 1),
            variety=variety,
        )

    def train_dataloader(self) -> StreamLoader:
        """Load the training scenes of an epoch."""
        return self.stream(self.samples["train"] // self.batch_size, self.trainer)

    def stream(self, steps: int, trainer: Trainer | None) -> StreamLoader:
        """Load training scenes in epochs of that many steps, from the step of the trainer on."""
        samples = max(steps, 1) * self.batch_size
        scenes = SyntheticScenes(
            self.buffers["train"],
            "train",
            samples,
            self.seed,
            self.skins,
            True,
            self.measured,
            self.variety,
            self.captures,
        )
        seen = partial(count_seen_samples, trainer, self.batch_size)
        return StreamLoader(
            scenes, self.batch_size, samples, seen, self.workers, COLLATE[self.variety]
        )

    def val_dataloader(self) -> DataLoader[SceneParameters]:
        """Load the validation scenes."""
        return self._load_fixed("val")

    def test_dataloader(self) -> DataLoader[SceneParameters]:
        """Load the test scenes."""
        return self._load_fixed("test")

    def on_after_batch_transfer(self, batch: Any, dataloader_idx: int) -> Batch:
        """Render a batch of scenes on the device that it was sent to."""
        testing = self.trainer is not None and self.trainer.testing
        return self.render(batch, "test" if testing else "train")

    def render(self, scene: SceneParameters, split: str) -> Batch:
        """Render a batch of scenes with the cameras of a split."""
        return render(scene, self.decoder.to(scene.light.sky.device), split)

    def _load_fixed(self, split: str) -> DataLoader[SceneParameters]:
        scenes = SyntheticScenes(
            self.buffers[split],
            split,
            self.samples[split],
            self.seed,
            self.skins,
            measured=self.measured,
            variety=self.variety,
            captures=self.captures,
        )
        return DataLoader(
            scenes, self.batch_size, num_workers=self.workers, collate_fn=COLLATE[self.variety]
        )
