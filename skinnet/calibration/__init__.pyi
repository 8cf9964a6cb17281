from .colour_transform import Calibration as Calibration
from .colour_transform import calibrate as calibrate
from .exposure import fit_exposure as fit_exposure

__all__ = ["Calibration", "calibrate", "fit_exposure"]
