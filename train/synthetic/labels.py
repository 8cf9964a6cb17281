"""What a pixel or a triangle of a synthetic head shows."""

BACKGROUND, SKIN, EYE, TEETH, MOUTH, HAIR, GLASSES, CLOTH = range(8)
"""MOUTH is all that is red and dark inside: gums, tongue, walls of the mouth, eye sockets."""
