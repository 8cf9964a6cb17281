"""How well faces are found, beside the cascade that found them before.

    python -m benchmarks.faces [--json] [--faces FOLDER] [--every N]

The portraits are those of Congress and of London. Each is turned by 0, 15, 30 and 45 degrees to
alternate sides, has half of its face hidden by fingers or a plain patch, and is shrunk to 100
pixels (`small`) and until the box of the face has few pixels (`by_size`). Groups are 2 to 12
portraits in one picture. A face is found if the square around its head overlaps the true one by
half (intersection over union). `twice` counts faces that are found more than once, and `false`
claims that belong to no face, over all of these pictures; `false_per_picture` is over pictures
without a face. `landmarks` are median distances from London's templates, relative to the distance
between the eyes, and `sclera` is the share of the pixels called the white of the eyes that lie in
the templates' eyes. `speedup` is over a portrait of 225 x 275 pixels and one of 1350 x 1350
together. Both finders take turns in one thread; `ms` are medians of processor time, which other
programs disturb less than the clock's.
"""

import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from numpy.typing import NDArray

from benchmarks.cascade import find_face
from benchmarks.face_count import FaceCount, add_up
from benchmarks.face_landmarks import find_inside, measure_distances, summarise
from benchmarks.face_pictures import FacePicture, hide_half, make_group, shrink, turn
from benchmarks.faceless import make_faceless
from benchmarks.portrait_faces import KnownFace, list_portraits, read_template
from benchmarks.report import Results, main
from benchmarks.targets import flatten
from skinnet.images import find_faces
from skinnet.images.faces._face_parts import find_face_parts

FOLDER = Path(__file__).parents[2] / "shared" / "data" / "faces"
TILTS = (0, 15, 30, 45)
SMALL = 100
"""Longer side in pixels of the small pictures."""
SIZES = (32, 24, 16, 12)
"""Sides of the smaller faces' boxes, in pixels."""
SHRUNK = 4
"""Every fourth portrait is shrunk to these."""
GROUPS = 66
"""Pictures of groups."""
LARGE_FACE = 300
"""Side of the face's box, in pixels, from which on a portrait is timed as a large one."""
TIMED = 15
"""Portraits of each size that are timed."""

ASKED: dict[str, Any] = {
    "tilt_0": ">= 1.0",
    "tilt_15": ">= 1.0",
    "tilt_30": ">= .99",
    "tilt_45": ">= .97",
    "half_hidden": ">= .95",
    "small": ">= .95",
    "group": ">= .97",
    "twice": "0",
    "false_per_picture": "<= .05",
    "landmarks": "<= .03",
    "sclera": ">= .95",
    "speedup": ">= 5",
}

Photo = NDArray[np.uint8]


