from .capture import Capture as Capture
from .capture_profile import CaptureProfile as CaptureProfile
from .comparison import Comparison as Comparison
from .comparison import compare_photographs as compare_photographs
from .decomposer import Decomposer as Decomposer
from .decomposition import Decomposition as Decomposition
from .indices import compute_indices as compute_indices
from .onnx_model import CAPTURE_NAMES as CAPTURE_NAMES
from .onnx_model import MAP_NAMES as MAP_NAMES
from .onnx_model import ONNX_FORMAT as ONNX_FORMAT
from .onnx_model import SHIPPED_ENCODER as SHIPPED_ENCODER
from .onnx_model import OnnxModel as OnnxModel
from .onnx_model import OutputInfo as OutputInfo
from .onnx_model import open_model as open_model
from .panel import draw_panel as draw_panel
from .person import Person as Person
from .results import write_results as write_results

__all__ = [
    "CAPTURE_NAMES",
    "MAP_NAMES",
    "ONNX_FORMAT",
    "SHIPPED_ENCODER",
    "Capture",
    "CaptureProfile",
    "Comparison",
    "Decomposer",
    "Decomposition",
    "OnnxModel",
    "OutputInfo",
    "Person",
    "compare_photographs",
    "compute_indices",
    "draw_panel",
    "open_model",
    "write_results",
]
