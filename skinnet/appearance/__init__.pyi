from .blood_sequence import BloodSequence as BloodSequence
from .colour import SkinColour as SkinColour
from .dynamic import DynamicModel as DynamicModel
from .edit import PigmentEdit as PigmentEdit
from .edit import edit_texture as edit_texture
from .hybrid import HybridModel as HybridModel
from .joint import JointModel as JointModel
from .joint_measures import measure_joint as measure_joint
from .linear import LinearModel as LinearModel
from .maps_file import load_maps as load_maps
from .maps_file import save_maps as save_maps
from .measures import Measures as Measures
from .measures import measure as measure
from .skin_texture import SkinTexture as SkinTexture
from .stack import SubjectStack as SubjectStack
from .stack import open_stack as open_stack
from .stack_writer import write_stack as write_stack

__all__ = [
    "BloodSequence",
    "DynamicModel",
    "HybridModel",
    "JointModel",
    "LinearModel",
    "Measures",
    "PigmentEdit",
    "SkinColour",
    "SkinTexture",
    "SubjectStack",
    "edit_texture",
    "load_maps",
    "measure",
    "measure_joint",
    "open_stack",
    "save_maps",
    "write_stack",
]
