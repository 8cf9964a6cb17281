from .srgb import luminance as luminance

__all__ = ["luminance"]
