"""A reading on the console has its unit, its interval, and what is usual."""

import numpy as np
import torch

from skinnet.inference._usual_values import USUAL, describe_reading
from skinnet.physics import SkinPrior


def test_a_reading_states_unit_interval_and_what_is_usual() -> None:
    assert describe_reading("hemoglobin", 0.03, (0.016, 0.0551), "measured") == (
        "hemoglobin 3 % (90 %: 1.6 to 5.5; usual 2 to 13 %)"
    )


def test_of_other_constants_what_is_usual_is_not_known() -> None:
    expected = "melanin 12 % (90 %: 8 to 18 %)"
    assert describe_reading("melanin", 0.12, (0.08, 0.18), "paper") == expected


def test_most_measured_skins_are_usual() -> None:
    rng = torch.Generator().manual_seed(0)
    f_mel, f_blood, *_ = SkinPrior().sample(20000, rng)
    low, high = np.quantile(f_blood.numpy(), [0.025, 0.975])
    assert (round(low, 2), round(high, 2)) == USUAL["hemoglobin"]
    assert 0.98 < np.mean((f_mel.numpy() > USUAL["melanin"][0]) & (f_mel.numpy() < 0.43)) <= 1
