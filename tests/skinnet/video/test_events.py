"""Events of changes that are known."""

import numpy as np

from skinnet.video._events import Event, EventFinder


def find(changes: np.ndarray, sd: float = 0.02) -> list[Event]:
    finder, found = EventFinder("face"), []
    finder.restart(1)
    for number, change in enumerate(changes):
        found.append(finder.add(number / 20, float(change), sd))
    return [each for each in (*found, finder.restart(2)) if each is not None]


def ramp(size: float, onset: float = 4.0, rise: float = 3.0) -> np.ndarray:
    times = np.arange(300) / 20
    return size * np.clip((times - onset) / rise, 0, 1)


def test_a_flush_has_its_size_and_time() -> None:
    (event,) = find(ramp(0.4))
    assert event.kind == "flush" and event.end is None
    assert abs(event.onset - 4.0) < 0.5 and abs(event.log_ratio - 0.4) < 0.02


def test_a_blanching_that_ends_has_an_end() -> None:
    changes = ramp(-0.3)
    changes[200:] = 0
    (event,) = find(changes)
    assert event.kind == "blanching" and 10 < event.end < 12


def test_a_heartbeat_or_a_doubtful_change_is_no_event() -> None:
    beat = 0.1 * np.sin(2 * np.pi * 1.2 * np.arange(300) / 20)
    assert not find(beat) and not find(ramp(0.2), sd=0.2)


def test_doubt_of_the_size_does_not_hide_an_event() -> None:
    finder = EventFinder("face")
    for number, change in enumerate(ramp(0.4)):
        finder.add(number / 20, float(change), 0.6 * abs(change) + 0.02, 0.02)
    event = finder.restart(2)
    assert event is not None and event.sd > 0.2


def test_an_event_does_not_begin_before_the_video() -> None:
    changes = np.full(300, 0.3)
    changes[:5] = 0.0
    assert find(changes)[0].onset >= 0
