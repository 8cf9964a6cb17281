from .albedo import AlbedoColour as AlbedoColour
from .albedo import AlbedoMaps as AlbedoMaps
from .mitsuba import MitsubaCapture as MitsubaCapture

__all__ = ["AlbedoColour", "AlbedoMaps", "MitsubaCapture"]
