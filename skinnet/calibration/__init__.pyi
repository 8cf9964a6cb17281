from .colour_transform import Calibration as Calibration
from .colour_transform import calibrate as calibrate

__all__ = ["Calibration", "calibrate"]
