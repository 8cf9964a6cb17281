"""The skin of one face at full resolution: a coarse mask, corrected by colours and landmarks."""

from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from skinnet.images._connected_parts import keep_small, label_parts
from skinnet.images._face_cover import find_cover
from skinnet.images._guided_filter import enlarge_guided, filter_guided, make_guide
from skinnet.images._skin_colours import (
    compute_features,
    compute_log_density,
    estimate_log_density,
    fit_normal,
    measure_distance,
)
from skinnet.images._skin_gaps import fill_gaps
from skinnet.images.faces._face_place import place_face
from skinnet.images.faces._face_zones import FaceZones, grow, mark_zones
from skinnet.images.resizing import resize
from skinnet.images.srgb import srgb_to_linear

_FACE_SIZE = 192
"""Side of the face's box, in pixels, at which skin is segmented; smaller faces are not enlarged.
All lengths below are in sides of the face's box."""

_SHADING = np.diag([0.0, 0.0, 0.3**2])
"""Covariance that is added to that of the face's front: sides and neck have more shading."""

_LEAST_EVIDENCE, _MOST_EVIDENCE = -5.5, 4.0
"""Limits of the log odds that the colours of one pixel give."""

_LEAST_PRIOR = 0.03
"""Least probability of skin, and of no skin, that is taken from the coarse mask."""

_FACE_ODDS, _BEARD_ODDS, _NECK_ODDS, _LIPS_ODDS = 2.0, 1.0, 1.5, 2.0
"""Log odds of skin inside the face's outline, where beards grow, below the jaw, and in the lips."""

_LIPS = np.array([-0.3, -0.1, -1.5]), np.array([0.75, 0.65, 1.3])
"""Range of log R/G, log B/G and log luminance of bare lips, less those of the skin: 10 and 90 % of
the pixels of 63 people's lips, of all tones, are inside it."""

_LIPS_WIDTH = np.array([0.1, 0.1, 0.3])

_BEARD_DARKNESS, _BEARD_ROUGHNESS = 0.4, 1.4
"""Least darkness (difference in log luminance) of a dense beard, and its least roughness relative
to the upper face. Of 63 people those with full beards have a roughness of 1.75 or more in the
median of the lower face, all others 1.25 or less. With the conditions below, 5 of 672 small
portraits without a beard there are taken for bearded."""

_LEAST_BEARD = 0.02
"""Least area of a beard inside the face, in areas of the face's box, a third of it on both sides,
and it covers half of the chin: the shadows of a nose and the folds of a smile do not."""

_EDGE_RADIUS, _EDGE_VARIANCE = 0.016, 3e-4
"""Radius and variance of the guided filter that finds the edge at full resolution."""

_Image = NDArray[np.float32]
_Mask = NDArray[np.bool_]


def segment_face_skin(photo: NDArray[np.uint8], landmarks: _Image, prior: _Image) -> _Image:
    """Segment the skin of a face, its ears and its neck.

    The coarse mask and the face's parts give odds of skin at each place. The colours of this
    person's skin, and those of what is certainly no skin in this picture, give odds for each
    colour. Highlights, moles and the shadow below the chin are filled. The edge follows the
    photograph. Eyes, brows, nostrils, the open mouth, dense beards, plain face masks and painted
    lips are left out.

    Args:
        photo: uint8 sRGB [H, W, 3] with the whole head.
        landmarks: The face's landmarks [478, 2], columns and rows in pixels of the photograph.
        prior: Coarse probability of skin, float32 [h, w] of any size, in [0, 1].

    Returns:
        Probability of skin, float32 [H, W] in [0, 1].
    """
    side = place_face(landmarks).side
    scale = min(1.0, _FACE_SIZE / max(side, 1.0))
    height, width = (max(1, round(length * scale)) for length in photo.shape[:2])
    small = resize(photo, width, height)
    points = landmarks * np.float32(scale)
    probability = _segment(small, points, resize(prior, width, height), side * scale)
    radius = max(1, round(_EDGE_RADIUS * side * scale))
    return enlarge_guided(photo, probability, radius, _EDGE_VARIANCE)


def _segment(photo: NDArray[np.uint8], points: _Image, prior: _Image, side: float) -> _Image:
    """Probability of skin at the size at which it is segmented."""
    zones = mark_zones(points, photo.shape)
    linear = srgb_to_linear(photo) + np.float32(1e-3)
    linear = ndimage.gaussian_filter(linear, (0.7, 0.7, 0))
    features = compute_features(linear)
    cover = find_cover(features[..., 2], zones, side)
    seeds = _choose_seeds(zones, prior * ~cover, side)
    if not seeds.any():
        return prior
    mean, covariance = fit_normal(features[seeds])
    distance = measure_distance(linear, mean, covariance + _SHADING)
    known = (prior < 0.1) & ~grow(zones.face | zones.neck, 0.05 * side)
    known |= grow(cover, -0.05 * side)
    evidence = compute_log_density(distance, covariance + _SHADING)
    evidence = evidence - estimate_log_density(features, known)
    hidden = cover | _find_beard(features[..., 2], zones, seeds, side)
    score = _judge_place(zones, prior, side) - 12 * _soften(hidden, 0.01 * side)
    score -= _judge_hair(_compare_nearby(features[..., 2], seeds, side), zones, side)
    score += _limit(evidence, features - mean, score, zones)
    score[zones.eyes | zones.mouth] = -8
    probability = (1 / (1 + np.exp(-score))).astype(np.float32)
    probability = filter_guided(make_guide(photo), probability, 2, 1e-3).clip(0, 1)
    own = _find_own(probability > 0.5, zones, prior, side)
    filled = fill_gaps(own, zones, features - mean, hidden, side)
    # Filled gaps overlap the skin around them, so that no seam is left.
    inside = _soften((own | filled) & grow(filled, 2.0), 0.7)
    whole = np.maximum(probability * grow(own, 2.0), inside).clip(0, 1)
    return np.where(zones.eyes | zones.mouth, np.float32(0), whole)


