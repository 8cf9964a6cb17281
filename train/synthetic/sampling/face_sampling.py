"""Random faces: skin, marks, hair and features."""

import numpy as np
import torch
from jaxtyping import Float

from skinnet.physics import Nuisance
from train.synthetic.sampling.style_sampling import add_style, make_no_style
from train.synthetic.scene import (
    CHART_SIZE,
    MOLES,
    BeardParameters,
    FaceParameters,
    FeatureParameters,
    HairParameters,
    MarkParameters,
    PigmentParameters,
    SkinParameters,
    SpecularParameters,
)
from train.synthetic.tensors import make_tensors
from train.synthetic.variety import Variety

MELANIN_RANGE = (0.015, 0.25)
"""Base fraction of melanin, uniform in its logarithm.

The typology angles are 73 to -38 degrees. The lightness L* is 80 to 30 if specular reflection is
included, as in the measurements of an instrument."""

RANDOMISED_MELANIN_RANGE = (0.015, 0.33)
"""Base fraction of melanin of domain-randomised skin.

Very dark skin in photographs is darker and greyer than skin of the test set. A network that was
trained without such skin reads it as pale skin in dim light."""

ANY_MELANIN_RANGE = (0.012, 0.42)
"""The same for the variety `any`: the darkest Londoners have the angle of a fraction of .35."""

HEMOGLOBIN_RANGE = (0.018, 0.090)
"""Base fraction of hemoglobin, uniform in its logarithm: somewhat more than the middle 90 % of
measured forearms."""

_HAIR = ((0.010, 0.008, 0.007), (0.05, 0.03, 0.02), (0.13, 0.07, 0.03), (0.36, 0.25, 0.13),
         (0.30, 0.30, 0.30), (0.60, 0.59, 0.57), (0.18, 0.06, 0.02))  # fmt: skip
_IRIS = ((0.03, 0.02, 0.01), (0.08, 0.05, 0.02), (0.06, 0.10, 0.12), (0.07, 0.10, 0.05))
_GLASSES = ((0.02, 0.02, 0.02), (0.10, 0.05, 0.03), (0.45, 0.40, 0.30), (0.35, 0.35, 0.36))


def sample_face(
    rng: np.random.Generator, domain_randomised: bool = False, variety: Variety = "mild"
) -> FaceParameters:
    """Sample all that is painted on a head, without a skin of a hybrid model.

    Args:
        rng: Random numbers.
        domain_randomised: Whether to sample melanin from `RANDOMISED_MELANIN_RANGE`, or of the
            variety `any` from `ANY_MELANIN_RANGE`; for training alone.
        variety: Which kind of faces.

    Returns:
        Parameters in the precision that they were sampled in, most of them in float64.
    """
    randomised = RANDOMISED_MELANIN_RANGE if variety == "mild" else ANY_MELANIN_RANGE
    limits = randomised if domain_randomised else MELANIN_RANGE
    f_mel = float(np.exp(rng.uniform(*np.log(limits))))
    skin, marks = _sample_skin(rng, f_mel), _sample_marks(rng)
    # Hair and eyes of the variety `any` say nothing about the skin.
    hinted = f_mel if variety == "mild" else float(np.exp(rng.uniform(*np.log(limits))))
    (hair, features), (beard, cosmetics, garments) = _sample_features(rng, hinted), make_no_style()
    face = FaceParameters(skin, marks, hair, features, beard, cosmetics, garments)
    return face if variety == "mild" else add_style(face, rng)


def _sample_skin(rng: np.random.Generator, f_mel: float) -> SkinParameters:
    f_blood = np.exp(rng.uniform(*np.log(HEMOGLOBIN_RANGE)))
    fractions = {"melanin": f_mel, "hemoglobin": f_blood}
    regions = dict(zip(fractions, sample_regions(rng), strict=True))
    coarse = {
        "melanin": rng.normal(0, 0.08, (1, 8, 10)),
        "hemoglobin": rng.normal(0, 0.12, (1, 8, 10)),
    }
    middle = {
        "melanin": rng.normal(0, rng.uniform(0.01, 0.06), (1, 24, 30)),
        "hemoglobin": rng.normal(0, rng.uniform(0.02, 0.09), (1, 24, 30)),
    }
    fine = {name: rng.normal(0, rng.uniform(0.01, 0.07), (1, 84, 104)) for name in fractions}
    melanin, hemoglobin = (
        PigmentParameters(
            **make_tensors(
                fraction=fractions[name],
                regions=regions[name],
                coarse=coarse[name],
                middle=middle[name],
                fine=fine[name],
                model_skin=np.zeros((1, *CHART_SIZE), np.float32),
            )
        )
        for name in fractions
    )
    bump = rng.uniform(0.01, 0.07) * rng.standard_normal((2, *CHART_SIZE), np.float32)
    none = torch.tensor(0.0)
    relief, specular = torch.from_numpy(bump), sample_specular(rng)
    return SkinParameters(melanin, hemoglobin, none, relief, specular, Nuisance.zeros())


