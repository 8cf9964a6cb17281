"""The verbs of textures and materials: what each does, its examples, its flags and its function."""

from skinnet.inference._command.photo_verbs import PhotoVerb

MATERIAL_VERBS: dict[str, PhotoVerb] = {}
"""The verbs, in the order in which the help lists them; each needs the extra `torch`."""
