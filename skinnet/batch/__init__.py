"""Photographs by the million, on the cores of one machine or of many; Ray moves the work."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
