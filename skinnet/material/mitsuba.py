"""Skin, a light and a camera for scenes of the spectral renderer Mitsuba 3."""

from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from skinnet.errors import InputError, _explain_missing
from skinnet.material._offset_spectra import compute_offset_spectra
from skinnet.physics.camera import _balance
from skinnet.physics.sources import load_camera, load_light, load_spectrum_to_srgb
from skinnet.physics.spectra import WAVELENGTHS, load_observer

_HALF = 5.0
"""Half of the width of a band in nm."""

_EDGE = 1e-3
"""Distance in nm between the two samples at the border of two bands, where a spectrum steps."""

_CHANNELS = "RGB"


class MitsubaCapture:
    """A light and a camera as parts of a Mitsuba scene, with skin as its texture.

    Mitsuba traces light at single wavelengths. It knows nothing of our `SpectralCamera`, so that
    its pictures are an independent check of the paper's equation 1. The parts are dictionaries for
    `mitsuba.load_dict`. A spectral variant must be set first: scalar_spectral needs nothing else.
    The variants that compile, such as cuda_ad_spectral, are faster where they run.

    Args:
        light: Name or file of the light, as of `load_light`.
        camera: Name or file of the camera, as of `load_camera`.

    Raises:
        InputError: Mitsuba is missing, no spectral variant is set, or `load_light` or `load_camera`
            refuse a name.

    Source:
        Equations 1 and 4 of Alotaibi & Smith 2017.

    Example:
        >>> import mitsuba as mi
        >>> mi.set_variant("scalar_spectral")
        >>> from skinnet.material import MitsubaCapture
        >>> capture = MitsubaCapture("FL11", "Nikon D200")
        >>> grey = {"type": "diffuse", "reflectance": {"type": "uniform", "value": 0.5}}
        >>> scene = mi.load_dict(
        ...     {
        ...         "type": "scene",
        ...         "integrator": {"type": "direct"},
        ...         "sensor": {"type": "orthographic", "film": capture.film(4, 4)},
        ...         "light": {"type": "constant", "radiance": capture.light()},
        ...         "wall": {"type": "sphere", "center": [0, 0, 5], "radius": 3, "bsdf": grey},
        ...     }
        ... )
        >>> linear = capture.develop(mi.render(scene, spp=64, seed=1))
        >>> linear.mean((0, 1)).round(1).tolist()
        [0.5, 0.5, 0.5]
    """

    def __init__(self, light: str | Path = "D65", camera: str | Path = "mean") -> None:
        self._mitsuba = _import_mitsuba()
        power, curves = load_light(light), load_camera(camera)
        self._power = (power / power.mean()).numpy()
        self._curves = curves.numpy()
        self._white = 2 * _HALF * self._power @ self._curves
        self._to_srgb = _balance(power, curves, load_observer())[1].numpy()

    def light(self, radiance: float = 1.0) -> dict[str, Any]:
        """Make the spectrum of an emitter.

        Args:
            radiance: 1 makes a white diffuser (1, 1, 1) in the developed picture if light of this
                radiance comes from all around. An irradiance of pi does the same.

        Returns:
            The spectrum. Power is constant within each band of 10 nm, whose average it is.
        """
        return _make_spectrum(radiance * self._power)

    def film(self, height: int, width: int) -> dict[str, Any]:
        """Make a film with the camera's sensitivities, which records what its sensor records.

        Args:
            height: Rows of the picture.
            width: Columns of the picture.

        Returns:
            The film, with the channels R, G and B of the sensor.
        """
        curves = {
            name: _make_spectrum(curve)
            for name, curve in zip(_CHANNELS, self._curves.T, strict=True)
        }
        return {
            "type": "specfilm",
            "height": height,
            "width": width,
            "component_format": "float32",
            "rfilter": {"type": "box"},
            **curves,
        }

    def develop(self, raw: Any) -> Float[np.ndarray, "height width 3"]:
        """Develop what the film has recorded: white balance, and the camera's colour matrix.

        Args:
            raw: The result of `mitsuba.render`.

        Returns:
            Linear sRGB, not clipped, as `SpectralCamera` gives it.

        Raises:
            InputError: If the picture has other than three channels.
        """
        values = np.array(raw, np.float64)
        if values.ndim != 3 or values.shape[2] != 3:
            raise InputError(
                f"A picture of three channels is developed; got the shape {values.shape}. Give the "
                "sensor the film of MitsubaCapture.film."
            )
        return np.asarray(values / self._white @ self._to_srgb)

    def skin(
        self,
        f_mel: Float[np.ndarray, "_ _"] | float,
        f_blood: Float[np.ndarray, "_ _"] | float,
        offset: Float[np.ndarray, "_ _ 3"] | None = None,
        matrix: Float[np.ndarray, "wavelength 3"] | None = None,
        optics: str = "measured",
    ) -> dict[str, Any]:
        """Make the reflectance of skin, for the parameters of any BSDF that take a texture.

        It is the plug-in `skin`, which is registered for the variant that is set. In a scene of
        your own it takes the textures `melanin` and `hemoglobin`, volume fractions that are read as
        plain numbers (`raw` is true), optionally `offset`, a plain texture of three channels, and
        the string `optics`. Between two bands its spectrum is interpolated, beyond 400 and 720 nm
        it is constant.

        Args:
            f_mel: Volume fraction of melanosomes in [0, 1]; a map with row 0 at the top, or one
                number for all of the surface.
            f_blood: Volume fraction of blood in [0, 1].
            offset: Linear RGB that pigments do not explain, such as lips and brows. It gets the
                smoothest spectrum of its colour.
            matrix: Maps a spectrum to linear RGB under the light and camera for which the offset
                holds, e.g. that of `SkinColour`; None: D65 and the mean camera.
            optics: Name of a `SkinOptics` preset.

        Returns:
            The texture.

        Raises:
            InputError: For maps of different sizes, or a fraction that is not in [0, 1].
        """
        from skinnet.material._mitsuba_texture import PLUGIN, register

        maps = _check_maps(f_mel, f_blood, offset)
        register(self._mitsuba.variant())
        parts = {name: self._make_texture(values) for name, values in maps.items()}
        if offset is not None:
            if matrix is None:
                matrix = load_spectrum_to_srgb("D65", "mean").numpy()
            spectra = compute_offset_spectra(matrix).ravel()
            parts["offset_spectra"] = ",".join(f"{one:.9g}" for one in spectra)
        return {"type": PLUGIN, "optics": optics, **parts}

    def _make_texture(self, values: Float[np.ndarray, "height width channels"]) -> Any:
        if values.size == 1:
            return float(values.item())
        tensor = self._mitsuba.TensorXf(np.ascontiguousarray(values, np.float32))
        return {"type": "bitmap", "data": tensor, "raw": True, "wrap_mode": "clamp"}


