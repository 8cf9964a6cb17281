"""Paintings: a picture may show several people and their hands, each with parameters of its own."""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import torch
from jaxtyping import Float, Int64, UInt8
from torch import Tensor
from torch.utils.data import default_collate

from train.synthetic.labels import BODY, MATERIALS
from train.synthetic.scene import Record, SceneParameters

_MOST = 2 * BODY


class Paintings(NamedTuple):
    """The paintings of a batch of pictures, ordered by picture and number.

    `picture` and `number` belong to each painting. `owner` is the painting of each pixel.
    """

    picture: Int64[Tensor, "paintings"]
    number: Int64[Tensor, "paintings"]
    owner: Int64[Tensor, "batch height width"]

    @property
    def single(self) -> bool:
        """Whether each picture has one painting, as all mild ones have."""
        return len(self.picture) == len(self.owner)

    @property
    def first(self) -> Int64[Tensor, "batch"]:
        """The first painting of each picture."""
        return torch.searchsorted(self.picture, torch.arange(len(self.owner)).to(self.picture))


def find_paintings(label: UInt8[Tensor, "batch height width"]) -> Paintings:
    """Find the paintings that are seen in a batch of pictures.

    Args:
        label: Labels with numbers of paintings, as in `train.synthetic.labels`.

    Returns:
        The paintings.

    Example:
        >>> label = torch.tensor([[[1, 33]], [[0, 1]]], dtype=torch.uint8)
        >>> find_paintings(label).picture
        tensor([0, 0, 1])
    """
    code = (label // MATERIALS).long()
    seen = torch.zeros(len(label), _MOST, dtype=torch.bool, device=label.device)
    seen.scatter_(1, code.flatten(1), torch.ones_like(code.flatten(1), dtype=torch.bool))
    row = (seen.flatten().cumsum(0) - 1).reshape(seen.shape)
    owner = row.gather(1, code.flatten(1)).reshape(label.shape)
    picture, number = seen.nonzero().T
    return Paintings(picture, number, owner)


def merge_paintings(
    paintings: Paintings, values: Float[Tensor, "paintings channels height width"]
) -> Float[Tensor, "batch channels height width"]:
    """Take the value of each pixel from its own painting.

    Args:
        paintings: The paintings of a batch of pictures.
        values: Values of every painting over its whole picture.

    Returns:
        Values of the pictures.
    """
    first = paintings.first
    merged = values[first]
    rank = torch.arange(len(values), device=values.device) - first[paintings.picture]
    for number in range(1, int(rank.max()) + 1):
        rows = (rank == number).nonzero()[:, 0]
        pictures = paintings.picture[rows]
        own = (paintings.owner[pictures] == rows[:, None, None])[:, None]
        merged[pictures] = torch.where(own, values[rows], merged[pictures])
    return merged


def collate_scenes(scenes: list[SceneParameters]) -> SceneParameters:
    """Make a batch of scenes whose faces and surroundings have an axis of paintings.

    Args:
        scenes: Scenes of the variety `any`.

    Returns:
        A batch, in which the paintings of all pictures follow one another.
    """
    head, face, surroundings, light, camera = zip(*scenes, strict=True)
    return SceneParameters(
        default_collate(list(head)),
        _combine(torch.cat, face),
        _combine(torch.cat, surroundings),
        default_collate(list(light)),
        default_collate(list(camera)),
    )


def stack(records: Sequence[Record]) -> Record:
    """Stack the tensors of records, and of the records in them, along a new first axis."""
    return _combine(torch.stack, records)


def _combine(combine: Callable[[list[Tensor]], Tensor], records: Sequence[Record]) -> Record:
    return records[0]._make(
        combine(list(parts)) if isinstance(parts[0], Tensor) else _combine(combine, parts)
        for parts in zip(*records, strict=True)
    )
