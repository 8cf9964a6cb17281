"""Training steps: by appearance always, by maps where there is truth."""

import math
from dataclasses import dataclass
from typing import Any

import torch
from jsonargparse.typing import NonNegativeFloat, NonNegativeInt, PositiveFloat, PositiveInt
from kornia.color import rgb_to_linear_rgb
from lightning import LightningModule
from torch import Tensor
from torch.optim import AdamW, Optimizer
from torch.optim.lr_scheduler import LambdaLR

from skinnet.errors import InputError
from skinnet.network import losses
from skinnet.network.autoencoder import AutoencoderConfig, Reading, SkinAutoencoder, SkinMaps
from skinnet.network.checkpoint import describe
from skinnet.network.encoder import WIDTHS
from skinnet.network._weights import read_weights
from skinnet.physics import Capture
from train.batch import Batch
from train.metrics import measure

Batches = Batch | dict[str, Batch]
"""One kind of data, or several that each step sees together."""


@dataclass
class LossWeights:
    """Weight of each loss. The first three count on every picture; mask, overlap, pigments,
    fractions, leak, lighting and white balance where there is truth; a guessed mask, steadiness and
    the priors, which stand in for it, where there is none."""

    appearance: NonNegativeFloat = 4.0
    elsewhere: NonNegativeFloat = 0.2
    stray: NonNegativeFloat = 2.0
    mask: NonNegativeFloat = 2.0
    overlap: NonNegativeFloat = 1.0
    camera: NonNegativeFloat = 0.005
    specular: NonNegativeFloat = 0.01
    smoothness: NonNegativeFloat = 0.02
    shading: NonNegativeFloat = 0.02
    pigments: NonNegativeFloat = 8.0
    fractions: NonNegativeFloat = 1.0
    leak: NonNegativeFloat = 3.0
    lighting: NonNegativeFloat = 1.0
    white_balance: NonNegativeFloat = 2.0
    steadiness: NonNegativeFloat = 3.0
    mask_guess: NonNegativeFloat = 0.05


class SkinTask(LightningModule):
    """Trains a `SkinAutoencoder`.

    Args:
        optics: preset of the skin's optical constants.
        widths: channels of the encoder at each level.
        working_size: longer side in pixels of the crops that the model is to be used on.
        losses: weight of each loss.
        learning_rate: largest learning rate of AdamW, reached after the warm-up.
        weight_decay: of AdamW.
        warmup_steps: steps in which the learning rate rises; it falls as a cosine to zero after.
        weights: a .safetensors file to start from (fine-tuning). To go on with a run, use
            --ckpt_path instead.
    """

    def __init__(
        self,
        optics: str = "calibrated",
        widths: list[PositiveInt] = list(WIDTHS),  # noqa: B006 - read, never written
        working_size: PositiveInt = 128,
        losses: LossWeights = LossWeights(),  # noqa: B008 - read, never written
        learning_rate: PositiveFloat = 2e-3,
        weight_decay: NonNegativeFloat = 1e-4,
        warmup_steps: NonNegativeInt = 50,
        weights: str | None = None,
    ):
        super().__init__()
        model = SkinAutoencoder(
            AutoencoderConfig(optics, tuple(map(int, widths)), int(working_size))
        )
        # A third faster on a CPU.
        self.model = model.to(memory_format=torch.channels_last)
        self.weight_of = losses
        # Plain numbers: restricted ones end in the optimizer's state, which weights_only refuses.
        self.learning_rate = float(learning_rate)
        self.weight_decay = float(weight_decay)
        self.warmup_steps = int(warmup_steps)
        self.trained_on = "" if weights is None else f"{self._start_from(weights)}; then "

    def _start_from(self, path: str) -> str:
        metadata, state = read_weights(path)
        try:
            self.model.load_state_dict(state)
        except RuntimeError as error:
            raise InputError(
                f"{path} holds weights of another shape than this configuration's; give the widths "
                "that it was trained with."
            ) from error
        return metadata["skinnet.trained_on"]

    def forward(self, photograph: Tensor) -> Reading:
        """Read photographs; the trunk runs in the trainer's precision, the physics in float32."""
        photograph = photograph.contiguous(memory_format=torch.channels_last)
        maps, capture = self.model.encode(photograph)
        with torch.autocast(photograph.device.type, enabled=False):
            return Reading(maps, capture, self.model.decode(maps, capture))

    def training_step(self, batch: Batches, batch_idx: int) -> Tensor:
        _, total, parts = self._losses(batch)
        size = _size(batch)
        named = {f"train/{name}": value for name, value in parts.items()}
        self.log_dict(named, batch_size=size, sync_dist=True)
        self.log("train/loss", total, prog_bar=True, batch_size=size, sync_dist=True)
        return total

    def validation_step(self, batch: Batches, batch_idx: int) -> dict[str, Reading]:
        return self._evaluate(batch, "val")

    def test_step(self, batch: Batches, batch_idx: int) -> dict[str, Reading]:
        return self._evaluate(batch, "test")

    def _evaluate(self, batch: Batches, split: str) -> dict[str, Reading]:
        readings, total, _ = self._losses(batch)
        self.log(f"{split}/loss", total, batch_size=_size(batch), sync_dist=True)
        for name, part in by_name(batch).items():
            found = measure(readings[name], part)
            named = {f"{split}/{name}_{metric}": value for metric, value in found.items()}
            self.log_dict(named, batch_size=len(part.photograph), sync_dist=True)
        return readings

    def _losses(self, batch: Batches) -> tuple[dict[str, Reading], Tensor, dict[str, Tensor]]:
        named, parts = by_name(batch), {}
        total = torch.zeros((), device=self.device)
        readings = self._read(named)
        for name, part in named.items():
            with torch.autocast(part.photograph.device.type, enabled=False):
                for term, value in terms(readings[name], part).items():
                    parts[f"{name}_{term}"] = value
                    total = total + getattr(self.weight_of, term) * value
        return readings, total, parts

    def _read(self, batches: dict[str, Batch]) -> dict[str, Reading]:
        """All kinds of pictures in one pass: batch normalisation would otherwise give each kind its
        own statistics in training, and one mixture of them to both afterwards."""
        counts = [len(part.photograph) for part in batches.values()]
        whole = self(torch.cat([part.photograph for part in batches.values()]))
        maps, capture = (
            zip(*(one.split(counts) for one in some), strict=True) for some in whole[:2]
        )
        images = whole.reconstruction.split(counts)
        readings = (
            Reading(SkinMaps(*a), Capture(*b), c)
            for a, b, c in zip(maps, capture, images, strict=True)
        )
        return dict(zip(batches, readings, strict=True))

    def configure_optimizers(self) -> dict[str, Any]:
        optimizer: Optimizer = AdamW(
            self.parameters(), lr=self.learning_rate, weight_decay=self.weight_decay
        )
        steps = max(int(self.trainer.estimated_stepping_batches), 1)
        schedule = LambdaLR(optimizer, lambda step: one_cycle(step, self.warmup_steps, steps))
        return {
            "optimizer": optimizer,
            "lr_scheduler": {"scheduler": schedule, "interval": "step"},
        }

    def on_save_checkpoint(self, checkpoint: dict[str, Any]) -> None:
        data = getattr(self.trainer.datamodule, "described", "unknown data")
        trained_on = f"{self.trained_on}{data}, {self.global_step} steps"
        checkpoint["skinnet"] = describe(self.model.config, trained_on)