def _choose_seeds(zones: FaceZones, prior: _Image, side: float) -> _Mask:
    """Pixels that give the colours of this person's skin."""
    parts = grow(zones.eyes | zones.brows | zones.lips | zones.nostrils, 0.03 * side)
    bare = grow(zones.face, -0.04 * side) & ~parts
    seeds: _Mask = bare & (prior > 0.5)
    return seeds if seeds.sum() > 0.2 * bare.sum() else bare


def _judge_place(zones: FaceZones, prior: _Image, side: float) -> NDArray[Any]:
    """Log odds of skin by place: from the coarse mask and the parts of the face."""
    soft = ndimage.gaussian_filter(prior, 0.02 * side).clip(_LEAST_PRIOR, 1 - _LEAST_PRIOR)
    face, neck = (_soften(zone, 0.02 * side) for zone in (zones.face, zones.neck))
    odds = np.log(soft / (1 - soft)) + _NECK_ODDS * neck
    odds += face * np.where(zones.beard, _BEARD_ODDS, _FACE_ODDS)
    return np.where(zones.lips, _LIPS_ODDS, odds)


def _limit(
    evidence: NDArray[Any], difference: NDArray[Any], place: NDArray[Any], zones: FaceZones
) -> NDArray[Any]:
    """Limit the log odds of colours, and judge lips by their own."""
    limited = evidence.clip(_LEAST_EVIDENCE, _MOST_EVIDENCE)
    # Pixels on the edge of hair mix its colours with those of skin.
    limited = np.where(place > 0, limited, ndimage.minimum_filter(limited, 3))
    low, high = _LIPS
    beyond = np.maximum(difference - high, 0) + np.maximum(low - difference, 0)
    lips = 2 - 2 * np.minimum((beyond / _LIPS_WIDTH).sum(-1), 3)
    return np.where(zones.lips, lips, limited)


def _compare_nearby(log: NDArray[Any], seeds: _Mask, side: float) -> NDArray[Any]:
    """Log luminance of the skin nearby, less that of each pixel."""
    weight = ndimage.gaussian_filter(seeds.astype(np.float32), 0.06 * side)
    total = ndimage.gaussian_filter((seeds * log).astype(np.float32), 0.06 * side)
    nearby = np.where(weight > 0.01, total / np.maximum(weight, 0.01), log[seeds].mean())
    darkness: NDArray[Any] = nearby - log
    return darkness


def _judge_hair(darkness: NDArray[Any], zones: FaceZones, side: float) -> NDArray[Any]:
    """Log odds against skin in brows and nostrils, which are darker than the skin nearby."""
    brows = _soften(grow(zones.brows, 0.01 * side), 0.01 * side)
    odds = brows * (1.5 + 12 * (darkness - 0.15).clip(0, 0.5))
    odds += zones.nostrils * 8 * (darkness - 0.8).clip(0, 1)
    return np.asarray(odds)


def _find_beard(log: NDArray[Any], zones: FaceZones, seeds: _Mask, side: float) -> _Mask:
    """A beard so dense that hardly any skin is seen: it is dark, and rough."""
    blur, upper = ndimage.gaussian_filter, seeds & ~zones.beard
    if not upper.any():
        return np.zeros(log.shape, np.bool_)
    rough = np.sqrt(blur((blur(log, 0.7) - blur(log, 2.5)) ** 2, 0.03 * side))
    dark = np.median(log[upper]) - blur(log, 0.015 * side)
    area = (dark > _BEARD_DARKNESS) & (rough > _BEARD_ROUGHNESS * np.median(rough[upper]))
    area &= (zones.beard | zones.neck) & ~grow(zones.lips, 0.03 * side)
    area = ndimage.binary_opening(area, iterations=max(1, round(0.02 * side)))
    area &= ~keep_small(area, 0.5 * _LEAST_BEARD * side**2)
    inside = area & grow(zones.face, -0.06 * side)
    right = np.count_nonzero(inside & zones.right)
    both_sides = min(right, np.count_nonzero(inside) - right)
    is_on_chin = np.count_nonzero(area & zones.chin) > 0.5 * np.count_nonzero(zones.chin)
    if not is_on_chin or both_sides < _LEAST_BEARD * side**2 / 3:
        return np.zeros(log.shape, np.bool_)
    return grow(area, 0.01 * side)


def _find_own(skin: _Mask, zones: FaceZones, prior: _Image, side: float) -> _Mask:
    """The parts that belong to the face, and large ones that the coarse mask shows as well."""
    opened = ndimage.binary_opening(skin, iterations=max(1, round(0.01 * side)))
    labels, sizes = label_parts(opened)
    inside = np.bincount(labels[grow(zones.face, -0.02 * side)], minlength=len(sizes))
    sums = np.bincount(labels.ravel(), prior.ravel(), minlength=len(sizes))
    is_own = (inside > 0.002 * side**2) | ((sums > 0.5 * sizes) & (sizes > 0.003 * side**2))
    is_own[0] = False
    own: _Mask = is_own[labels]
    return own


def _soften(area: _Mask, width: float) -> _Image:
    return ndimage.gaussian_filter(area.astype(np.float32), width)
