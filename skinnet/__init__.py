"""Reads a photograph as skin: melanin and hemoglobin maps instead of RGB."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from skinnet._version import __version__ as __version__

if TYPE_CHECKING:
    from skinnet.appearance.hybrid import HybridModel
    from skinnet.appearance.joint import JointModel
    from skinnet.appearance.linear import LinearModel
    from skinnet.inference.decomposer import Decomposer, Decomposition
    from skinnet.network.autoencoder import SkinAutoencoder
    from skinnet.network.encoder import SkinEncoder
    from skinnet.physics.camera import SpectralCamera
    from skinnet.physics.capture import Capture
    from skinnet.physics.decoder import SkinDecoder
    from skinnet.physics.lookup import SkinLookup
    from skinnet.physics.optics import SkinOptics
    from skinnet.physics.reflectance import SkinReflectance
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
    "Capture": "physics.capture",
    "Decomposer": "inference.decomposer",
    "Decomposition": "inference.decomposer",
    "HybridModel": "appearance.hybrid",
    "JointModel": "appearance.joint",
    "LinearModel": "appearance.linear",
    "ShapeModel": "shape.model",
    "SkinAutoencoder": "network.autoencoder",
    "SkinDecoder": "physics.decoder",
    "SkinEncoder": "network.encoder",
    "SkinLookup": "physics.lookup",
    "SkinOptics": "physics.optics",
    "SkinReflectance": "physics.reflectance",
    "SpectralCamera": "physics.camera",
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
