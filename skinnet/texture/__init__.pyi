from .projection import project_texture as project_texture
from .tutte import compute_tutte_embedding as compute_tutte_embedding
from .warp import TextureSpace as TextureSpace
from .warp import WarpedTexture as WarpedTexture
from .warp import warp_texture as warp_texture

__all__ = [
    "TextureSpace",
    "WarpedTexture",
    "compute_tutte_embedding",
    "project_texture",
    "warp_texture",
]
