"""What a pixel or a triangle of a synthetic head is."""

BACKGROUND, SKIN, EYE, TEETH, MOUTH, HAIR, GLASSES, CLOTH = range(8)
"""MOUTH is what is red and dark within: gums, tongue, the mouth's walls and the eyes' sockets."""
