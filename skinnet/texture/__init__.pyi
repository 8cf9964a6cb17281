from .mirror import find_mirror_vertices as find_mirror_vertices
from .projection import project_texture as project_texture
from .tutte import compute_tutte_embedding as compute_tutte_embedding
from .tutte import count_flipped_triangles as count_flipped_triangles
from .warp import TextureSpace as TextureSpace
from .warp import WarpedTexture as WarpedTexture
from .warp import warp_texture as warp_texture

__all__ = [
    "TextureSpace",
    "WarpedTexture",
    "compute_tutte_embedding",
    "count_flipped_triangles",
    "find_mirror_vertices",
    "project_texture",
    "warp_texture",
]
