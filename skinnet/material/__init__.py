"""Skin as a material of renderers: albedo textures to pigments and back, and shaders."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
