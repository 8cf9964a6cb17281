from .lights import DirectionalLight as DirectionalLight
from .lights import Light as Light
from .lights import SphericalHarmonics as SphericalHarmonics
from .rendering import SKIN_SPECULAR as SKIN_SPECULAR
from .rendering import render as render
from .scene import Scene as Scene
from .views import OrthographicView as OrthographicView
from .views import PerspectiveView as PerspectiveView
from .views import View as View
from .views import frame_face as frame_face
from .visibility import GeometryBuffers as GeometryBuffers
from .visibility import trace_geometry as trace_geometry

__all__ = [
    "SKIN_SPECULAR",
    "DirectionalLight",
    "GeometryBuffers",
    "Light",
    "OrthographicView",
    "PerspectiveView",
    "Scene",
    "SphericalHarmonics",
    "View",
    "frame_face",
    "render",
    "trace_geometry",
]
