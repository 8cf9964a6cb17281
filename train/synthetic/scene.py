"""Parameters of the synthetic renderer for one picture, or for a batch of pictures.

All values are tensors. A sample has no batch axis; torch's default collate puts one in front.
"""

from collections.abc import Callable
from typing import NamedTuple, TypeVar

from jaxtyping import Float, Float16, Int8, Int64, UInt8
from torch import Tensor

from skinnet.physics import LIGHTS, Nuisance

CHART_SIZE = (168, 208)
"""Rows and columns of the charts that faces are painted on."""

REGIONS = 6
MOLES = 6
LAMPS = 3
SOURCES = 1 + LAMPS
"""The sky and the lamps."""

MIXTURE = len(LIGHTS)
GARMENTS = 3
"""Cloth with colours of its own: headwear, face masks and scarves."""


class HeadBuffers(NamedTuple):
    """The surface of a head under each pixel, without any light.

    `label` is one of `train.synthetic.labels`. `normal` is in the camera's axes (right, up, towards
    it) times 127. `chart` is the place on the label's chart. `sky_visibility` is the share of the
    cosine-weighted sky that nothing hides, times 255. Bit k of `visibility_mask` is set where
    nothing stands between the surface and `LIGHT_DIRECTIONS[k]`; it is not set where the surface
    faces away from it. All bits of the background are set.
    """

    label: UInt8[Tensor, "*batch height width"]
    normal: Int8[Tensor, "*batch height width 3"]
    chart: Float16[Tensor, "*batch height width 2"]
    sky_visibility: UInt8[Tensor, "*batch height width"]
    visibility_mask: Int64[Tensor, "*batch height width"]


class PigmentParameters(NamedTuple):
    """How one pigment is spread over a face.

    `fraction` is a volume fraction; all other fields are natural logarithms of factors on it. They
    belong to the six regions of `train.synthetic.painting.face_painting`, to noise of three
    octaves, and to `model_skin`, the chart of a skin of a hybrid model, which is 0 without one.
    """

    fraction: Float[Tensor, "*batch"]
    regions: Float[Tensor, "*batch {REGIONS}"]
    coarse: Float[Tensor, "*batch 1 8 10"]
    middle: Float[Tensor, "*batch 1 24 30"]
    fine: Float[Tensor, "*batch 1 84 104"]
    model_skin: Float[Tensor, "*batch 1 rows columns"]


class SpecularParameters(NamedTuple):
    """How much oil lies on the skin, relative to a median face, and the roughness of its lobe."""

    oil: Float[Tensor, "*batch"]
    roughness: Float[Tensor, "*batch"]


class SkinParameters(NamedTuple):
    """The skin itself.

    `has_model_skin` is 1 where the pigments include a skin of a hybrid model, otherwise 0. `bump`
    holds the gradients of the skin's relief to the right and upwards. `nuisance` is what the skin
    has besides pigments; zero is the preset's skin.
    """

    melanin: PigmentParameters
    hemoglobin: PigmentParameters
    has_model_skin: Float[Tensor, "*batch"]
    bump: Float[Tensor, "*batch 2 rows columns"]
    specular: SpecularParameters
    nuisance: Nuisance


class MarkParameters(NamedTuple):
    """Natural logarithms of factors of melanin (freckles, moles) and hemoglobin (spots, vessels).

    Of each mole: azimuth, elevation, radius and log factor, which is 0 for moles that are absent.
    """

    freckles: Float[Tensor, "*batch 1 120 150"]
    spots: Float[Tensor, "*batch 1 60 74"]
    vessels: Float[Tensor, "*batch 1 56 70"]
    moles: Float[Tensor, "*batch {MOLES} 4"]


class BeardParameters(NamedTuple):
    """Opacity of beard and stubble, whether the moustache grows too, and noise over the chart."""

    beard: Float[Tensor, "*batch"]
    moustache: Float[Tensor, "*batch"]
    stubble: Float[Tensor, "*batch"]
    grain: Float[Tensor, "*batch 1 rows columns"]


class HairParameters(NamedTuple):
    """Hair of head, brows, lashes and beard, all of one `colour` (linear sRGB).

    `strands` is log brightness around the head; `brow` and `lashes` are opacities; `brow_shape` is
    what is added to the brow's height, slope and thickness.
    """

    colour: Float[Tensor, "*batch 3"]
    strands: Float[Tensor, "*batch 1 16 110"]
    brow: Float[Tensor, "*batch"]
    brow_shape: Float[Tensor, "*batch 3"]
    lashes: Float[Tensor, "*batch"]
    beard: BeardParameters