def by_name(batch: Batches) -> dict[str, Batch]:
    """The batches of a step by the kind of their data."""
    return batch if isinstance(batch, dict) else {"twin": batch}


def _size(batch: Batches) -> int:
    return sum(len(part.photograph) for part in by_name(batch).values())


def terms(reading: Reading, batch: Batch) -> dict[str, Tensor]:
    """Every loss that counts on this batch, by its name in `LossWeights`."""
    linear, mask = rgb_to_linear_rgb(batch.photograph), batch.mask
    parts = {
        "appearance": losses.appearance_l1(reading.reconstruction, linear, mask),
        "elsewhere": losses.appearance_l1(reading.reconstruction, linear, 1 - mask),
        "stray": losses.off_skin_shading(reading.maps, mask),
    }
    if batch.truth is not None and batch.capture is not None:
        return parts | supervised(reading, batch.truth, batch.capture)
    return parts | unsupervised(reading, batch, linear)


def supervised(reading: Reading, truth: SkinMaps, capture: Capture) -> dict[str, Tensor]:
    """The losses beside a known truth."""
    maps = reading.maps
    return {
        "mask": losses.mask_cross_entropy(maps, truth.mask),
        "overlap": losses.soft_iou(maps, truth.mask),
        "pigments": losses.pigment_l1(maps, truth),
        "fractions": losses.pigment_mse(maps, truth),
        "leak": losses.error_shading_covariance(maps, truth),
        "lighting": losses.lighting_error(maps, truth),
        "white_balance": losses.white_balance_l1(reading.capture, capture),
    }


def unsupervised(reading: Reading, batch: Batch, linear: Tensor) -> dict[str, Tensor]:
    """The priors that stand in for a truth; `linear` is the photograph in linear sRGB."""
    maps, mask = reading.maps, batch.mask
    parts = {"steadiness": losses.augmentation_consistency(maps, mask)} if batch.twice else {}
    return parts | {
        "mask_guess": losses.mask_cross_entropy(maps, mask),
        "camera": losses.camera_prior(reading.capture),
        "specular": losses.specular_sparsity(maps, mask),
        "smoothness": losses.shading_smoothness(maps, mask),
        "shading": losses.shading_from_luminance(maps, linear, mask),
    }


def one_cycle(step: int, warmup: int, steps: int) -> float:
    """Share of the largest learning rate: a linear rise, then half a cosine to zero."""
    if step < warmup:
        return (step + 1) / (warmup + 1)
    done = min((step - warmup) / max(steps - warmup, 1), 1.0)
    return 0.5 * (1 + math.cos(math.pi * done))
