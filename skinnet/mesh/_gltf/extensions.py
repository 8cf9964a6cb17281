"""Extensions of glTF 2.0: which are read, and what to do about the others."""

from pathlib import Path
from typing import Any

from skinnet.errors import InputError

_READ = frozenset(
    """
    KHR_texture_transform KHR_mesh_quantization KHR_materials_pbrSpecularGlossiness
    EXT_texture_webp EXT_texture_avif KHR_node_visibility
    """.split()
)
# These change neither the geometry nor the base colour.
_NEUTRAL = frozenset(
    """
    KHR_materials_unlit KHR_materials_anisotropy KHR_materials_clearcoat KHR_materials_dispersion
    KHR_materials_diffuse_transmission KHR_materials_emissive_strength KHR_materials_ior
    KHR_materials_iridescence KHR_materials_sheen KHR_materials_specular
    KHR_materials_transmission KHR_materials_variants KHR_materials_volume
    KHR_materials_volume_scatter KHR_lights_punctual KHR_xmp KHR_xmp_json_ld KHR_animation_pointer
    EXT_lights_image_based EXT_lights_ies EXT_mesh_features EXT_structural_metadata
    EXT_instance_features KHR_node_hoverability KHR_node_selectability KHR_audio_emitter
    KHR_implicit_shapes KHR_physics_rigid_bodies FB_ngon_encoding GODOT_single_root MSFT_lod
    """.split()
)
# Whether there is something to read without them is known where they are used.
_CHECKED_IN_USE = frozenset(
    """
    KHR_draco_mesh_compression EXT_meshopt_compression KHR_meshopt_compression KHR_texture_basisu
    MSFT_texture_dds
    """.split()
)

_COMPRESSIONS = {
    "KHR_draco_mesh_compression": "export it without compression, or decompress it with "
    "`gltf-transform cp IN.glb OUT.glb`",
    "EXT_meshopt_compression": "export it without compression (gltfpack: without -c and -cc)",
    "KHR_meshopt_compression": "export it without compression (gltfpack: without -c and -cz)",
}


def check_required(path: Path, document: dict[str, Any]) -> None:
    """Check that every extension that a document requires is read, or changes no colour or shape.

    Raises:
        InputError: If it requires another one.
    """
    known = _READ | _NEUTRAL | _CHECKED_IN_USE
    unknown = [name for name in document.get("extensionsRequired") or [] if name not in known]
    if unknown:
        several = "s" if len(unknown) > 1 else ""
        raise InputError(
            f"{path} requires the glTF extension{several} {', '.join(map(str, unknown))}, which "
            f"{'are' if several else 'is'} not read; export it as plain glTF 2.0, OBJ or PLY."
        )


def refuse_compression(path: Path, element: dict[str, Any]) -> None:
    """Raise `InputError` if a primitive or buffer view is there in compressed form alone."""
    for name in element.get("extensions", {}):
        if name in _COMPRESSIONS:
            raise InputError(
                f"{path} has compressed meshes ({name}), which are not read; {_COMPRESSIONS[name]}."
            )
