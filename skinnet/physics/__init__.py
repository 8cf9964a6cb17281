"""Physics of skin and camera: a differentiable layer from pigments to linear sRGB."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
