"""The exact nearest node of a colour table, for very many colours at once."""

from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int

_PAIRS = 1 << 19
"""Number of comparisons of a colour with a node that take about as long as dividing a box."""

_BITS = 10
"""Bits of a box's coordinate in each channel; 30 fit an int32."""

_COLOURS, _NODES, _PRODUCTS = 1 << 14, 1 << 11, 1 << 15
"""Sizes of blocks that stay in the cache; no product is large enough for a second thread."""

_ROUNDING = 1e-6
"""Rounding error of the float32 in which nodes are tested, as a share of the coordinates."""


class NearestColour:
    """Search for the nearest of a grid of colours, in Euclidean distance.

    |q - m|^2 - |q - n|^2 is affine in the colour q. So a node m that is farther than n from every
    corner of a box is farther for every colour in the box, and is dropped for all of them at once.
    Colours are sorted into boxes. Each box tests the nodes that its parent kept, and is divided
    until comparing its colours with those is cheaper. A node is tested against its four neighbours
    in the grid, which is enough far from the point closest to the box, and against the node nearest
    to the centre of the box.

    The answer is that of an exhaustive search, for any grid and any colour; a tie within the
    rounding of float64 may go to either node. On the texture of a whole face it is about nine times
    as fast as scipy's cKDTree with two workers, on bare skin about twice: `python -m
    benchmarks.lookup` measures both.

    Args:
        colours: Grid of colours [rows, columns, 3].

    Source:
        Section 4.4 of Alotaibi & Smith 2017 names the search; the method is our own.

    Example:
        >>> import numpy as np
        >>> from skinnet.physics import NearestColour
        >>> grey = np.linspace(0, 1, 6).reshape(2, 3, 1) * np.ones(3)
        >>> NearestColour(grey)(np.array([[0.9, 1.0, 1.1], [0.3, 0.2, 0.1]])).tolist()
        [5, 1]
    """

    def __init__(self, colours: Float[np.ndarray, "rows columns 3"]) -> None:
        nodes = colours.reshape(-1, 3).astype(np.float64)
        self._nodes = np.array([*nodes.T, -0.5 * (nodes**2).sum(1)])
        self._tests = _dominance_tests(colours).reshape(len(nodes), 28).astype(np.float32)
        self._scale = float(np.abs(nodes).max())

    def __call__(self, colours: Float[np.ndarray, "colours 3"]) -> Int[np.ndarray, "colours"]:
        """Find the nearest node of each colour.

        Args:
            colours: Finite colours [n, 3].

        Returns:
            Indices of nodes, counted row by row.
        """
        boxes = np.empty(len(colours), np.int32)
        for part in _slices(len(colours), _COLOURS):
            boxes[part] = self._boxes(colours[part])
        order = _argsort(boxes)
        # Channels first, and a one that multiplies the constant term of a product.
        queries = np.ones((4, len(colours)))
        for part in _slices(len(colours), _COLOURS):
            queries[:3, part] = colours.take(order[part], 0).T
        found = np.empty(len(colours), np.int64)
        if len(colours):
            everything = np.arange(self._nodes.shape[1])
            self._search(queries, boxes.take(order), found, _BITS, everything)
        nearest = np.empty_like(found)
        nearest[order] = found
        return nearest

    def _boxes(self, colours: Float[np.ndarray, "colours 3"]) -> Int[np.ndarray, "colours"]:
        """Morton code of the smallest box that holds each colour.

        Boxes are of equal size in the square root of a colour, because nodes are densest where skin
        is dark.
        """
        root = np.sqrt(np.abs(colours) * (4.0 ** (_BITS - 3) / self._scale))
        axis = np.copysign(root, colours) + 2.0 ** (_BITS - 1)
        red, green, blue = _SPREAD.take(axis.clip(0, 2**_BITS - 1).astype(np.intp)).T
        return np.asarray(red << 2 | green << 1 | blue)

    def _search(
        self,
        queries: Float[np.ndarray, "4 colours"],
        boxes: Int[np.ndarray, "colours"],
        found: Int[np.ndarray, "colours"],
        level: int,
        nodes: Int[np.ndarray, "nodes"],
    ) -> None:
        """Write the nearest of the nodes into `found`, for sorted colours of one box."""
        nodes = self._candidates(nodes, queries[:3].min(1), queries[:3].max(1))
        if len(boxes) * len(nodes) <= _PAIRS or level == 0:
            self._compare(queries, found, nodes)
            return
        shift = 3 * (level - 1)
        inner = np.arange((boxes[0] >> shift) + 1, (boxes[-1] >> shift) + 1, dtype=np.int32)
        cuts = np.unique([0, *np.searchsorted(boxes, inner << shift), len(boxes)])
        for start, end in pairwise(cuts):
            part = slice(start, end)
            self._search(queries[:, part], boxes[part], found[part], level - 1, nodes)

    def _candidates(
        self,
        nodes: Int[np.ndarray, "nodes"],
        low: Float[np.ndarray, "3"],
        high: Float[np.ndarray, "3"],
    ) -> Int[np.ndarray, "candidates"]:
        """Nodes that can be nearest to a colour between the corners."""
        centre, half = (low + high) / 2, (high - low) / 2
        half += _ROUNDING * (max(np.abs(low).max(), np.abs(high).max()) + self._scale)
        box = np.zeros((4, 7, 4), np.float32)
        box[range(4), :, range(4)] = [*centre, 1, *half]
        parts = [nodes[part] for part in _slices(len(nodes), _NODES)]
        nodes = np.concatenate([self._drop_dominated(part, box.reshape(28, 4)) for part in parts])
        values = self._nodes.take(nodes, 1)
        score = np.einsum("c,cn->n", [*centre, 1], values)
        best = score.argmax()
        reach = np.einsum("c,cn->n", half, np.abs(values[:3] - values[:3, best, None]))
        return nodes.compress(score - score[best] + reach >= 0)

    def _drop_dominated(
        self, nodes: Int[np.ndarray, "nodes"], box: Float[np.ndarray, "28 4"]
    ) -> Int[np.ndarray, "kept"]:
        """Drop nodes that are farther than a neighbour everywhere in a box."""
        dominated = self._tests.take(nodes, 0) @ box > 0
        # The four bytes of a node's tests at once.
        return nodes.compress(dominated.view(np.uint32).ravel() == 0)

    def _compare(
        self,
        queries: Float[np.ndarray, "4 colours"],
        found: Int[np.ndarray, "colours"],
        nodes: Int[np.ndarray, "nodes"],
    ) -> None:
        """Compare every colour with every node."""
        values = self._nodes[:3].take(nodes, 1)
        first = values[:, :1]
        # q . (m - n) - (|m|^2 - |n|^2) / 2 is greatest at the nearest m, whatever n.
        bias = -0.5 * ((values - first) * (values + first)).sum(0)
        scores = np.array([*(values - first), bias])
        rows = max(1, _PRODUCTS // len(nodes))
        product = np.empty((rows, len(nodes)))
        for part in _slices(len(found), rows):
            block = queries[:, part].T
            found[part] = nodes.take(np.matmul(block, scores, out=product[: len(block)]).argmax(1))


def _dominance_tests(
    colours: Float[np.ndarray, "rows columns 3"],
) -> Float[np.ndarray, "rows columns 4 7"]:
    """Factors of (centre, 1, half size) of a box in the least |q - m|^2 - |q - n|^2 within it.

    n is the node before or after m in its column or row. Where there is none, m is not dominated.
    """
    tests = np.zeros((*colours.shape[:2], 4, 7))
    before, after, every = slice(None, -1), slice(1, None), slice(None)
    pairs = [((after, every), (before, every)), ((every, after), (every, before))]
    for k, (m, n) in enumerate([*pairs, *(pair[::-1] for pair in pairs)]):
        difference, total = colours[m] - colours[n], colours[m] + colours[n]
        tests[m][:, :, k, :3] = -2 * difference
        tests[m][:, :, k, 3] = (difference * total).sum(-1)
        tests[m][:, :, k, 4:] = -2 * np.abs(difference)
    return tests


def _argsort(boxes: Int[np.ndarray, "colours"]) -> Int[np.ndarray, "colours"]:
    # NumPy sorts 16 bits by radix, several times faster than 32.
    low = np.argsort(boxes.astype(np.uint16), kind="stable")
    high = (boxes >> 16).astype(np.uint16)
    return low.take(np.argsort(high.take(low), kind="stable"))


def _slices(count: int, step: int) -> list[slice]:
    return [slice(start, min(start + step, count)) for start in range(0, count, step)]


def _spread_bits() -> Int[np.ndarray, "coordinates"]:
    """Coordinates with two free bits after each of their own."""
    values = np.arange(2**_BITS, dtype=np.int32)
    return sum(((values >> bit & 1) << 3 * bit for bit in range(_BITS)), np.zeros_like(values))


_SPREAD = _spread_bits()
