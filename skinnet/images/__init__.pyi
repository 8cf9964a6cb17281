from .box import Box as Box
from .colour_space import ColourSpace as ColourSpace
from .faces import find_face as find_face
from .faces import frame_head as frame_head
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
    "Picture",
    "find_face",
    "frame_head",
    "linear_to_srgb",
    "read_photo",
    "read_picture",
    "resize",
    "segment_skin",
    "srgb_to_linear",
    "to_uint8",
]
