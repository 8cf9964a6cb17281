"""Counts faces that are found, found twice, and claimed where there is none."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from benchmarks.face_pictures import FacePicture
from skinnet.images import Box, frame_head

RIGHT, SAME = 0.5, 0.2
"""Overlap (intersection over union) of the heads' squares from which on a face is rightly placed,
and from which on a claim belongs to a face at all."""


@dataclass
class FaceCount:
    """Counts over pictures.

    Attributes:
        faces: Faces that there are.
        found: Those that are found and rightly placed.
        twice: Those that are found more than once.
        false: Claims that belong to no face.
        pictures: Pictures that were counted.
    """

    faces: int = 0
    found: int = 0
    twice: int = 0
    false: int = 0
    pictures: int = 0

    def add(self, picture: FacePicture, claims: Iterable[Box]) -> None:
        """Count the claimed boxes of a picture."""
        height, width = picture.photo.shape[:2]
        heads = [frame_head(box, width, height) for box in picture.boxes]
        overlaps: list[list[float]] = [[] for _ in heads]
        for claim in claims:
            shared = [measure_overlap(frame_head(claim, width, height), head) for head in heads]
            if max(shared, default=0) < SAME:
                self.false += 1
            else:
                overlaps[shared.index(max(shared))].append(max(shared))
        self.pictures += 1
        self.faces += len(heads)
        self.found += sum(max(one, default=0) >= RIGHT for one in overlaps)
        self.twice += sum(len(one) > 1 for one in overlaps)

    @property
    def share(self) -> float:
        """Share of the faces that are found and rightly placed."""
        return self.found / max(self.faces, 1)


def measure_overlap(a: Box, b: Box) -> float:
    """Intersection over union of two boxes."""
    width = min(a.right, b.right) - max(a.left, b.left)
    height = min(a.bottom, b.bottom) - max(a.top, b.top)
    shared = max(width, 0) * max(height, 0)
    whole = a.width * a.height + b.width * b.height - shared
    return shared / max(whole, 1)


def add_up(counts: Sequence[FaceCount]) -> FaceCount:
    """Add the counts of several conditions."""
    return FaceCount(
        *(
            sum(getattr(one, name) for one in counts)
            for name in ("faces", "found", "twice", "false", "pictures")
        )
    )
