"""The verbs of textures and materials: what each does, its examples, its flags and its function."""

from skinnet.inference._command.photo_verbs import PhotoVerb
from skinnet.material._shader_flags import add_shader

MATERIAL_VERBS: dict[str, PhotoVerb] = {
    "shader": PhotoVerb(
        "write the skin model for Blender, MaterialX, GLSL and OSL",
        add_shader,
        "skinnet.material._shader_verb:shader",
        (
            ("skinnet shader", "a table and shaders with sliders, in the folder skinshader"),
            ("skinnet shader a_melanin.png a_hemoglobin.png", "a material that reads these maps"),
            ("skinnet shader --target blender -o skin", "the node group of Blender alone"),
        ),
        "It writes colours by melanin and hemoglobin as a table, EXR and 16-bit PNG, and what "
        "looks them up: sliders scale and add both pigments, flush skin, and let the pulse show.",
    ),
}
"""The verbs, in the order in which the help lists them; each needs the extra `torch`."""
