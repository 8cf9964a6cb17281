"""How far a texture is: a bar of rows on a terminal."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from skinnet.inference._messages import Verbosity, get_verbosity
from skinnet.inference._progress import _is_terminal

_BAR = "{percentage:3.0f} % |{bar:24}| {rate_noinv_fmt}, {remaining} left"
_SMALL = 2_000_000


@contextmanager
def show_rows(texels: int) -> Iterator[Callable[[int], None]]:
    """Show how many texels are done, of a texture that is not small.

    Yields:
        A function that takes how many more are done.
    """
    if texels < _SMALL or not _is_terminal(sys.stderr) or get_verbosity() < Verbosity.USUAL:
        yield lambda more: None
        return
    from tqdm import tqdm  # here, since it takes a twentieth of a second

    words = {"bar_format": _BAR, "unit": " texels", "leave": False}
    with tqdm(total=texels, file=sys.stderr, unit_scale=True, **words) as bar:
        yield lambda more: bar.update(more) and None
