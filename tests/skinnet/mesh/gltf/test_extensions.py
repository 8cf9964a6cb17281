"""Extensions: those that are read, and sentences about the others."""

from pathlib import Path

import pytest

from skinnet.errors import InputError
from skinnet.mesh._gltf.extensions import check_required, refuse_compression

PATH = Path("a.glb")


def test_every_unread_extension_is_named() -> None:
    check_required(PATH, {})
    check_required(PATH, {"extensionsRequired": ["KHR_texture_transform", "KHR_materials_unlit"]})
    check_required(PATH, {"extensionsUsed": ["ACME_one"]})
    with pytest.raises(InputError, match=r"a\.glb requires .*extension ACME_one, which is not"):
        check_required(PATH, {"extensionsRequired": ["KHR_texture_transform", "ACME_one"]})
    with pytest.raises(InputError, match="extensions ACME_one, ACME_two, which are not"):
        check_required(PATH, {"extensionsRequired": ["ACME_one", "ACME_two"]})


def test_compression_is_refused_with_its_remedy() -> None:
    refuse_compression(PATH, {})
    refuse_compression(PATH, {"extensions": {"ACME_one": {}}})
    with pytest.raises(InputError, match=r"KHR_draco_mesh_compression.*gltf-transform cp"):
        refuse_compression(PATH, {"extensions": {"KHR_draco_mesh_compression": {}}})
    with pytest.raises(InputError, match=r"EXT_meshopt_compression.*gltfpack"):
        refuse_compression(PATH, {"extensions": {"EXT_meshopt_compression": {}}})
