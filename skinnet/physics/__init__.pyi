from .camera import CAMERA_COMPONENTS as CAMERA_COMPONENTS
from .camera import LIGHTS as LIGHTS
from .camera import SpectralCamera as SpectralCamera
from .camera import spectrum_to_srgb as spectrum_to_srgb
from .capture import Capture as Capture
from .decoder import SkinDecoder as SkinDecoder
from .dermis import kubelka_munk as kubelka_munk
from .illuminants import daylight as daylight
from .inversion import F_BLOOD_RANGE as F_BLOOD_RANGE
from .inversion import F_MEL_RANGE as F_MEL_RANGE
from .inversion import Inversion as Inversion
from .inversion import SkinInverse as SkinInverse
from .lookup import SkinLookup as SkinLookup
from .nearest_colour import NearestColour as NearestColour
from .nuisance import Nuisance as Nuisance
from .optics import PRESETS as PRESETS
from .optics import SkinOptics as SkinOptics
from .posterior import Posterior as Posterior
from .prior import SkinPrior as SkinPrior
from .reflectance import SkinReflectance as SkinReflectance
from .sources import load_camera as load_camera
from .sources import load_light as load_light
from .sources import load_spectrum_to_srgb as load_spectrum_to_srgb
from .spectra import WAVELENGTHS as WAVELENGTHS
from .spectra import load_cameras as load_cameras
from .spectra import load_observer as load_observer
from .specular import R_SURFACE as R_SURFACE
from .specular import include_specular as include_specular
from .srgb import luminance as luminance
from .srgb import srgb_to_xyz as srgb_to_xyz
from .srgb import to_display as to_display

__all__ = [
    "CAMERA_COMPONENTS",
    "F_BLOOD_RANGE",
    "F_MEL_RANGE",
    "LIGHTS",
    "PRESETS",
    "R_SURFACE",
    "WAVELENGTHS",
    "Capture",
    "Inversion",
    "NearestColour",
    "Nuisance",
    "Posterior",
    "SkinDecoder",
    "SkinInverse",
    "SkinLookup",
    "SkinOptics",
    "SkinPrior",
    "SkinReflectance",
    "SpectralCamera",
    "daylight",
    "include_specular",
    "kubelka_munk",
    "load_camera",
    "load_cameras",
    "load_light",
    "load_observer",
    "load_spectrum_to_srgb",
    "luminance",
    "spectrum_to_srgb",
    "srgb_to_xyz",
    "to_display",
]
