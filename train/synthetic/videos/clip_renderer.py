"""Renders the frames of a synthetic video, with the true change of blood.

A head is cast once. It moves as a whole by a similarity of the picture, turns by its normals, so
that shading and gloss change, and bends by smooth displacements: no head is cast anew.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import torch
import torch.nn.functional as F
from jaxtyping import Float
from torch import Tensor

from skinnet.images import find_faces
from skinnet.images.faces._mesh_outlines import BROW
from skinnet.physics import SkinDecoder
from skinnet.video._regions import NAMES, mark_regions
from train.synthetic.labels import BACKGROUND, FILM, SKIN
from train.synthetic.painting.materials import OIL, colour_wall
from train.synthetic.painting.paintings import find_paintings
from train.synthetic.photography.renderer import (
    _expose,
    _paint,
    decode_normals,
    decode_sky_visibility,
)
from train.synthetic.photography.shading import Shading, shade
from train.synthetic.photography.simulated_camera import simulate_sensor, take_photograph
from train.synthetic.scene import CameraParameters, SceneParameters
from train.synthetic.tensors import expand_colour, normalise
from train.synthetic.videos.blood_course import BloodCourse, find_spread
from train.synthetic.videos.head_motion import HeadMotion, displace

_NODES = (-0.8, -0.4, 0.0, 0.4, 0.8)
"""Log changes of hemoglobin at which colours are computed; between them a cubic holds."""

_SAME_ANGLE = np.radians(0.03)
"""Angle in radians by which a head turns before it is shaded anew."""

_MOUTH = (61, 291, 13)
"""Landmarks of the corners of the mouth, and of its middle."""

Image = Float[Tensor, "1 channels height width"]


@dataclass(frozen=True)
class ClipSettings:
    """How a clip is made.

    Attributes:
        seconds: Its length.
        rate: Frames a second.
        size: Side of its square frames in pixels.
        noise: Standard deviation of the noise in display sRGB.
        face: Side of the face's box in sides of the frame.
    """

    seconds: float = 12.0
    rate: float = 30.0
    size: int = 320
    noise: float = 0.006
    face: float = 0.45


class ClipFrame(NamedTuple):
    """A frame and its truth.

    Attributes:
        time: In seconds.
        pixels: uint8 sRGB, [size, size, 3].
        change: True log ratio of the mean hemoglobin of each of `NAMES` to the face at rest.
    """

    time: float
    pixels: np.ndarray
    change: Float[np.ndarray, "regions"]


class ClipRenderer:
    """Renders one clip.

    Args:
        scene: A batch of one scene of the variety `mild`.
        decoder: Computes the colours of skin.
        course: How the blood changes.
        motion: How head and exposure change.
        settings: Length and size.
        seed: Seed of the noise.

    Raises:
        ValueError: No face is found in the first frame.
    """

    @torch.no_grad()
    def __init__(
        self,
        scene: SceneParameters,
        decoder: SkinDecoder,
        course: BloodCourse,
        motion: HeadMotion,
        settings: ClipSettings,
        seed: int,
    ) -> None:
        self.course, self.motion, self.settings = course, motion, settings
        self.scene = scene._replace(camera=_calm(scene.camera, settings.noise))
        self._noise = torch.Generator().manual_seed(seed)
        head, paintings = scene.head, find_paintings(scene.head.label)
        matrix, self.capture = simulate_sensor(scene.light, scene.camera, decoder.camera, "test")
        surface = _paint(scene, paintings, decoder, matrix)
        material = (head.label % FILM)[:, None]
        self._is_head = (material != BACKGROUND).float()
        self._skin = (material == SKIN).float()
        self._cover, self._other, self._bump = surface.cover, surface.other, surface.bump
        self._oil = torch.where(self._skin > 0, surface.oil, OIL[material.long()])
        self._white = expand_colour(matrix.sum(-2))
        self._wall = colour_wall(scene.surroundings, material.shape[-2:]) * self._white
        self._albedo = _fit_albedo(decoder, surface.melanin, surface.hemoglobin, matrix, scene)
        self._hemoglobin = surface.hemoglobin[0, 0].numpy()
        self.melanin = surface.melanin[0, 0].numpy()
        azimuth, elevation = np.moveaxis(head.chart[0].float().numpy(), -1, 0)
        self._event_spread, self._pulse_spread = find_spread(azimuth, elevation)
        self._normals = decode_normals(head.normal)
        self._sky = decode_sky_visibility(head.sky_visibility)
        self._shaded: tuple[Float[np.ndarray, 3], Shading] | None = None
        linear, share = self._light(0.0)
        self._gain = _expose(self.scene.camera, linear + (1 - self._is_head) * self._wall, share)
        self._find_face()

    @property
    def times(self) -> Float[np.ndarray, "frames"]:
        """Time stamps of all frames, in seconds."""
        count = round(self.settings.seconds * self.settings.rate)
        return np.arange(count) / self.settings.rate

    @property
    def resting_hemoglobin(self) -> float:
        """Mean hemoglobin of the face at rest."""
        return float(self._hemoglobin[self.regions[0]].mean())

    def __iter__(self) -> Iterator[ClipFrame]:
        for time in self.times.tolist():
            yield ClipFrame(time, self.render(time), self.true_change(time))

    def true_hemoglobin(self, time: float) -> Float[np.ndarray, "h w"]:
        """Volume fractions at a time over the head as it is cast; NaN where no skin is seen.

        `landmarks` are those of the face in that picture, in its pixels.
        """
        seen = (self._skin[0, 0].numpy() > 0) & (self._cover[0, 0].numpy() < 0.5)
        return np.where(seen, self._hemoglobin * np.exp(self._find_change(time)), np.nan)

    @property
    def chart(self) -> Float[np.ndarray, "h w 2"]:
        """Azimuth and elevation in radians of each pixel of the head as it is cast."""
        return self.scene.head.chart[0].float().numpy()

    def true_change(self, time: float) -> Float[np.ndarray, "regions"]:
        """Log ratio of the mean hemoglobin of the regions at a time to that of the face at rest."""
        factor = np.exp(self._find_change(time))
        return np.array(
            [
                np.log((self._hemoglobin * factor)[mask].mean() / self._hemoglobin[mask].mean())
                if mask.any()
                else np.nan
                for mask in self.regions
            ]
        )

    @torch.no_grad()
    def render(self, time: float) -> np.ndarray:
        """Render the frame at a time, uint8 sRGB [size, size, 3]."""
        linear, _ = self._light(time)
        moved = self._move(torch.cat([linear, self._is_head], 1), time)
        wall = F.interpolate(self._wall, moved.shape[-2:], mode="bilinear", align_corners=False)
        whole = moved[:, :3] + (1 - moved[:, 3:]) * wall
        gain = self._gain * float(np.exp(self.motion.gain(time)))
        grain = torch.randn(whole.shape, generator=self._noise)
        camera = self.scene.camera._replace(grain=grain)
        display = take_photograph(camera, gain * whole)
        return (255 * display[0]).round().to(torch.uint8).movedim(0, -1).contiguous().numpy()

    def _find_change(self, time: float) -> Float[np.ndarray, "h w"]:
        now = np.array([time])
        event, beat = float(self.course.event(now)[0]), float(self.course.beats(now)[0])
        return event * self._event_spread + beat * self._pulse_spread

    def _light(self, time: float) -> tuple[Image, Image]:
        """Linear light of the head at rest in place, and the share of skin."""
        change = torch.from_numpy(self._find_change(time)).float()
        powers = torch.stack([change**power for power in range(self._albedo.shape[0])])
        albedo = torch.einsum("phw,pchw->chw", powers, self._albedo)[None].exp()
        shading = self._shade(time)
        share = self._skin * (1 - self._cover)
        lit = share * (albedo * shading.diffuse + shading.specular * self._white)
        other = (self._other * shading.diffuse + shading.specular) * self._white
        return self._is_head * (lit + (1 - share) * other), share

    def _shade(self, time: float) -> Shading:
        angles = self.motion.pose(time)[3:]
        if self._shaded is not None and np.abs(angles - self._shaded[0]).max() < _SAME_ANGLE:
            return self._shaded[1]
        turned = _rotate(self._normals, *angles.tolist())
        normal = normalise(turned + self._skin * F.pad(self._bump, (0, 0, 0, 0, 0, 1)))
        scene = self.scene
        shading = shade(
            scene.light,
            scene.face.skin.specular,
            normal,
            self._sky,
            scene.head.visibility_mask,
            self._oil,
        )
        self._shaded = angles, shading
        return shading

    def _move(self, image: Image, time: float) -> Image:
        """Move and bend a picture of the head."""
        right, down, scale, roll, yaw, pitch = self.motion.pose(time)
        size, side = self.settings.size, image.shape[-1]
        line = (np.arange(size) + 0.5) / size
        points = np.stack(np.meshgrid(line, line), -1) - 0.5 - (right, down)
        points = points / self._zoom
        cos, sin = np.cos(roll) / np.exp(scale), np.sin(roll) / np.exp(scale)
        turned = points @ np.array([[cos, -sin], [sin, cos]])
        # A head that turns is seen narrower, as an ellipsoid's front is.
        turned = turned / (np.cos(yaw), np.cos(pitch)) + self._centre
        places, expression = turned * side, self.motion.expression(time)
        if expression.any():
            places = displace(places, expression, *self._mouth)
        grid = torch.from_numpy(2 * places / side - 1).float()[None]
        return F.grid_sample(image, grid, align_corners=False, padding_mode="border")

    def _find_face(self) -> None:
        """Where the regions and the mouth are in the picture at rest."""
        self._mouth, self._zoom, self._centre = (np.zeros((4, 2)), 1.0), 1.0, np.full(2, 0.5)
        frame = self.render(0.0)
        faces = find_faces(frame)
        if not faces:
            raise ValueError("No face is found in the first frame.")
        face = max(faces, key=lambda each: each.box.width)
        side = self._skin.shape[-1]
        scale = side / self.settings.size
        self.landmarks = landmarks = face.landmarks * scale
        mouth = np.stack([*landmarks[list(_MOUTH)], landmarks[BROW]])
        self._mouth = (mouth.astype(np.float64), face.box.width * scale)
        size, box = self.settings.size, face.box
        self._zoom = max(1.0, self.settings.face * size / box.width)
        self._centre = np.array([box.left + box.right, box.top + box.bottom]) / (2 * size)
        self.regions = mark_regions(landmarks, side) & (self._skin[0, 0].numpy() > 0)
        self.regions &= self._cover[0, 0].numpy() < 0.5
        assert len(self.regions) == len(NAMES)


def _calm(camera: CameraParameters, noise: float) -> CameraParameters:
    """A camera without compression of its own, mirror or blur of movement, and with some noise."""
    spread = torch.full_like(camera.noise, noise) * torch.tensor([1.0, 0.5])
    return camera._replace(
        quality=torch.zeros_like(camera.quality),
        mirror=torch.zeros_like(camera.mirror),
        noise=spread,
    )


def _fit_albedo(
    decoder: SkinDecoder, melanin: Image, hemoglobin: Image, matrix: Tensor, scene: SceneParameters
) -> Float[Tensor, "powers 3 height width"]:
    """Coefficients of log albedo as a cubic in the log change of hemoglobin."""
    varied = any(bool(one.any()) for one in scene.face.skin.nuisance)
    nuisance = scene.face.skin.nuisance if varied else None
    nodes = torch.tensor(_NODES, dtype=torch.float64)
    logs = torch.stack(
        [
            decoder.albedo(melanin[:, 0], hemoglobin[:, 0] * float(np.exp(node)), matrix, nuisance)
            .clamp_min(1e-4)
            .log()[0]
            for node in _NODES
        ]
    )
    design = torch.stack([nodes**power for power in range(4)], 1)
    solved = torch.linalg.pinv(design).float()
    return torch.einsum("pn,nchw->pchw", solved, logs)


def _rotate(normals: Image, roll: float, yaw: float, pitch: float) -> Image:
    """Turn unit normals [1, 3, h, w] in the camera's axes: right, up, towards it."""
    around_y = np.array([[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]])
    around_x = np.array(
        [[1, 0, 0], [0, np.cos(pitch), -np.sin(pitch)], [0, np.sin(pitch), np.cos(pitch)]]
    )
    around_z = np.array(
        [[np.cos(roll), np.sin(roll), 0], [-np.sin(roll), np.cos(roll), 0], [0, 0, 1]]
    )
    matrix = torch.from_numpy(around_z @ around_x @ around_y).to(normals)
    return torch.einsum("ij,bjhw->bihw", matrix, normals)
