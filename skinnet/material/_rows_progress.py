"""How far a texture is: a bar of rows on a terminal."""

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from skinnet.inference._messages import Verbosity, get_verbosity

_BAR = "{percentage:3.0f} % |{bar:24}| {rate_noinv_fmt}, {remaining} left"
_SMALL = 2_000_000


@contextmanager
def show_rows(texels: int) -> Iterator[Callable[[int], None]]:
    """Show how many texels are done, of a texture that is not small.

    Yields:
        A function that takes how many more are done.
    """
    stream = sys.stderr
    terminal = stream is not None and stream.isatty()
    if texels < _SMALL or not terminal or get_verbosity() < Verbosity.USUAL:
        yield lambda more: None
        return
    from tqdm import tqdm  # here, since it takes a twentieth of a second

    with tqdm(
        total=texels, file=stream, bar_format=_BAR, unit=" texels", unit_scale=True, leave=False
    ) as bar:
        yield lambda more: bar.update(more) and None
