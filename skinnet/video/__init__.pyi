from .track import Track as Track
from .tracker import Tracker as Tracker

__all__ = ["Track", "Tracker"]