def sample_regions(
    rng: np.random.Generator,
) -> tuple[Float[np.ndarray, "regions"], Float[np.ndarray, "regions"]]:
    """Sample log factors of melanin and of hemoglobin, by region.

    Returns:
        Two arrays over forehead, cheeks, nose, eyelids, lips and chin.
    """
    melanin = rng.normal((0.1, 0, 0, 0.12, -0.2, 0), (0.12, 0.1, 0.1, 0.15, 0.3, 0.1))
    hemoglobin = rng.normal((0, 0.3, 0.25, 0.1, 0.8, 0), (0.1, 0.25, 0.2, 0.2, 0.3, 0.12))
    return melanin, hemoglobin


def sample_specular(rng: np.random.Generator) -> SpecularParameters:
    """Sample the oil on skin and the roughness of its lobe, in float64."""
    return SpecularParameters(
        **make_tensors(oil=np.exp(rng.normal(-0.1, 0.4)), roughness=rng.uniform(0.32, 0.65))
    )


def _sample_marks(rng: np.random.Generator) -> MarkParameters:
    """Marks that are sparse on the chart; most moles are absent."""
    freckles = rng.random((1, 120, 150)) < rng.choice([0, 0.01, 0.05], p=(0.7, 0.15, 0.15))
    spots = rng.random((1, 60, 74)) < rng.choice([0, 0.004], p=(0.7, 0.3))
    vessels = np.abs(rng.normal(0, 1, (1, 56, 70)))
    return MarkParameters(
        **make_tensors(
            freckles=rng.uniform(0.2, 0.7) * freckles,
            spots=rng.uniform(0.2, 0.6) * spots,
            vessels=rng.choice([0, rng.uniform(0.1, 0.4)], p=(0.6, 0.4)) * (vessels < 0.12),
            moles=np.column_stack(
                [
                    rng.uniform((-1.0, -1.0), (1.0, 0.7), (MOLES, 2)),
                    rng.uniform(0.008, 0.022, MOLES),
                    rng.uniform(0.6, 1.6, MOLES) * (rng.random(MOLES) < 0.25),
                ]
            ),
        )
    )


def _sample_features(
    rng: np.random.Generator, f_mel: float
) -> tuple[HairParameters, FeatureParameters]:
    # Fair hair goes with fair skin; grey hair goes with all.
    fair = f_mel < 0.06
    colour = rng.choice(len(_HAIR), p=(0.26, 0.2, 0.14, 0.12, 0.12, 0.08, 0.08) if fair
                        else (0.62, 0.16, 0.02, 0.0, 0.12, 0.08, 0.0))  # fmt: skip
    iris = rng.integers(len(_IRIS)) if fair else rng.integers(2)
    hair = make_tensors(
        colour=(np.array(_HAIR[colour]) * np.exp(rng.normal(0, 0.3))).clip(0.004, 0.8),
        strands=rng.normal(0, 0.35, (1, 16, 110)),
        brow=rng.uniform(0.3, 1.0),
        brow_shape=rng.normal(0, (0.015, 0.03, 0.008)),
    )
    beard = BeardParameters(
        **make_tensors(
            beard=rng.choice([0.0, rng.uniform(0.7, 1.0)], p=(0.78, 0.22)),
            moustache=rng.choice([0.0, 1.0], p=(0.3, 0.7)),
            stubble=rng.choice([0.0, rng.uniform(0.05, 0.35)], p=(0.6, 0.4)),
            grain=rng.random((1, *CHART_SIZE), np.float32),
        )
    )
    hair |= make_tensors(lashes=rng.uniform(0.2, 0.9))
    features = make_tensors(
        iris=np.array(_IRIS[iris]) * np.exp(rng.normal(0, 0.3)),
        # Nearly neutral: the white of the eye shows the light's colour.
        sclera=rng.uniform(0.30, 0.52) * np.exp(rng.normal((0.02, 0, -0.01), 0.025)),
        teeth=rng.uniform(0.4, 0.65) * np.exp(rng.normal((0.06, 0, -0.15), (0.03, 0, 0.08))),
        glasses=_GLASSES[rng.integers(len(_GLASSES))],
        make_up=rng.choice([0.0, rng.uniform(0.2, 0.8)], p=(0.85, 0.15)),
        lipstick=(np.array([0.35, 0.05, 0.07]) * np.exp(rng.normal(0, 0.3, 3))).clip(0.01, 0.8),
    )
    return HairParameters(beard=beard, **hair), FeatureParameters(**features)
