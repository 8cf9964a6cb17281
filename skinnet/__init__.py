"""Reads a photograph as skin: melanin and hemoglobin maps instead of RGB."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

__version__ = "0.1.0"

if TYPE_CHECKING:
    from skinnet.appearance.hybrid import HybridModel
    from skinnet.appearance.joint import JointModel
    from skinnet.appearance.linear import LinearModel
    from skinnet.autoencoder import SkinAutoencoder
    from skinnet.camera import SpectralCamera
    from skinnet.capture import Capture
    from skinnet.decoder import SkinDecoder
    from skinnet.encoder import SkinEncoder
    from skinnet.lookup import SkinLookup
    from skinnet.optics import SkinOptics
    from skinnet.reflectance import SkinReflectance
    from skinnet.runtime import Decomposer, Decomposition
    from skinnet.shape.model import ShapeModel

__all__ = [
    "Capture",
    "Decomposer",
    "Decomposition",
    "HybridModel",
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

_ROOMS = {
    "Capture": "capture",
    "Decomposer": "runtime",
    "Decomposition": "runtime",
    "HybridModel": "appearance.hybrid",
    "JointModel": "appearance.joint",
    "LinearModel": "appearance.linear",
    "ShapeModel": "shape.model",
    "SkinAutoencoder": "autoencoder",
    "SkinDecoder": "decoder",
    "SkinEncoder": "encoder",
    "SkinLookup": "lookup",
    "SkinOptics": "optics",
    "SkinReflectance": "reflectance",
    "SpectralCamera": "camera",
}
_TORCH_EXTRA = frozenset({"torch", "jaxtyping", "kornia", "safetensors"})


def __getattr__(name: str) -> Any:
    if name not in _ROOMS:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    try:
        return getattr(import_module(f"{__name__}.{_ROOMS[name]}"), name)
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in _TORCH_EXTRA:
            raise
        raise ImportError(
            f'skinnet.{name} needs the torch extra: pip install "skinnet[torch]"', name=error.name
        ) from error


def __dir__() -> list[str]:
    return [*__all__, "__version__"]
