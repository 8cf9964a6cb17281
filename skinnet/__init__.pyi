from .appearance import HybridModel as HybridModel
from .appearance import JointModel as JointModel
from .appearance import LinearModel as LinearModel
from .errors import InputError as InputError
from .inference import Decomposer as Decomposer
from .inference import Decomposition as Decomposition
from .network import SkinAutoencoder as SkinAutoencoder
from .network import SkinEncoder as SkinEncoder
from .physics import Capture as Capture
from .physics import SkinDecoder as SkinDecoder
from .physics import SkinLookup as SkinLookup
from .physics import SkinOptics as SkinOptics
from .physics import SkinReflectance as SkinReflectance
from .physics import SpectralCamera as SpectralCamera
from .shape import ShapeModel as ShapeModel

__all__ = [
    "Capture",
    "Decomposer",
    "Decomposition",
    "HybridModel",
    "InputError",
    "JointModel",
    "LinearModel",
    "ShapeModel",
    "SkinAutoencoder",
    "SkinDecoder",
    "SkinEncoder",
    "SkinLookup",
    "SkinOptics",
    "SkinReflectance",
    "SpectralCamera",
]

__version__: str
