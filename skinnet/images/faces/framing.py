"""A square around a head."""

from skinnet.images.box import Box

HEAD_CENTRE = 0.45
"""Distance from the top of the face's box down to the head's centre, in heights of that box. The
head's centre is half-way from the top of the hair to the chin."""


def frame_head(face: Box, width: int, height: int, margin: float = 2.0) -> Box:
    """Place a square around the head, and clip it to the photograph.

    Args:
        face: The face's box, from the brows to the chin.
        width: Columns of the photograph.
        height: Rows of the photograph.
        margin: Side of the square in sides of the face's box; at 1.4 or more, hair and chin of an
            upright head are inside.

    Returns:
        The square, or the part of it that is inside the photograph.

    Example:
        >>> from skinnet.images import Box, frame_head
        >>> frame_head(Box(40, 40, 60, 60), 100, 100)
        Box(left=30, top=29, right=70, bottom=69)
    """
    half = margin * max(face.width, face.height) / 2
    x = (face.left + face.right) / 2
    y = face.top + HEAD_CENTRE * face.height
    return Box(
        max(0, round(x - half)),
        max(0, round(y - half)),
        min(width, round(x + half)),
        min(height, round(y + half)),
    )
