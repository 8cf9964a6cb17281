from .calibrate import CalibratedColours as CalibratedColours
from .calibrate import ColourSettings as ColourSettings
from .initial_pose import find_initial_pose as find_initial_pose
from .relight import RelightSettings as RelightSettings
from .texture_inversion import invert_texture as invert_texture
from .texture_space import WarpSettings as WarpSettings
from .texture_space import embed_model as embed_model

__all__ = [
    "CalibratedColours",
    "ColourSettings",
    "RelightSettings",
    "WarpSettings",
    "embed_model",
    "find_initial_pose",
    "invert_texture",
]
