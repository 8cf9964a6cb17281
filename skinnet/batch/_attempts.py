"""How often a block was begun: a photograph that ends its worker twice is not read a third time.

Ray begins a block again when its worker dies. If a photograph itself is the reason, as one that
needs more memory than there is, that would never end. From the second attempt on, a file says which
photograph is being read.
"""

import json
from collections import Counter

from skinnet.batch._places import Place

_MOST_DEATHS = 2

REASON = (
    "Its worker ended twice while it was read: it takes too much memory, or damages a decoder; "
    "make it smaller, or save it in another format."
)


class Attempts:
    """The attempts at a block.

    Args:
        place: The file that records them.
    """

    def __init__(self, place: Place) -> None:
        self._place = place
        self._deaths: Counter[int] = Counter()
        self._again = place.exists()
        if self._again:
            record = json.loads(place.read())
            self._deaths.update({int(n): count for n, count in record["deaths"].items()})
            if record["reading"] is not None:
                self._deaths[record["reading"]] += 1
        self._write(None)

    def is_deadly(self, number: int) -> bool:
        """Whether a photograph of the block, from 0, has ended its worker twice."""
        return self._deaths[number] >= _MOST_DEATHS

    def begin(self, number: int) -> None:
        """Note which photograph is loaded and read next."""
        if self._again:
            self._write(number)

    def end(self) -> None:
        """Forget the attempts: the block is written."""
        self._place.delete()

    def _write(self, number: int | None) -> None:
        self._place.write(json.dumps({"reading": number, "deaths": self._deaths}).encode())
