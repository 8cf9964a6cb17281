"""Training steps: appearance for all pictures, maps for those with truth."""

import math
from typing import Any

import torch
from jsonargparse.typing import NonNegativeFloat, NonNegativeInt, PositiveFloat, PositiveInt
from lightning import LightningModule
from lightning.pytorch.utilities.types import OptimizerLRSchedulerConfig
from torch import Tensor, nn
from torch.optim import AdamW, Optimizer
from torch.optim.lr_scheduler import LambdaLR

from skinnet.errors import InputError
from skinnet.network import (
    AutoencoderConfig,
    Reading,
    SkinAutoencoder,
    SkinMaps,
    agreement,
)
from skinnet.network._earlier_weights import free_uncertainty
from skinnet.network.autoencoder import Uncertainty
from skinnet.physics import Capture
from train.batch import Batch, People
from train.edited_skin import edit_skin, multiply_pigments
from train.metrics import ReadingMetrics
from train.refusals import count_steps
from train.task_losses import LossWeights, compute_losses

Batches = Batch | dict[str, Batch]
"""One kind of data, or several that each step sees together."""

KINDS = ("synthetic", "portraits")
"""Kinds of data, as they are named in logs. Data that come alone are called synthetic."""


class SkinTask(LightningModule):
    """Trains a `SkinAutoencoder`.

    Args:
        optics: Preset of the skin's optical constants.
        widths: Channels of the encoder at each level.
        working_size: Longer side in pixels of the crops that the model is to be used on.
        losses: Weight of each loss.
        learning_rate: Largest learning rate of AdamW, reached after the warm-up.
        weight_decay: Weight decay of AdamW.
        warmup_steps: Steps in which the learning rate rises; it then falls as a cosine to zero.
        weights: A .safetensors file or a checkpoint to start from (fine-tuning). To continue a run,
            use --ckpt-path instead.
        other_preset: Whether the weights may belong to another preset, to which training then
            adapts them.
    """

    def __init__(
        self,
        optics: str = "measured",
        widths: list[PositiveInt] = list(AutoencoderConfig.widths),  # noqa: B006 - never written
        working_size: PositiveInt = 128,
        losses: LossWeights = LossWeights(),  # noqa: B008 - never written
        learning_rate: PositiveFloat = 2e-3,
        weight_decay: NonNegativeFloat = 1e-4,
        warmup_steps: NonNegativeInt = 50,
        weights: str | None = None,
        other_preset: bool = False,
    ) -> None:
        super().__init__()
        self.model = SkinAutoencoder(
            AutoencoderConfig(optics, tuple(map(int, widths)), int(working_size))
        )
        # A third faster on a CPU; torch's type hints lack memory formats.
        self.model.to(memory_format=torch.channels_last)  # type: ignore[call-overload]
        self.weight_of = losses
        # Plain numbers, because weights_only cannot load the parser's restricted numbers from a
        # checkpoint of the optimizer.
        self.learning_rate = float(learning_rate)
        self.weight_decay = float(weight_decay)
        self.warmup_steps = int(warmup_steps)
        self.trained_on = ""
        if weights is not None:
            self.trained_on = f"{self._start_from(weights, other_preset)}; then "
        # What the captures of photographs add to the colour of skin: mean and log spread.
        shift, scale = torch.tensor([0.2, -0.05, -0.2]), torch.tensor([0.12, 0.15, 0.2])
        self.captures = nn.ParameterDict({"shift": shift, "log_scale": scale.log()})
        self.metrics = nn.ModuleDict({kind: ReadingMetrics() for kind in KINDS})

    def _start_from(self, path: str, other_preset: bool) -> str:
        start = SkinAutoencoder.from_pretrained(path)
        if not other_preset:
            self._check_preset(path, start.config.optics)
        try:
            # The physics is that of the preset, not of the weights.
            self.model.encoder.load_state_dict(free_uncertainty(start.encoder.state_dict()))
        except RuntimeError as error:
            raise InputError(
                f"{path} holds weights of another shape than this configuration; give the widths "
                "that they were trained with."
            ) from error
        return start.trained_on

    def forward(self, photograph: Tensor, known: Capture | None = None) -> Reading:
        """Read photographs: the encoder in the trainer's precision, the physics in float32."""
        photograph = photograph.contiguous(memory_format=torch.channels_last)
        maps, capture, uncertainty = self.model.encode(photograph, known)
        with torch.autocast(photograph.device.type, enabled=False):
            return Reading(maps, capture, self.model.decode(maps, capture), uncertainty)

    def training_step(self, batch: Batches, batch_idx: int) -> Tensor:
        """Compute and log the losses of a batch."""
        _, total, parts = self._compute_losses(batch)
        size = _count_pictures(batch)
        named = {f"train/{name}": value for name, value in parts.items()}
        self.log_dict(named, batch_size=size, sync_dist=True)
        self.log("train/loss", total, prog_bar=True, batch_size=size, sync_dist=True)
        return total

    def validation_step(self, batch: Batches, batch_idx: int) -> dict[str, Reading]:
        """Log the loss and metrics of a validation batch."""
        return self._evaluate(batch, "val")

    def test_step(self, batch: Batches, batch_idx: int) -> dict[str, Reading]:
        """Log the loss and metrics of a test batch."""
        return self._evaluate(batch, "test")

    def _evaluate(self, batch: Batches, split: str) -> dict[str, Reading]:
        readings, total, _ = self._compute_losses(batch)
        self.log(f"{split}/loss", total, batch_size=_count_pictures(batch), sync_dist=True)
        for kind, part in name_batches(batch).items():
            metrics: ReadingMetrics = self.metrics[kind]  # type: ignore[assignment]
            with torch.autocast(part.photograph.device.type, enabled=False):
                updated = metrics.update(readings[kind], part)
            for name, metric in updated.items():
                self.log(f"{split}/{kind}_{name}", metric, on_epoch=True, on_step=False)
        return readings

    def _compute_losses(
        self, batch: Batches
    ) -> tuple[dict[str, Reading], Tensor, dict[str, Tensor]]:
        named, parts = name_batches(batch), {}
        # Processes that train together need a gradient of every parameter, also without people.
        total = 0 * torch.cat(list(self.captures.values())).sum()
        named = {kind: self._edit_people(part) for kind, part in named.items()}
        readings = self._read(named)
        for kind, part in named.items():
            with torch.autocast(part.photograph.device.type, enabled=False):
                computed = compute_losses(readings[kind], part)
                if part.people is not None:
                    computed |= self._compare_people(readings[kind], part, part.people)
                for name, value in computed.items():
                    parts[f"{kind}_{name}"] = value
                    total = total + getattr(self.weight_of, name) * value
        return readings, total, parts

    def _edit_people(self, batch: Batch) -> Batch:
        """Multiply the pigments of photographs by the factors that they come with."""
        if batch.people is None or batch.people.factors is None or not batch.people.factors.any():
            return batch
        self.model.eval()
        with torch.autocast(batch.photograph.device.type, enabled=False):
            photograph = edit_skin(self.model, batch.photograph, batch.mask, batch.people.factors)
        self.model.train()
        return batch._replace(photograph=photograph)

    def _compare_people(self, reading: Reading, batch: Batch, people: People) -> dict[str, Tensor]:
        """Losses of photographs of the same people."""
        maps, mask = reading.maps, batch.mask
        if people.factors is not None:
            maps = multiply_pigments(maps, -people.factors)
        captures = self.captures["shift"], self.captures["log_scale"]
        return {
            "agreement": agreement.region_agreement(maps, people.regions, mask),
            "prediction": agreement.colour_prediction(
                maps, mask, people.colour, self.model.decoder, *captures
            ),
            "agreement_uncertainty": agreement.agreement_likelihood(
                maps, reading.uncertainty, mask
            ),
        }

    def _read(self, batches: dict[str, Batch]) -> dict[str, Reading]:
        """Read all kinds of pictures in one pass.

        If each kind had its own pass, batch normalisation would train with the statistics of each
        kind, and evaluate all kinds with a mixture of them.
        """
        counts = [len(part.photograph) for part in batches.values()]
        whole = self(
            torch.cat([part.photograph for part in batches.values()]),
            self._join_known(list(batches.values())),
        )
        return dict(zip(batches, split_reading(whole, counts), strict=True))

    def _join_known(self, batches: list[Batch]) -> Capture:
        complete = self.model.known.complete
        known = [complete(one.known, len(one.photograph), one.photograph) for one in batches]
        return Capture(*(torch.cat(parts) for parts in zip(*known, strict=True)))

    def configure_optimizers(self) -> OptimizerLRSchedulerConfig:
        """Set up AdamW with warm-up and cosine annealing."""
        optimizer: Optimizer = AdamW(
            self.parameters(), lr=self.learning_rate, weight_decay=self.weight_decay
        )
        steps = max(count_steps(self.trainer), 1)
        schedule = LambdaLR(
            optimizer, lambda step: warm_up_and_anneal(step, self.warmup_steps, steps)
        )
        return {
            "optimizer": optimizer,
            "lr_scheduler": {"scheduler": schedule, "interval": "step"},
        }

    def _check_preset(self, source: str, preset: str) -> None:
        if preset != (own := self.model.config.optics):
            raise InputError(
                f"{source} was trained with the skin of the preset {preset} and this run has "
                f"{own}, in which the same fractions have other colours; add --model.optics "
                f"{preset} and the same for the data (--data.init_args.optics, or "
                ".synthetic.optics for portraits)."
            )

    def on_load_checkpoint(self, checkpoint: dict[str, Any]) -> None:
        """Refuse to continue a run with another preset, which its state would replace."""
        self._check_preset("The checkpoint", checkpoint["skinnet"]["optics"])

    def on_save_checkpoint(self, checkpoint: dict[str, Any]) -> None:
        """Describe the model, so that `SkinAutoencoder.from_pretrained` can load it."""
        data = getattr(self.trainer, "datamodule", None)
        description = getattr(data, "description", "unknown data")
        self.model.trained_on = f"{self.trained_on}{description}, {self.global_step} steps"
        checkpoint["skinnet"] = self.model.describe()