def _import_mitsuba() -> Any:
    """Import Mitsuba, and refuse to go on without a spectral variant."""
    try:
        import mitsuba
    except ImportError as error:
        raise _explain_missing(error, "mitsuba", "Spectral rendering") from error
    if (variant := mitsuba.variant()) is None or "spectral" not in variant:
        raise InputError(
            f"Skin is rendered by a spectral variant of Mitsuba; {variant or 'none'} is set. Call "
            'mitsuba.set_variant("scalar_spectral") first.'
        )
    return mitsuba


def _make_spectrum(values: Float[np.ndarray, "wavelength"]) -> dict[str, Any]:
    """Make a spectrum that is constant within each band, and 0 beyond the outermost."""
    middles = WAVELENGTHS.numpy()
    edges = np.stack([middles - _HALF + _EDGE / 2, middles + _HALF - _EDGE / 2], 1)
    samples = {"wavelengths": edges.ravel(), "values": np.repeat(values, 2)}
    text = {name: ",".join(f"{one:.9g}" for one in part) for name, part in samples.items()}
    return {"type": "irregular", **text}


def _check_maps(f_mel: Any, f_blood: Any, offset: Any) -> dict[str, Float[np.ndarray, "_ _ _"]]:
    """Check the maps, and give each its axis of channels."""
    maps = {"melanin": np.asarray(f_mel), "hemoglobin": np.asarray(f_blood)}
    for name, values in maps.items():
        if not ((values >= 0) & (values <= 1)).all():
            worst = values.ravel()[np.abs(np.nan_to_num(values, nan=np.inf) - 0.5).argmax()]
            raise InputError(
                f"{name} is a volume fraction in [0, 1]; got {worst:g}. Was it given in percent?"
            )
    if offset is not None:
        maps["offset"] = np.asarray(offset)
    sizes = {name: values.shape[:2] for name, values in maps.items() if values.ndim}
    if len(set(sizes.values())) > 1:
        listed = ", ".join(f"{name} {' x '.join(map(str, size))}" for name, size in sizes.items())
        raise InputError(f"Maps of one surface have one size; got {listed}. Resize them first.")
    return {
        name: values.reshape(*(values.shape[:2] or (1, 1)), -1) for name, values in maps.items()
    }
