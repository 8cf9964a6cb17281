from .box import Box as Box
from .colour_space import ColourSpace as ColourSpace
from .faces.face import Face as Face
from .faces.finder import find_faces as find_faces
from .faces.framing import frame_head as frame_head
from .photograph import read_photo as read_photo
from .photograph import read_picture as read_picture
from .picture import Picture as Picture
from .resizing import resize as resize
from .skin_segmentation import segment_skin as segment_skin
from .srgb import linear_to_srgb as linear_to_srgb
from .srgb import srgb_to_linear as srgb_to_linear
from .srgb import to_uint8 as to_uint8

__all__ = [
    "Box",
    "ColourSpace",
    "Face",
    "Picture",
    "find_faces",
    "frame_head",
    "linear_to_srgb",
    "read_photo",
    "read_picture",
    "resize",
    "segment_skin",
    "srgb_to_linear",
    "to_uint8",
]
