from .closest_point import ClosestPoints as ClosestPoints
from .closest_point import TriangleTree as TriangleTree
from .mesh import Mesh as Mesh
from .mesh_file import read_mesh as read_mesh
from .mesh_file import write_mesh as write_mesh
from .raster import Raster as Raster
from .raster import rasterise as rasterise
from .repair import RepairedMesh as RepairedMesh
from .repair import repair_mesh as repair_mesh

__all__ = [
    "ClosestPoints",
    "Mesh",
    "Raster",
    "RepairedMesh",
    "TriangleTree",
    "rasterise",
    "read_mesh",
    "repair_mesh",
    "write_mesh",
]