def name_batches(batch: Batches) -> dict[str, Batch]:
    """Return the batches of a step by the kind of their data."""
    return batch if isinstance(batch, dict) else {KINDS[0]: batch}


def split_reading(whole: Reading, counts: list[int]) -> list[Reading]:
    """Split the reading of several batches that were read together."""
    maps, uncertainty = (
        zip(*(one.split(counts) for one in some), strict=True)
        for some in (whole.maps, whole.uncertainty)
    )
    captures = zip(*(one.split(counts) for one in whole.capture[:4]), strict=True)
    images = whole.reconstruction.split(counts)
    return [
        Reading(SkinMaps(*a), Capture(*b), c, Uncertainty(*d))
        for a, b, c, d in zip(maps, captures, images, uncertainty, strict=True)
    ]


def _count_pictures(batch: Batches) -> int:
    return sum(len(part.photograph) for part in name_batches(batch).values())


def warm_up_and_anneal(step: int, warmup: int, steps: int) -> float:
    """Scale the learning rate: a linear warm-up, then a cosine to zero.

    These are the learning rates of torch's LinearLR and CosineAnnealingLR in a SequentialLR. Those
    restore the planned number of steps with a checkpoint, so that the rate of a run that is resumed
    with more steps would rise again. This function follows the new plan.

    Args:
        step: Steps that were taken.
        warmup: Steps of the warm-up.
        steps: Steps of the whole run.

    Returns:
        Share of the largest learning rate, in [0, 1].

    Source:
        Loshchilov & Hutter 2017, "SGDR", equation 5, without restarts.
    """
    if step < warmup:
        return (step + 1) / (warmup + 1)
    done = min((step - warmup) / max(steps - warmup, 1), 1.0)
    return 0.5 * (1 + math.cos(math.pi * done))
