from .albedo import AlbedoColour as AlbedoColour
from .albedo import AlbedoMaps as AlbedoMaps

__all__ = ["AlbedoColour", "AlbedoMaps"]
