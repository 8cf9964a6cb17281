"""Rectangles of pixels."""

from typing import NamedTuple


class Box(NamedTuple):
    """A rectangle of pixels.

    Attributes:
        left: First column inside.
        top: First row inside.
        right: First column outside.
        bottom: First row outside.

    Example:
        >>> from skinnet.images import Box
        >>> box = Box(10, 20, 40, 60)
        >>> box.width, box.height
        (30, 40)
        >>> box.slices
        (slice(20, 60, None), slice(10, 40, None))
    """

    left: int
    top: int
    right: int
    bottom: int

    @property
    def width(self) -> int:
        """Number of columns."""
        return self.right - self.left

    @property
    def height(self) -> int:
        """Number of rows."""
        return self.bottom - self.top

    @property
    def slices(self) -> tuple[slice, slice]:
        """Rows and columns that select the box in an array [H, W, ...]."""
        return slice(self.top, self.bottom), slice(self.left, self.right)
