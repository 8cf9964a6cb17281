"""People in two photographs each, without any truth but that both show the same skin."""

from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from jsonargparse.typing import NonNegativeInt, PositiveInt
from torch import Tensor
from torch.utils.data import DataLoader, Dataset

from skinnet.errors import InputError
from train.batch import Batch, People
from train.beside_synthetic import BesideSynthetic
from train.pair_split import choose_kept
from train.people import Couple, PersonCrop, read_couples, read_index
from train.rephotography import Rephotography, reframe, rephotograph, sample_rephotography
from train.synthetic.faces import SyntheticFaces

_EDITED_SHARE, _MOST_LOG_FACTOR = 0.5, float(np.log(2))
"""Share of the photographs whose pigments are multiplied, by .5 to 2."""


class Shot(NamedTuple):
    """A photograph of a person as tensors, and how it is changed before it is seen."""

    photograph: Tensor
    mask: Tensor
    regions: Tensor
    colour: Tensor
    change: Rephotography
    factors: Tensor


class PeopleStream(Dataset[tuple[Shot, Shot]]):
    """An endless stream of people in two photographs.

    Every epoch has all people. Order, mirroring and changes depend on the seed and the number of
    the epoch.
    """

    def __init__(self, couples: list[Couple], seed: int) -> None:
        self.couples, self.seed = couples, seed

    def __len__(self) -> int:
        return len(self.couples)

    def __getitem__(self, index: int) -> tuple[Shot, Shot]:
        epoch, place = divmod(index, len(self.couples))
        order = np.random.default_rng([self.seed, epoch]).permutation(len(self.couples))
        rng = np.random.default_rng([self.seed, epoch, place])
        first, second = (_make_shot(one, rng) for one in self.couples[order[place]])
        return first, second


def _make_shot(crop: PersonCrop, rng: np.random.Generator) -> Shot:
    step = rng.choice([1, -1])
    photograph, mask, regions = (
        torch.from_numpy(np.ascontiguousarray(layer[:, ::step])) for layer in crop[:3]
    )
    colour = torch.from_numpy(crop.colour)
    change = sample_rephotography(rng)
    return Shot(photograph, mask, regions, colour, change, _sample_factors(rng))


def _sample_factors(rng: np.random.Generator) -> Tensor:
    """Sample log factors on both pigments; half of the photographs stay."""
    log = rng.uniform(-_MOST_LOG_FACTOR, _MOST_LOG_FACTOR, 2) * (rng.random() < _EDITED_SHARE)
    return torch.from_numpy(log).float()


class PortraitPairs(BesideSynthetic):
    """People in two photographs each by different photographers, beside synthetic faces.

    A person has the same skin in both. So the pigments that are read should agree, and what is read
    in one photograph should predict the colour of the other. Photographs are changed at random
    before they are seen, as if by yet other photographers. Every step also sees a batch of
    `synthetic` faces, whose pigments are known.

    Args:
        folder: Holds the photographs and `index.csv`, whose columns `person`, `first` and `second`
            name a person and the files of two photographs.
        size: Side of the square crops in pixels.
        batch_size: People in a batch of each process.
        kept: People that are kept for validation and testing, chosen by a hash of their names.
        seed: Seed of the order and of the changes.
        synthetic: Synthetic faces of the same size, to train on beside the photographs.
    """

    def __init__(
        self,
        folder: str,
        size: PositiveInt = 160,
        batch_size: PositiveInt = 10,
        kept: PositiveInt = 100,
        seed: NonNegativeInt = 0,
        synthetic: SyntheticFaces | None = None,
    ) -> None:
        super().__init__()
        self.folder = Path(folder)
        self.size, self.batch_size, self.kept, self.seed = size, batch_size, kept, seed
        self.synthetic = synthetic or SyntheticFaces(size=size)
        self.couples: dict[str, list[Couple]] = {}

    @property
    def description(self) -> str:
        """Return one line on these data for the files of a model."""
        count = len(self.couples["train"])
        return f"{count} people in two photographs each and {self.synthetic.description}"

    def has_read(self) -> bool:
        """Whether the people were read."""
        return bool(self.couples)

    def read(self) -> None:
        """Read the photographs of all people."""
        people = [row["person"] for row in read_index(self.folder)]
        if len(set(people)) <= self.kept:
            raise InputError(
                f"{self.folder} shows {len(set(people))} people and {self.kept} are kept for "
                "testing; give --data.init_args.kept a smaller number."
            )
        kept = choose_kept(people, self.kept)
        couples = read_couples(self.folder, self.size)
        self.couples = {
            "train": [couple for person, couple in couples.items() if person not in kept],
            "val": [couple for person, couple in couples.items() if person in kept],
        }
        for split, some in self.couples.items():
            if not some:
                what = "kept for testing" if split == "val" else "trained on"
                raise InputError(
                    f"{self.folder} shows nobody in two usable photographs of the people that are "
                    f"{what}; give more people, or another number --data.init_args.kept."
                )

    def stream(self) -> PeopleStream:
        """Stream the people of training."""
        return PeopleStream(self.couples["train"], self.seed)

    def keep(self) -> DataLoader[tuple[Shot, Shot]]:
        """Load the people who are kept."""
        return DataLoader(PeopleStream(self.couples["val"], self.seed), self.batch_size)

    def make_batch(self, photographs: Any) -> Batch:
        """Change photographs, in training, and make a batch of them."""
        shots = [self._change(shot) for shot in photographs]
        images, masks, *known = (torch.cat(parts) for parts in zip(*shots, strict=True))
        return Batch(images, masks, people=People(*known))

    def _change(self, shot: Shot) -> tuple[Tensor, ...]:
        photograph = shot.photograph.float().movedim(-1, 1) / 255
        mask, regions = shot.mask[:, None].float() / 255, shot.regions[:, None].float()
        if self.trainer is not None and self.trainer.training:
            photograph, mask = (reframe(shot.change, one) for one in (photograph, mask))
            regions = reframe(shot.change, regions, nearest=True)
            photograph = rephotograph(shot.change, photograph)
            factors = shot.factors
        else:
            factors = torch.zeros_like(shot.factors)
        return photograph, mask[:, 0], regions[:, 0].long(), shot.colour, factors
