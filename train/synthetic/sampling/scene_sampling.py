"""Random scenes: a face, what surrounds it, the light and the camera."""

import numpy as np
import torch
from jaxtyping import Float

from skinnet.physics import LIGHTS
from train.synthetic.labels import FILM, SKIN
from train.synthetic.sampling.face_sampling import sample_face
from train.synthetic.sampling.style_sampling import vary_surroundings
from train.synthetic.sampling.wide_captures import (
    make_no_processing,
    make_nothing_known,
    widen_camera,
    widen_light,
)
from train.synthetic.scene import (
    LAMPS,
    SOURCES,
    CameraParameters,
    FaceParameters,
    HeadBuffers,
    LightParameters,
    SceneParameters,
    SurroundingsParameters,
    map_tensors,
)
from train.synthetic.tensors import make_tensors
from train.synthetic.variety import Captures, Variety

WHITE_BALANCE_SD = 0.03
"""Standard deviation of the log error of a camera's gains of red and of blue."""

RANDOMISED_OIL = 0.35
"""Mean logarithm of the factor on the oil of domain-randomised skin."""


def sample_scene(
    rng: np.random.Generator,
    head: HeadBuffers,
    domain_randomised: bool = False,
    variety: Variety = "mild",
    captures: Captures = "mild",
) -> SceneParameters:
    """Sample all that is needed for one picture of a head.

    Args:
        rng: Random numbers; the same state gives the same scene.
        head: Buffers of a square picture, without a batch axis.
        domain_randomised: Whether to widen the range of skin for training: melanin up to a fraction
            of .33 instead of .25, and oil times the exponential of an exponential variate of mean
            .35.
        variety: Which kind of faces.
        captures: Which kind of lights and cameras.

    Returns:
        Parameters in float32.
    """
    face = sample_face(rng, domain_randomised, variety)
    surroundings, light = _sample_surroundings(rng), sample_light(rng)
    camera = sample_camera(rng, head.label.shape[-1])
    person = _finish_person(rng, face, surroundings, domain_randomised, variety)
    if captures == "wide":
        light, camera = widen_light(light, rng), widen_camera(camera, rng)
    return SceneParameters(head, *person, light, camera)


Person = tuple[FaceParameters, SurroundingsParameters]
"""A face, and the clothes of a person with the wall that would be behind them."""


def sample_person(
    rng: np.random.Generator, domain_randomised: bool = False, variety: Variety = "any"
) -> Person:
    """Sample one more person for a scene, who has the scene's light and camera.

    Args:
        rng: Random numbers.
        domain_randomised: As in `sample_scene`.
        variety: Which kind of faces.

    Returns:
        Face and surroundings in float32.
    """
    face = sample_face(rng, domain_randomised, variety)
    return _finish_person(rng, face, _sample_surroundings(rng), domain_randomised, variety)


def _finish_person(
    rng: np.random.Generator,
    face: FaceParameters,
    surroundings: SurroundingsParameters,
    domain_randomised: bool,
    variety: Variety,
) -> Person:
    if domain_randomised:
        face = _add_oil(face, float(np.exp(rng.exponential(RANDOMISED_OIL))))
    if variety == "any":
        surroundings = vary_surroundings(surroundings, rng)
    return map_tensors(torch.Tensor.float, face), map_tensors(torch.Tensor.float, surroundings)


def _add_oil(face: FaceParameters, factor: float) -> FaceParameters:
    specular = face.skin.specular._replace(oil=face.skin.specular.oil * factor)
    return face._replace(skin=face.skin._replace(specular=specular))


def _sample_surroundings(rng: np.random.Generator) -> SurroundingsParameters:
    tint = rng.choice([0.03, 0.3], p=(0.6, 0.4))
    jacket_tint = rng.choice([0.03, 0.5], p=(0.6, 0.4))
    return SurroundingsParameters(
        **make_tensors(
            wall=_sample_colour(rng, tint)[:, None, None]
            * np.exp(_sample_clutter(rng, 3) + rng.normal(0, 0.2, (1, 3, 3))),
            coarse_clutter=_sample_clutter(rng, 12),
            fine_clutter=_sample_clutter(rng, 40),
            wall_light=np.exp(rng.normal(-0.2, 0.5)),
            jacket=_sample_colour(rng, jacket_tint),
            shirt=_sample_colour(rng, 0.02) if rng.random() < 0.3 else (0.75, 0.75, 0.77),
            pattern=rng.choice([0.1, 0.3], p=(0.7, 0.3)) * _sample_clutter(rng, 40),
            tie=rng.choice([0.0, 1.0], p=(0.6, 0.4)),
            tie_colour=_sample_colour(rng, 0.8),
        )
    )


