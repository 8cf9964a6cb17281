"""What a pixel or a triangle of a synthetic head shows."""

BACKGROUND, SKIN, EYE, TEETH, MOUTH, HAIR, GLASSES, CLOTH, NAIL = range(9)
"""MOUTH is all that is red and dark inside: gums, tongue, walls of the mouth, eye sockets."""

LENS, BEARD, HEADWEAR, FACE_MASK, SCARF, CLEAR_LENS = range(9, 15)
"""Lenses of sunglasses, long beards, and cloth with colours of its own; none of it is skin. Clear
lenses are parts of meshes alone: pixels show what is behind them."""

FILM = 16
"""It is added to the material that is seen through a clear lens."""

MATERIALS = 32
"""A label is one of the materials above plus 32 times the number of a painting, which is 0 for a
single face. Faces of more people have the paintings 1 to 3. Hands and arms of person k, whose skin
has no face on its chart, have painting 4 + k."""

BODY = 4
"""Number of the first painting without a face."""