def measure(faces: Path | None = None, every: int = 1) -> Results:
    """Measure every figure; with `every` = n, only every nth portrait is used."""
    portraits = list_portraits(faces or FOLDER, every)
    counts: dict[str, FaceCount] = {}
    for number, known in enumerate(portraits):
        for name, picture in _make_pictures(known, number):
            found = [face.box for face in find_faces(picture.photo)]
            counts.setdefault(name, FaceCount()).add(picture, found)
    counts["group"] = count_groups(portraits, max(1, GROUPS // every))
    by_size = {str(side): counts.pop(f"size_{side}").share for side in SIZES}
    whole = add_up(list(counts.values()))
    return {
        **{name: count.share for name, count in counts.items()},
        "by_size": by_size,
        "twice": whole.twice,
        "false": whole.false,
        **measure_faceless(portraits),
        **measure_landmarks(portraits),
        **measure_speed(portraits),
        "portraits": len(portraits),
    }


def _make_pictures(known: KnownFace, number: int) -> Iterator[tuple[str, FacePicture]]:
    """Yield the conditions of a portrait, by name."""
    photo, box = known.read(), known.box
    for tilt in TILTS:
        picture = turn(photo, box, (-1) ** number * tilt) if tilt else FacePicture(photo, [box])
        yield f"tilt_{tilt}", picture
    yield "half_hidden", hide_half(photo, box, number)
    yield "small", shrink(photo, box, SMALL / max(photo.shape[:2]))
    for side in SIZES if number % SHRUNK == 0 else ():
        yield f"size_{side}", shrink(photo, box, side / box.width)


def count_groups(portraits: Sequence[KnownFace], pictures: int, seed: int = 0) -> FaceCount:
    """Count the faces found in pictures of 2 to 12 portraits."""
    rng, count = np.random.default_rng(seed), FaceCount()
    for number in range(pictures):
        people = min(2 + number % 11, len(portraits))
        chosen = rng.choice(len(portraits), people, replace=False)
        picture = make_group([portraits[index] for index in chosen], rng)
        count.add(picture, [face.box for face in find_faces(picture.photo)])
    return count


def measure_landmarks(portraits: Sequence[KnownFace]) -> Results:
    """Measure landmarks and the white of the eyes where there is a template."""
    distances, inside = [], []
    for known in portraits:
        if (path := known.path.with_suffix(".tem")).is_file():
            template, photo = read_template(path), known.read()
            for face in find_faces(photo):
                distances.append(measure_distances(template, face.landmarks))
                white = find_face_parts(photo, face).sclera
                inside += [find_inside(template, patch.centres) for patch in white]
    pixels = np.concatenate(inside) if inside else np.empty(0)
    return {
        "landmarks": summarise(distances),
        "sclera": float(pixels.mean()) if len(pixels) else None,
        "sclera_pixels": len(pixels),
        "templates": len(distances),
    }


def measure_faceless(portraits: Sequence[KnownFace]) -> Results:
    """Measure false claims in pictures without a face, and name the pictures."""
    step = max(1, len(portraits) // 40)
    claims = {name: len(find_faces(photo)) for name, photo in make_faceless(portraits[::step])}
    return {
        "false_per_picture": sum(claims.values()) / len(claims),
        "false_in": [name for name, count in claims.items() if count],
        "faceless": len(claims),
    }


def measure_speed(portraits: Sequence[KnownFace]) -> Results:
    """Measure both finders on the same portraits, in turns."""
    usual = [known for known in portraits if known.box.width < LARGE_FACE]
    large = [known for known in portraits if known.box.width >= LARGE_FACE]
    times = {
        name: _time_finders([known.read() for known in some[:TIMED]])
        for name, some in (("portrait", usual), ("large", large))
        if some
    }
    return {
        "speedup": _add_times(times, "cascade") / _add_times(times, "find_faces"),
        "ms": times,
    }


def _add_times(times: Mapping[str, Mapping[str, float]], finder: str) -> float:
    return sum(one[finder] for one in times.values())


def _time_finders(photos: Sequence[Photo]) -> dict[str, float]:
    finders: dict[str, Callable[[Photo], Any]] = {"cascade": find_face, "find_faces": find_faces}
    times: dict[str, list[float]] = {name: [] for name in finders}
    for photo in photos:
        for name, find in finders.items():
            started = time.process_time()
            find(photo)
            times[name].append(1e3 * (time.process_time() - started))
    return {name: median(some) for name, some in times.items()}


def layout(results: Results) -> str:
    """Lay the figures out, each with its target."""
    lines = [f"{'':24}{'measured':>12}  asked"]
    for name, value in flatten(results):
        asked = ASKED.get(name, ASKED.get(name.partition(".")[0], ""))
        shown = f"{value:.4g}" if isinstance(value, float) else str(value)
        lines.append(f"{name:24}{shown:>12}  {asked}".rstrip())
    return "\n".join(lines)


if __name__ == "__main__":
    main(
        measure,
        __doc__ or "",
        layout,
        paths={"faces": "folder of the portraits, with congress/ and london/"},
        counts={"every": "use every Nth portrait only"},
    )
