"""Files that are written completely or not at all, and what a file is by its content."""

from skinnet.files._partial import make_folder, write_atomically, write_text, write_together
from skinnet.files._reading import READ_ERRORS

__all__ = ["READ_ERRORS", "make_folder", "write_atomically", "write_text", "write_together"]
