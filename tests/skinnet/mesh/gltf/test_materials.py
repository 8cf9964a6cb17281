"""Materials: base colour, texture coordinates, alpha."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from skinnet.errors import InputError
from skinnet.mesh._gltf.container import GltfFile
from skinnet.mesh._gltf.materials import Material, list_other_pictures, read_material


def read(**material: Any) -> Material:
    return read_material(GltfFile(Path("a.gltf"), {"materials": [material]}), 0)


def test_no_material_is_white() -> None:
    material = read_material(GltfFile(Path("a.gltf"), {}), None)
    assert material.texture is None and material.factor.tolist() == [1, 1, 1]
    assert read().factor.tolist() == [1, 1, 1]


def test_the_base_colour() -> None:
    base = {"baseColorTexture": {"index": 3, "texCoord": 2}, "baseColorFactor": [0.1, 0.2, 3, 0.4]}
    material = read(name="skin", pbrMetallicRoughness=base)
    assert (material.name, material.texture, material.tex_coord) == ("skin", 3, 2)
    assert material.factor.tolist() == [0.1, 0.2, 1] and material.alpha == 0.4
    assert np.array_equal(material.transform, np.eye(3))
    with pytest.raises(InputError, match=r"a base colour is \[0.1, 0.2\]"):
        read(pbrMetallicRoughness={"baseColorFactor": [0.1, 0.2]})


def test_specular_and_glossiness_come_first() -> None:
    diffuse = {"diffuseTexture": {"index": 1}, "diffuseFactor": [0.5, 0.5, 0.5, 1]}
    extensions = {"KHR_materials_pbrSpecularGlossiness": diffuse}
    base = {"baseColorTexture": {"index": 0}}
    material = read(pbrMetallicRoughness=base, extensions=extensions)
    assert material.texture == 1 and material.factor.tolist() == [0.5, 0.5, 0.5]
    extensions = {"KHR_materials_pbrSpecularGlossiness": {}}
    assert read(pbrMetallicRoughness=base, extensions=extensions).texture is None


def test_a_turn_is_counter_clockwise_in_the_picture() -> None:
    stated = {"rotation": np.pi / 2, "scale": [2, 3], "offset": [10, 20], "texCoord": 1}
    texture = {"index": 0, "texCoord": 5, "extensions": {"KHR_texture_transform": stated}}
    material = read(pbrMetallicRoughness={"baseColorTexture": texture})
    assert material.tex_coord == 1
    # v points down: from right, the turn goes up.
    assert np.allclose(material.transform @ [1, 0, 1], [10, 18, 1])
    assert np.allclose(material.transform @ [0, 1, 1], [13, 20, 1])


@pytest.mark.parametrize(
    ("material", "cutoff"),
    [
        ({}, -1),
        ({"alphaMode": "OPAQUE", "alphaCutoff": 0.3}, -1),
        ({"alphaMode": "MASK"}, 0.5),
        ({"alphaMode": "MASK", "alphaCutoff": 0.3}, 0.3),
        ({"alphaMode": "BLEND"}, 0),
    ],
)
def test_alpha(material: dict[str, Any], cutoff: float) -> None:
    assert read(**material).cutoff == cutoff


def test_other_pictures_are_listed_by_their_roles() -> None:
    base = {"baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 1}}
    material = {"pbrMetallicRoughness": base, "emissiveTexture": {"index": 2}}
    file = GltfFile(Path("a.gltf"), {"materials": [material]})
    assert list_other_pictures(file, 0) == ["emissiveTexture", "metallicRoughnessTexture"]
    assert list_other_pictures(file, None) == []
