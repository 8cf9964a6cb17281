"""Writer of a head as USDZ, the one-file form of Universal Scene Description."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from skinnet.errors import InputError, _explain_missing
from skinnet.pipeline._head import IOR, LEVELS, ROUGHNESS, Head, encode_png


def check_usd() -> None:
    """Refuse to go on without the extra, before anything is computed."""
    try:
        import pxr  # noqa: F401
    except ImportError as error:
        raise _explain_missing(error, "usd", "USD") from error


def write_usdz(path: Path, head: Head) -> None:
    """Write a head as USDZ, with a UsdPreviewSurface.

    The pigment maps are textures of the material that no input takes: the shaders `melanin` and
    `hemoglobin`, whose scale turns what they read into volume fractions.

    Args:
        path: The file.
        head: The head.

    Raises:
        InputError: The extra is missing, or the package cannot be made.
    """
    check_usd()
    from pxr import Sdf, UsdUtils

    with TemporaryDirectory() as folder:
        for name, pixels in {
            "albedo": head.albedo,
            "normal": head.normal_map,
            **head.pigments,
        }.items():
            Path(folder, f"{name}.png").write_bytes(encode_png(pixels, head.mark))
        layer = Path(folder, "head.usdc")
        _write_layer(layer, head)
        package = Path(folder, "head.usdz")
        if not UsdUtils.CreateNewUsdzPackage(Sdf.AssetPath(str(layer)), str(package)):
            raise InputError(f"{path} cannot be made: USD refuses to pack it; write GLB instead.")
        path.write_bytes(package.read_bytes())


def _write_layer(path: Path, head: Head) -> None:
    from pxr import Sdf, Usd, UsdGeom, UsdShade, Vt

    stage = Usd.Stage.CreateNew(str(path))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    root = UsdGeom.Xform.Define(stage, "/head")
    stage.SetDefaultPrim(root.GetPrim())
    mesh = UsdGeom.Mesh.Define(stage, "/head/mesh")
    mesh.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    mesh.CreatePointsAttr(_to_vectors(Vt.Vec3fArray, head.positions))
    mesh.CreateNormalsAttr(_to_vectors(Vt.Vec3fArray, head.normals))
    mesh.SetNormalsInterpolation(UsdGeom.Tokens.vertex)
    mesh.CreateExtentAttr(
        _to_vectors(Vt.Vec3fArray, np.stack([head.positions.min(0), head.positions.max(0)]))
    )
    mesh.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(np.full(len(head.triangles), 3, "i4")))
    mesh.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(head.triangles.ravel().astype("i4")))
    coordinates = UsdGeom.PrimvarsAPI(mesh).CreatePrimvar(
        "st", Sdf.ValueTypeNames.TexCoord2fArray, UsdGeom.Tokens.vertex
    )
    coordinates.Set(_to_vectors(Vt.Vec2fArray, head.uv))
    material = _define_material(stage, head)
    UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)
    stage.Save()


def _define_material(stage: Any, head: Head) -> Any:
    from pxr import Gf, Sdf, UsdShade

    kinds = Sdf.ValueTypeNames
    material = UsdShade.Material.Define(stage, "/head/skin")
    material.GetPrim().SetCustomDataByKey("skinnet", dict(head.facts))
    surface = UsdShade.Shader.Define(stage, "/head/skin/surface")
    surface.CreateIdAttr("UsdPreviewSurface")
    for name, value in {"roughness": ROUGHNESS, "metallic": 0.0, "ior": IOR}.items():
        surface.CreateInput(name, kinds.Float).Set(value)
    albedo = _define_texture(stage, "albedo", "sRGB")
    surface.CreateInput("diffuseColor", kinds.Color3f).ConnectToSource(
        albedo.CreateOutput("rgb", kinds.Float3)
    )
    normal = _define_texture(stage, "normal", "raw")
    normal.CreateInput("scale", kinds.Float4).Set(Gf.Vec4f(2, 2, 2, 1))
    normal.CreateInput("bias", kinds.Float4).Set(Gf.Vec4f(-1, -1, -1, 0))
    surface.CreateInput("normal", kinds.Normal3f).ConnectToSource(
        normal.CreateOutput("rgb", kinds.Float3)
    )
    for name, scale in head.scales.items():
        texture = _define_texture(stage, name, "raw")
        texture.CreateInput("scale", kinds.Float4).Set(Gf.Vec4f(scale * LEVELS))
        texture.CreateOutput("r", kinds.Float)
    material.CreateSurfaceOutput().ConnectToSource(surface.CreateOutput("surface", kinds.Token))
    return material


def _define_texture(stage: Any, name: str, space: str) -> Any:
    from pxr import Sdf, UsdShade

    kinds = Sdf.ValueTypeNames
    reader = UsdShade.Shader.Define(stage, "/head/skin/st")
    reader.CreateIdAttr("UsdPrimvarReader_float2")
    reader.CreateInput("varname", kinds.String).Set("st")
    texture = UsdShade.Shader.Define(stage, f"/head/skin/{name}")
    texture.CreateIdAttr("UsdUVTexture")
    texture.CreateInput("file", kinds.Asset).Set(f"./{name}.png")
    texture.CreateInput("sourceColorSpace", kinds.Token).Set(space)
    for axis in ("wrapS", "wrapT"):
        texture.CreateInput(axis, kinds.Token).Set("clamp")
    texture.CreateInput("st", kinds.Float2).ConnectToSource(
        reader.CreateOutput("result", kinds.Float2)
    )
    return texture


def _to_vectors(kind: Any, values: Any) -> Any:
    return kind.FromNumpy(np.ascontiguousarray(values, np.float32))
