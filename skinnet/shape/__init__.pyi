from ._ibug import IBUG as IBUG
from .fit_settings import FitSettings as FitSettings
from .fit_settings import StageRecord as StageRecord
from .landmarks import read_landmarks as read_landmarks
from .landmarks import write_landmarks as write_landmarks
from .model import ShapeModel as ShapeModel
from .model_formats import load_shape_model as load_shape_model
from .model_formats import save_shape_model as save_shape_model
from .registered_meshes import build_shape_model as build_shape_model
from .registration import Registration as Registration
from .registration import register as register
from .similarity import Similarity as Similarity
from .similarity import fit_similarity as fit_similarity

__all__ = [
    "IBUG",
    "FitSettings",
    "Registration",
    "ShapeModel",
    "Similarity",
    "StageRecord",
    "build_shape_model",
    "fit_similarity",
    "load_shape_model",
    "read_landmarks",
    "register",
    "save_shape_model",
    "write_landmarks",
]