def _sample_clutter(rng: np.random.Generator, cells: int) -> Float[np.ndarray, "3 {cells} {cells}"]:
    """Log brightness of objects in the background, some of them coloured."""
    grey = rng.normal(0, 0.5, (1, cells, cells)) * rng.choice([0.03, 0.3, 1.0], p=(0.6, 0.25, 0.15))
    tint = rng.normal(0, 0.2, (3, cells, cells)) * rng.choice([0.03, 0.3, 1.0], p=(0.6, 0.25, 0.15))
    return np.asarray(grey + tint)


def _sample_colour(rng: np.random.Generator, spread: float) -> Float[np.ndarray, "3"]:
    grey = np.exp(rng.uniform(np.log(0.02), np.log(0.9)))
    return np.asarray((grey * np.exp(rng.normal(0, spread, 3))).clip(0.005, 1))


def sample_light(rng: np.random.Generator) -> LightParameters:
    """Sample a sky, one to three lamps, and the mixture of their spectra, in float32."""
    lamps = rng.normal((0, 0.5, 0.8), (0.7, 0.4, 0.3), (LAMPS, 3))
    shares = rng.dirichlet(np.ones(rng.integers(1, LAMPS + 1)))
    sky = rng.normal(0, 1, 9) * (0, 0.16, 0.14, 0.16, 0.05, 0.05, 0.05, 0.05, 0.05)
    sky[1] += 0.10  # more light from above
    daylight = np.eye(len(LIGHTS))[0]
    other = rng.dirichlet(np.full(len(LIGHTS) - 1, 0.4)) * rng.choice([0, rng.uniform(0, 0.4)])
    light = LightParameters(
        **make_tensors(
            sky=sky + np.r_[rng.uniform(0.25, 0.75), np.zeros(8)],
            lamps=lamps / np.linalg.norm(lamps, axis=1, keepdims=True),
            strength=np.r_[shares, np.zeros(LAMPS - len(shares))] * rng.uniform(0.15, 0.95),
            # From a bare flash to a window.
            softness=np.exp(rng.uniform(np.log(0.08), np.log(0.7), LAMPS)),
            mixture=daylight * (1 - other.sum()) + np.r_[0, other],
            temperature=1e6 / np.clip(rng.normal(172, 12), 120, 235),
            tints=np.zeros((SOURCES, 3)),
        )
    )
    return map_tensors(torch.Tensor.float, light)


def sample_camera(rng: np.random.Generator, size: int) -> CameraParameters:
    """Sample a camera for pictures of `size` x `size` pixels, in float32."""
    camera = CameraParameters(
        **make_tensors(
            sensor=rng.random(),
            white_balance=rng.normal(0, WHITE_BALANCE_SD, 2),
            exposure=np.exp(rng.normal(0, 0.5)),
            metering=rng.uniform(0, 0.7),
            tone=rng.normal((0, 0.12), (0.03, 0.15)),
            blur=rng.uniform(0.35, 1.1) * rng.choice([1, 1, 1, 2]),
            grain=rng.standard_normal((3, size, size), np.float32),
            noise=rng.uniform(0, 1, 2) ** 2 * (0.010, 0.012),
            quality=rng.choice([0, rng.uniform(35, 95)], p=(0.4, 0.6)),
            mirror=rng.integers(2),
            mired_error=0.0,
            linear=0.0,
        ),
        processing=make_no_processing(),
        known=make_nothing_known(),
    )
    return map_tensors(torch.Tensor.float, camera)


def meter_skin(camera: CameraParameters, head: HeadBuffers) -> CameraParameters:
    """Let a camera meter skin the more of the picture it fills, as cameras meter what they see.

    Args:
        camera: A camera of `sample_camera`.
        head: Buffers of a picture, without a batch axis.

    Returns:
        The camera with more metering and less error of exposure.
    """
    share = (head.label % FILM == SKIN).float().mean()
    return camera._replace(
        exposure=camera.exposure ** (1 - 0.5 * share),
        metering=camera.metering.lerp(torch.ones(()), share),
    )
