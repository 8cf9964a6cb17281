"""Which shots of a person share a session, which one is left out, and whether the rest agree."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.sparse.csgraph import connected_components

from skinnet.errors import InputError
from skinnet.inference._fusion import SHARED, Fusion, fuse_readings
from skinnet.inference._person_shot import PersonShot
from skinnet.inference._uncertainty import PIGMENTS

SAME_COLOUR = 0.1
"""Distance of log R/G and log B/G below which a person's skin has one colour in two shots.

In shots under one light and camera it is less in nine of ten pairs, with heads of other shapes; in
shots under others, in a tenth (104 synthetic faces in captures as wide as photographs).
"""

DOUBTFUL, PLAIN = 0.01, 1e-4
"""Probabilities of Q below which shots differ more than they state, and below which they plainly
differ. One of 103 people of the US Congress does so in two portraits by two photographers, and none
of 104 synthetic faces in five wide captures. One wide shot each of two such faces plainly differ in
five of six cases if melanin differs by a factor of 6 or more, and in a fifth if by 2 to 3."""


def find_sessions(chromaticities: NDArray[np.floating]) -> NDArray[np.intp]:
    """Number the sessions of shots, from 0: those in which the skin has one colour share one.

    Args:
        chromaticities: Log R/G and log B/G of the skin in each shot [shots, 2]; a shot without
            skin, NaN, has a session of its own.

    One skin has the same colour in two photographs only if light, camera and processing are alike.
    A shot joins a session if it is like one of its shots (single linkage).
    """
    distance = np.linalg.norm(chromaticities[:, None] - chromaticities[None], axis=-1)
    _, labels = connected_components(distance < SAME_COLOUR, directed=False)
    return np.asarray(labels, np.intp)


def number_sessions(shots: Sequence[PersonShot]) -> NDArray[np.intp]:
    """Number the sessions of shots, from 0."""
    return find_sessions(np.stack([shot.chromaticity for shot in shots]))


def fuse_shots(shots: Sequence[PersonShot]) -> tuple[Fusion, Fusion]:
    """Fuse melanin and hemoglobin of the whole skin and of each region, [1 + regions] each."""
    sessions = number_sessions(shots)
    means = np.stack([shot.log_means for shot in shots], -1)
    sds = np.stack([shot.log_sds for shot in shots], -1)
    melanin, hemoglobin = (
        fuse_readings(means[:, index], sds[:, index], SHARED[name], sessions)
        for index, name in enumerate(PIGMENTS)
    )
    return melanin, hemoglobin


def find_outlier(shots: Sequence[PersonShot]) -> int | None:
    """Find the one shot that is plainly unlike all others, which agree.

    Returns:
        Its index. None if no shot needs to be left out.

    Raises:
        InputError: Shots plainly differ, and it is not known which of them are wrong: not a single
            one, or one against one, or one against shots of a single other session.
    """
    if _find_p(shots) >= PLAIN:
        return None
    rest = [_find_p([*shots[:one], *shots[one + 1 :]]) for one in range(len(shots))]
    agreeing = [one for one, p in enumerate(rest) if p >= DOUBTFUL]
    if len(agreeing) == 1 and _is_outvoted(number_sessions(shots), agreeing[0]):
        return agreeing[0]
    raise InputError(_describe_conflict(shots))


def describe_outlier(shots: Sequence[PersonShot], index: int) -> str:
    """Say which shot is left out, and why."""
    at = _find_worst(shots)
    others = [*shots[:index], *shots[index + 1 :]]
    theirs = fuse_shots(others)[at].value[0]
    return (
        f"{shots[index].name} was left out: its {PIGMENTS[at]}, "
        f"{np.exp(shots[index].log_means[0, at]):.2g}, is plainly not the {np.exp(theirs):.2g} of "
        f"the other {len(others)} shots, which agree. It has failed, or shows another person."
    )


def note_disagreement(melanin: Fusion, hemoglobin: Fusion) -> list[str]:
    """Note pigments of the whole skin in which shots differ more than they state."""
    return [
        f"The shots differ in {name} more than they state ({describe_test(one)}); its interval is "
        f"{one.birge_ratio[0]:.2g} times as wide for it."
        for name, one in zip(PIGMENTS, (melanin, hemoglobin), strict=True)
        if one.p[0] < DOUBTFUL
    ]


def note_sessions(shots: Sequence[PersonShot]) -> list[str]:
    """Note shots that count as one."""
    sessions = number_sessions(shots)
    groups = [
        [shot.name for shot, session in zip(shots, sessions, strict=True) if session == one]
        for one in range(sessions.max() + 1)
    ]
    return [
        f"The skin has one colour in {_list_names(names)}: they are taken for shots of one "
        "session, whose errors are alike, so that together they are no surer than one of them. "
        "Shots in other light make it surer."
        for names in groups
        if len(names) > 1
    ]


def describe_test(fusion: Fusion) -> str:
    """Describe the test of agreement of the whole skin."""
    freedom = int(fusion.freedom[0])
    degrees = f"{freedom} degree{'s' * (freedom > 1)} of freedom"
    return f"Q {fusion.q[0]:.3g} with {degrees}, p {fusion.p[0]:.1g}"


def _find_p(shots: Sequence[PersonShot]) -> float:
    """Probability that shots of one skin differ as much in either pigment (Bonferroni)."""
    fused = fuse_shots(shots)
    return min(1.0, len(PIGMENTS) * min(float(one.p[0]) for one in fused))


def _is_outvoted(sessions: NDArray[np.intp], index: int) -> bool:
    """Whether shots of another session, or of its own, speak against a shot, and not one alone."""
    others = np.delete(sessions, index)
    return bool(sessions[index] in others) or len(set(others.tolist())) > 1


def _find_worst(shots: Sequence[PersonShot]) -> int:
    """Index of the pigment in which shots of one skin are least likely to differ as much."""
    fused = fuse_shots(shots)
    return int(np.argmin([float(one.p[0]) for one in fused]))


def _describe_conflict(shots: Sequence[PersonShot]) -> str:
    at = _find_worst(shots)
    fused = fuse_shots(shots)[at]
    ordered = sorted(shots, key=lambda shot: float(shot.log_means[0, at]))
    low, high = ordered[0], ordered[-1]
    return (
        f"The shots are plainly not of one skin: {PIGMENTS[at]} is "
        f"{np.exp(low.log_means[0, at]):.2g} in {low.name} and "
        f"{np.exp(high.log_means[0, at]):.2g} in {high.name}, which differ by more than the shots "
        f"may be wrong ({describe_test(fused)}). Give shots of one person, without those that "
        "failed."
    )


def _list_names(names: Sequence[str]) -> str:
    return f"{', '.join(names[:-1])} and {names[-1]}"
