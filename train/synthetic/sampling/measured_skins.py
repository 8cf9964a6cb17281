"""Blood and nuisance of synthetic faces as measured skins have them."""

import numpy as np
import torch
from scipy.interpolate import RegularGridInterpolator

from skinnet.physics import F_BLOOD_RANGE, Nuisance, SkinPrior
from train.synthetic.scene import FaceParameters

_F_MEL = (0.005, 0.43)
"""Range of melanin over which blood is tabulated, wider than that of any face."""

_NODES = 96


class MeasuredSkins:
    """Samples blood and nuisance of a skin, given its melanin, from `SkinPrior`.

    Melanin itself is sampled as before, equally often at each tone: a population's own distribution
    would leave the rarest tones with few faces.
    """

    def __init__(self, prior: SkinPrior | None = None) -> None:
        self.prior = prior or SkinPrior()
        f_mel, f_blood = (
            torch.from_numpy(np.geomspace(low, high, _NODES))
            for low, high in (_F_MEL, (1e-3, F_BLOOD_RANGE[1]))
        )
        density = self.prior.log_density(f_mel[:, None], f_blood).exp()
        share = density.cumsum(-1) / density.sum(-1, keepdim=True)
        self._blood = np.log(f_blood.numpy())
        self._share = RegularGridInterpolator((np.log(f_mel.numpy()), self._blood), share.numpy())

    def apply(self, face: FaceParameters, rng: np.random.Generator) -> FaceParameters:
        """Give a face blood and nuisance.

        Args:
            face: One face, without a batch axis.
            rng: Random numbers.

        Returns:
            The face with another fraction of blood, and with its own nuisance.
        """
        f_mel = face.skin.melanin.fraction.clamp(*_F_MEL)
        f_blood = torch.tensor(self._sample_blood(float(f_mel), rng))
        mean, covariance, _ = self.prior.condition(f_mel.double(), f_blood.double())
        deviation = rng.multivariate_normal(np.zeros(len(mean)), covariance.numpy())
        nuisance = Nuisance(*((m + d).float() for m, d in zip(mean, deviation, strict=True)))
        hemoglobin = face.skin.hemoglobin._replace(fraction=f_blood)
        return face._replace(skin=face.skin._replace(hemoglobin=hemoglobin, nuisance=nuisance))

    def _sample_blood(self, f_mel: float, rng: np.random.Generator) -> float:
        places = np.column_stack([np.full(_NODES, np.log(f_mel)), self._blood])
        return float(np.exp(np.interp(rng.random(), self._share(places), self._blood)))
