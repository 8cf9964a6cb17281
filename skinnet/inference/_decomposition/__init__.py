"""The parts of a `Decomposition`, each of which stands on those before it.

`maps` holds what was read, `face_maps` where the face is in it, and `readings` the numbers that
follow; `summary` makes JSON of them, `archive` a file, and `notebook` HTML.
"""
