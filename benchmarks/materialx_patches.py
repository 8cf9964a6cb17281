"""The material of a MaterialX document as shaders of WebGL, by MaterialX's own generator."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import MaterialX
from MaterialX import PyMaterialXGenGlsl, PyMaterialXGenShader

_ROLES = {"table": "table"} | {
    f"{name}_map": name for name in ("melanin", "hemoglobin", "skin", "original")
}


def load(path: Path) -> Any:
    """Load a document with MaterialX's libraries, and validate it."""
    library = MaterialX.createDocument()
    MaterialX.loadLibraries(
        MaterialX.getDefaultDataLibraryFolders(), MaterialX.getDefaultDataSearchPath(), library
    )
    document = MaterialX.createDocument()
    MaterialX.readFromXmlFile(document, str(path))
    document.setDataLibrary(library)
    valid, message = document.validate()
    if not valid:
        raise ValueError(message)
    return document


class Generated(NamedTuple):
    """Shaders that MaterialX has generated.

    Args:
        shaders: Vertex and fragment shader.
        textures: Names of the uniforms of the textures, by table and names of maps.
        uniforms: The values of the other uniforms, which are numbers and vectors.
    """

    shaders: tuple[str, str]
    textures: dict[str, str]
    uniforms: dict[str, tuple[float, ...]]


def generate(path: Path, inputs: Mapping[str, float]) -> Generated:
    """Generate the shaders of the skin's albedo.

    Args:
        path: The document that `skinnet shader` writes.
        inputs: Values of the inputs of its skin node, by the names of their sliders.

    Returns:
        The shaders, and what they are given.
    """
    document = load(path)
    graph = document.getNodeGraph("skin_colour")
    skin = graph.getNode("skin")
    for name, value in inputs.items():
        skin.setInputValue(name.lower().replace(" ", "_"), float(value))
    generator = PyMaterialXGenGlsl.EsslShaderGenerator.create()
    context = PyMaterialXGenShader.GenContext(generator)
    context.registerSourceCodeSearchPath(MaterialX.getDefaultDataSearchPath())
    context.getOptions().shaderInterfaceType = (
        PyMaterialXGenShader.ShaderInterfaceType.SHADER_INTERFACE_COMPLETE
    )
    colours = PyMaterialXGenShader.DefaultColorManagementSystem.create(generator.getTarget())
    colours.loadLibrary(document)
    generator.setColorManagementSystem(colours)
    shader = generator.generate("skin", graph.getOutput("albedo"), context)
    vertex, pixel = (shader.getSourceCode(each) for each in ("vertex", "pixel"))
    textures, uniforms = _read_uniforms(shader)
    return Generated((vertex, pixel), textures, uniforms)


def _read_uniforms(shader: Any) -> tuple[dict[str, str], dict[str, tuple[float, ...]]]:
    """Names of the textures' uniforms, and the values of the others."""
    textures: dict[str, str] = {}
    uniforms: dict[str, tuple[float, ...]] = {}
    block = shader.getStage("pixel").getUniformBlock("PublicUniforms")
    for port in (block[index] for index in range(block.size())):
        name, kind = port.getVariable(), port.getType().getName()
        if kind == "filename":
            textures[next(role for part, role in _ROLES.items() if part in name)] = name
        elif kind in ("float", "vector2", "color3"):
            uniforms[name] = tuple(map(float, port.getValue().getValueString().split(",")))
    return textures, uniforms
