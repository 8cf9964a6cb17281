from .closest_point import ClosestPoints as ClosestPoints
from .closest_point import TriangleTree as TriangleTree
from .mesh import Mesh as Mesh
from .mesh_file import read_mesh as read_mesh
from .mesh_file import write_mesh as write_mesh
from .normals import compute_vertex_normals as compute_vertex_normals
from .raster import Raster as Raster
from .raster import rasterise as rasterise
from .repair import LengthUnit as LengthUnit
from .repair import RepairedMesh as RepairedMesh
from .repair import guess_length_unit as guess_length_unit
from .repair import repair_mesh as repair_mesh
from .sampling import sample_bilinear as sample_bilinear

__all__ = [
    "ClosestPoints",
    "LengthUnit",
    "Mesh",
    "Raster",
    "RepairedMesh",
    "TriangleTree",
    "compute_vertex_normals",
    "guess_length_unit",
    "rasterise",
    "read_mesh",
    "repair_mesh",
    "sample_bilinear",
    "write_mesh",
]