class FeatureParameters(NamedTuple):
    """Colours (linear sRGB) of eyes, teeth, glasses and lipstick; `make_up` is its opacity."""

    iris: Float[Tensor, "*batch 3"]
    sclera: Float[Tensor, "*batch 3"]
    teeth: Float[Tensor, "*batch 3"]
    glasses: Float[Tensor, "*batch 3"]
    make_up: Float[Tensor, "*batch"]
    lipstick: Float[Tensor, "*batch 3"]


class BeardStyleParameters(NamedTuple):
    """Beard and stubble of the variety `any`.

    `parts` are the shares in [0, 1] of cheeks, chin, moustache and the bridge between them.
    `cheek_line` is added to the height of the beard's upper edge in radians. `beard` and `stubble`
    are opacities; stubble grows where a full beard would. `edge` and `hairs` are standard normal
    noise: the one moves the edges, the other makes hairs.
    """

    parts: Float[Tensor, "*batch 4"]
    cheek_line: Float[Tensor, "*batch"]
    beard: Float[Tensor, "*batch"]
    stubble: Float[Tensor, "*batch"]
    colour: Float[Tensor, "*batch 3"]
    edge: Float[Tensor, "*batch 1 edge_rows edge_columns"]
    hairs: Float[Tensor, "*batch 1 hair_rows hair_columns"]


class CosmeticParameters(NamedTuple):
    """Make-up, face paint and a plaster of the variety `any`.

    `foundation` is the share in [0, 1] of the pigments' structure that make-up evens out, and
    `foundation_tone` the log factor on melanin that it seems to add. All other numbers are
    opacities, and all colours are linear sRGB. `paint_noise` is standard normal: paint lies where
    it is positive. `plaster` holds azimuth, elevation, angle, half length and half width in
    radians.
    """

    foundation: Float[Tensor, "*batch"]
    foundation_tone: Float[Tensor, "*batch"]
    blush: Float[Tensor, "*batch"]
    blush_colour: Float[Tensor, "*batch 3"]
    eye_shadow: Float[Tensor, "*batch"]
    eye_shadow_colour: Float[Tensor, "*batch 3"]
    eyeliner: Float[Tensor, "*batch"]
    paint: Float[Tensor, "*batch"]
    paint_colour: Float[Tensor, "*batch 3"]
    paint_noise: Float[Tensor, "*batch 1 rows columns"]
    plaster: Float[Tensor, "*batch 5"]
    plaster_opacity: Float[Tensor, "*batch"]
    plaster_colour: Float[Tensor, "*batch 3"]


class GarmentParameters(NamedTuple):
    """Colours and patterns of headwear, face masks and scarves, and of dark lenses.

    `colours` (linear sRGB) are two of each garment. Its pattern mixes them by two waves and by
    noise: `waves` holds radians of phase over one unit of the chart and the phase, `amounts` the
    weights of both waves and of noise. `own_skin` is 1 for cloth of the colour of the wearer's
    skin. `mirror` in [0, 1] is how much a dark lens reflects, and `reflection` how bright a
    window is in a clear one.
    """

    colours: Float[Tensor, "*batch {GARMENTS} 2 3"]
    waves: Float[Tensor, "*batch {GARMENTS} 2 3"]
    amounts: Float[Tensor, "*batch {GARMENTS} 3"]
    noise: Float[Tensor, "*batch {GARMENTS} rows columns"]
    own_skin: Float[Tensor, "*batch {GARMENTS}"]
    lens: Float[Tensor, "*batch 3"]
    mirror: Float[Tensor, "*batch"]
    reflection: Float[Tensor, "*batch"]


class FaceParameters(NamedTuple):
    """All that is painted on a head. The last three records are 0 for the variety `mild`."""

    skin: SkinParameters
    marks: MarkParameters
    hair: HairParameters
    features: FeatureParameters
    beard_style: BeardStyleParameters
    cosmetics: CosmeticParameters
    garments: GarmentParameters


class SurroundingsParameters(NamedTuple):
    """The wall behind the head, and clothes.

    Colours are linear sRGB, `wall` at 3 x 3 places. `coarse_clutter`, `fine_clutter` and `pattern`
    are log brightness of the wall and of the clothes. `tie` is 1 for a tie, otherwise 0.
    """

    wall: Float[Tensor, "*batch 3 3 3"]
    coarse_clutter: Float[Tensor, "*batch 3 12 12"]
    fine_clutter: Float[Tensor, "*batch 3 40 40"]
    wall_light: Float[Tensor, "*batch"]
    jacket: Float[Tensor, "*batch 3"]
    shirt: Float[Tensor, "*batch 3"]
    pattern: Float[Tensor, "*batch 3 40 40"]
    tie: Float[Tensor, "*batch"]
    tie_colour: Float[Tensor, "*batch 3"]


