"""The exact nearest node of a surface, for very many colours at once."""

from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int

PAIRS = 1 << 19
"""Comparisons of a colour with a node that take about as long as dividing a box."""

BITS = 10
"""Bits of a box's place along each channel; 30 fit an int32."""

_COLOURS, _NODES, _PRODUCTS = 1 << 14, 1 << 11, 1 << 15
"""What is worked on at a time: it stays in the cache, and no product is worth a second thread."""

_ROUNDING = 1e-6
"""Of the float32 in which nodes are matched, as a share of the coordinates."""


class NearestColour:
    """Finds the nearest of the nodes of a grid of colours, in Euclidean distance.

    |q - m|^2 - |q - n|^2 is affine in q: a node m that loses to n at every corner of a box loses to
    it for every colour in the box, and is dropped for all of them at once. Colours are sorted into
    boxes; each box drops what its parent left over, and is divided until comparing its colours with
    the rest is cheaper. A node is matched against its four neighbours in the grid, which is enough
    far from the foot of the box, and against the node nearest to the middle of the box.

    The answer is that of a search through all nodes, for any surface and any colour; a tie within
    the rounding of float64 may go to either node.
    """

    def __init__(self, colours: Float[np.ndarray, "rows columns 3"]):
        nodes = colours.reshape(-1, 3).astype(np.float64)
        self._nodes = np.array([*nodes.T, -0.5 * (nodes**2).sum(1)])
        self._matches = _matches(colours).reshape(len(nodes), 28).astype(np.float32)
        self._scale = float(np.abs(nodes).max())

    def __call__(self, colours: Float[np.ndarray, "colours 3"]) -> Int[np.ndarray, "colours"]:
        """Index of the nearest node, row by row, of each finite colour."""
        places = np.empty(len(colours), np.int32)
        for part in _slices(len(colours), _COLOURS):
            places[part] = self._places(colours[part])
        order = _argsort(places)
        # Channels first, and a one that multiplies what the nodes add to a product.
        queries = np.ones((4, len(colours)))
        for part in _slices(len(colours), _COLOURS):
            queries[:3, part] = colours.take(order[part], 0).T
        found = np.empty(len(colours), np.int64)
        if len(colours):
            everything = np.arange(self._nodes.shape[1])
            self._search(queries, places.take(order), found, BITS, everything)
        nearest = np.empty_like(found)
        nearest[order] = found
        return nearest

    def _places(self, colours: Float[np.ndarray, "colours 3"]) -> Int[np.ndarray, "colours"]:
        """Place of each colour's finest box along a curve that fills box after box.

        Boxes are even in the root of a colour, for nodes crowd where skin is dark.
        """
        root = np.sqrt(np.abs(colours) * (4.0 ** (BITS - 3) / self._scale))
        axis = np.copysign(root, colours) + 2.0 ** (BITS - 1)
        red, green, blue = _SPREAD.take(axis.clip(0, 2**BITS - 1).astype(np.intp)).T
        return np.asarray(red << 2 | green << 1 | blue)

    def _search(
        self,
        queries: Float[np.ndarray, "4 colours"],
        places: Int[np.ndarray, "colours"],
        found: Int[np.ndarray, "colours"],
        level: int,
        left: Int[np.ndarray, "nodes"],
    ) -> None:
        left = self._candidates(left, queries[:3].min(1), queries[:3].max(1))
        if len(places) * len(left) <= PAIRS or level == 0:
            self._compare(queries, found, left)
            return
        shift = 3 * (level - 1)
        inner = np.arange((places[0] >> shift) + 1, (places[-1] >> shift) + 1, dtype=np.int32)
        cuts = np.unique([0, *np.searchsorted(places, inner << shift), len(places)])
        for start, end in pairwise(cuts):
            part = slice(start, end)
            self._search(queries[:, part], places[part], found[part], level - 1, left)

    def _candidates(
        self,
        left: Int[np.ndarray, "nodes"],
        low: Float[np.ndarray, "3"],
        high: Float[np.ndarray, "3"],
    ) -> Int[np.ndarray, "candidates"]:
        """Those of the nodes left over that can be nearest to a colour between the corners."""
        middle, half = (low + high) / 2, (high - low) / 2
        half += _ROUNDING * (max(np.abs(low).max(), np.abs(high).max()) + self._scale)
        box = np.zeros((4, 7, 4), np.float32)
        box[range(4), :, range(4)] = [*middle, 1, *half]
        parts = [left[part] for part in _slices(len(left), _NODES)]
        left = np.concatenate([self._unbeaten(part, box.reshape(28, 4)) for part in parts])
        nodes = self._nodes.take(left, 1)
        score = np.einsum("c,cn->n", [*middle, 1], nodes)
        best = score.argmax()
        reach = np.einsum("c,cn->n", half, np.abs(nodes[:3] - nodes[:3, best, None]))
        return left.compress(score - score[best] + reach >= 0)

    def _unbeaten(
        self, nodes: Int[np.ndarray, "nodes"], box: Float[np.ndarray, "28 4"]
    ) -> Int[np.ndarray, "unbeaten"]:
        loses = self._matches.take(nodes, 0) @ box > 0
        # The four bytes of a node's matches at once.
        return nodes.compress(loses.view(np.uint32).ravel() == 0)

    def _compare(
        self,
        queries: Float[np.ndarray, "4 colours"],
        found: Int[np.ndarray, "colours"],
        left: Int[np.ndarray, "nodes"],
    ) -> None:
        nodes = self._nodes[:3].take(left, 1)
        first = nodes[:, :1]
        # q . (m - n) - (|m|^2 - |n|^2) / 2 is greatest at the nearest m, whatever n.
        bias = -0.5 * ((nodes - first) * (nodes + first)).sum(0)
        scores = np.array([*(nodes - first), bias])
        rows = max(1, _PRODUCTS // len(left))
        product = np.empty((rows, len(left)))
        for part in _slices(len(found), rows):
            block = queries[:, part].T
            found[part] = left.take(np.matmul(block, scores, out=product[: len(block)]).argmax(1))


def _matches(colours: Float[np.ndarray, "rows columns 3"]) -> Float[np.ndarray, "rows columns 4 7"]:
    """What multiplies (middle, 1, half) of a box to give the least |q - m|^2 - |q - n|^2 in it.

    n is the node before or after m in its column or row; where there is none, no m loses.
    """
    matches = np.zeros((*colours.shape[:2], 4, 7))
    before, after, every = slice(None, -1), slice(1, None), slice(None)
    pairs = [((after, every), (before, every)), ((every, after), (every, before))]
    for k, (m, n) in enumerate([*pairs, *(pair[::-1] for pair in pairs)]):
        away, together = colours[m] - colours[n], colours[m] + colours[n]
        matches[m][:, :, k, :3] = -2 * away
        matches[m][:, :, k, 3] = (away * together).sum(-1)
        matches[m][:, :, k, 4:] = -2 * np.abs(away)
    return matches


def _argsort(places: Int[np.ndarray, "colours"]) -> Int[np.ndarray, "colours"]:
    # NumPy sorts 16 bits by radix, several times faster than 32.
    low = np.argsort(places.astype(np.uint16), kind="stable")
    high = (places >> 16).astype(np.uint16)
    return low.take(np.argsort(high.take(low), kind="stable"))


def _slices(count: int, step: int) -> list[slice]:
    return [slice(start, min(start + step, count)) for start in range(0, count, step)]


def _spread() -> Int[np.ndarray, "places"]:
    """Numbers with two free bits after each of their own."""
    places = np.arange(2**BITS, dtype=np.int32)
    return sum(((places >> bit & 1) << 3 * bit for bit in range(BITS)), np.zeros_like(places))


_SPREAD = _spread()