class LightParameters(NamedTuple):
    """A sky, some lamps, and the one spectrum of all of them.

    `sky` holds coefficients of nine spherical harmonics, `lamps` unit directions in the camera's
    axes, `strength` their irradiance, `softness` the half widths of the lamps in radians. `mixture`
    holds weights of the light sources `LIGHTS`, `temperature` that of daylight in kelvin. `tints`
    are log factors on linear sRGB of the sky, in the first row, and of each lamp.
    """

    sky: Float[Tensor, "*batch 9"]
    lamps: Float[Tensor, "*batch {LAMPS} 3"]
    strength: Float[Tensor, "*batch {LAMPS}"]
    softness: Float[Tensor, "*batch {LAMPS}"]
    mixture: Float[Tensor, "*batch {MIXTURE}"]
    temperature: Float[Tensor, "*batch"]
    tints: Float[Tensor, "*batch {SOURCES} 3"]


class ProcessingParameters(NamedTuple):
    """What is done to a photograph after its tone curve; all is zero for mild captures.

    `flare` is linear light that is added everywhere. `saturation` is a log factor on the distance
    from grey, and `toning` holds log factors on R, G and B of shadows, in the first row, and of
    highlights. `reduction` is the natural logarithm by which the picture was once smaller, and
    `sharpening` the share of fine detail that is added.
    """

    flare: Float[Tensor, "*batch"]
    saturation: Float[Tensor, "*batch"]
    toning: Float[Tensor, "*batch 2 3"]
    reduction: Float[Tensor, "*batch"]
    sharpening: Float[Tensor, "*batch"]


class KnownParameters(NamedTuple):
    """What a network may know of a capture: 1 for what it knows, otherwise 0.

    `white` is the colour of a white or grey reference, of the given `reflectance`, and `exposure`
    its brightness. `white_error` is the error of its log R/G and log B/G, and `light_error` the log
    factor on the light that falls on it instead of on the skin.
    """

    white: Float[Tensor, "*batch"]
    light: Float[Tensor, "*batch"]
    temperature: Float[Tensor, "*batch"]
    camera: Float[Tensor, "*batch"]
    linear: Float[Tensor, "*batch"]
    exposure: Float[Tensor, "*batch"]
    reflectance: Float[Tensor, "*batch"]
    white_error: Float[Tensor, "*batch 2"]
    light_error: Float[Tensor, "*batch"]


class CameraParameters(NamedTuple):
    """A camera from its sensor to the file.

    `sensor` in [0, 1] picks one of the measured cameras. `white_balance` is the log error of red
    and blue. `exposure` is a factor, `metering` the share in [0, 1] of the correction that a meter
    on the skin would make. `tone` holds log contrast and bend of the tone curve. `blur` is the
    standard deviation in pixels of a picture 192 pixels wide. `noise` holds standard deviations in
    white and added towards black, `grain` the standard normal field that they scale. `quality` is
    that of JPEG, 0 for no compression. `mirror` is 1 for pictures that are mirrored. `mired_error`
    is the error in mired of the white that the camera assumes, beside `white_balance`. `linear` is
    1 for a picture in linear light, without tone curve or processing.
    """

    sensor: Float[Tensor, "*batch"]
    white_balance: Float[Tensor, "*batch 2"]
    exposure: Float[Tensor, "*batch"]
    metering: Float[Tensor, "*batch"]
    tone: Float[Tensor, "*batch 2"]
    blur: Float[Tensor, "*batch"]
    grain: Float[Tensor, "*batch 3 height width"]
    noise: Float[Tensor, "*batch 2"]
    quality: Float[Tensor, "*batch"]
    mirror: Float[Tensor, "*batch"]
    mired_error: Float[Tensor, "*batch"]
    linear: Float[Tensor, "*batch"]
    processing: ProcessingParameters
    known: KnownParameters


class SceneParameters(NamedTuple):
    """A head and all that is sampled for one picture of it."""

    head: HeadBuffers
    face: FaceParameters
    surroundings: SurroundingsParameters
    light: LightParameters
    camera: CameraParameters


Record = TypeVar("Record", bound=NamedTuple)


def map_tensors(function: Callable[[Tensor], Tensor], record: Record) -> Record:
    """Apply a function to every tensor of a record and of the records in it.

    Args:
        function: Function of one tensor.
        record: Any record of this module.

    Returns:
        A record of the same type.

    Example:
        >>> import torch
        >>> specular = SpecularParameters(torch.tensor(1.0), torch.tensor(0.4))
        >>> map_tensors(lambda value: 2 * value, specular).oil
        tensor(2.)
    """
    return record._make(
        function(value) if isinstance(value, Tensor) else map_tensors(function, value)
        for value in record
    )
