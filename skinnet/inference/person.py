"""Several shots of one person, read as one."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from skinnet._version import __version__
from skinnet.errors import InputError
from skinnet.images._arguments import check_text
from skinnet.images.faces._face_regions import REGION_NAMES
from skinnet.inference._agreement import (
    describe_outlier,
    find_outlier,
    fuse_shots,
    note_disagreement,
    note_sessions,
    number_sessions,
)
from skinnet.inference._decomposition.summary import round_all
from skinnet.inference._fused_pigment import FusedPigment, FusedRegion, make_pigment
from skinnet.inference._fusion import SHARED, Fusion
from skinnet.inference._index_summary import SkinIndices
from skinnet.inference._person_shot import PersonShot, describe_shot
from skinnet.inference._uncertainty import (
    LEVEL,
    PIGMENTS,
    describe_mean,
    find_factor,
    find_interval,
    summarise_mean,
)
from skinnet.inference.decomposition import Decomposition
from skinnet.inference.indices import _find_indices


@dataclass(frozen=True, eq=False, repr=False)
class Person:
    """Melanin and hemoglobin of one person, fused from several shots by their uncertainty.

    Logarithms of fractions are averaged with their inverse variances as weights. Errors of all
    shots of a person have something in common, so that they are correlated. Shots of one session,
    in which the skin has one colour, are taken to err wholly alike: together they are no surer than
    one. If shots differ more than they state, by Cochran's Q, the standard deviation is multiplied
    by Birge's ratio. One shot that is plainly unlike all others is left out. It is the skin that is
    compared, not the face: two people of like skin are not told apart.

    Attributes:
        pigments: `melanin` and `hemoglobin` of the whole skin, each with `mean`, `sd`, the 90 %
            `interval`, the number of `shots`, and their `agreement`: `q`, `degrees_of_freedom`, `p`
            and `birge_ratio`.
        regions: The same of each region of the face, such as `regions["nose"].melanin.mean`, and
            its `indices`; None where no shot shows it. Empty if no face was looked for.
        shots: Names of the shots.
        sessions: Number of the session of each of them, from 1; None for those that were left out.
        notes: Sentences that the user should read.

    Example:
        >>> from skimage.data import astronaut
        >>> from skinnet import Decomposer
        >>> from skinnet.inference import Person
        >>> read, photo = Decomposer(threads=1), astronaut()
        >>> person = Person.from_shots(read(each, detail=False) for each in (photo, photo[:, ::-1]))
        >>> person.sessions  # one light and camera: together they are no surer than one
        (1, 1)
        >>> person.pigments["melanin"].agreement.p > 0.05
        True
    """

    pigments: dict[str, FusedPigment]
    regions: dict[str, FusedRegion]
    shots: tuple[str, ...]
    sessions: tuple[int | None, ...]
    notes: tuple[str, ...]
    _read: tuple[PersonShot, ...]

    @classmethod
    def from_shots(
        cls, shots: Iterable[Decomposition], names: Iterable[str] | None = None
    ) -> "Person":
        """Fuse shots of one person.

        Args:
            shots: Two decompositions or more, made with one model. They may come from a generator:
                maps are not kept.
            names: What messages call the shots; "shot 1" and so on by default.

        Returns:
            What was read of the person.

        Raises:
            InputError: There is one shot or none with skin, they were read with several models, or
                they plainly differ, and not by a single one that can be left out: they show
                different people, or one of two has failed.

        Example:
            >>> from skimage.data import astronaut
            >>> from skinnet import Decomposer
            >>> from skinnet.inference import Person
            >>> read, photo = Decomposer(threads=1), astronaut()
            >>> shots = [read(each, detail=False) for each in (photo, photo // 2)]
            >>> person = Person.from_shots(shots, ["bright.jpg", "dark.jpg"])
            >>> low, high = person.regions["nose"].melanin.interval
            >>> low < person.regions["nose"].melanin.mean < high
            True
        """
        if not isinstance(shots, Iterable) or isinstance(shots, np.ndarray):
            raise InputError(f"shots are a list of decompositions; got {shots!r:.60}.")
        read = [describe_shot(each, f"shot {number}") for number, each in enumerate(shots, 1)]
        if names is not None:
            if not isinstance(names, Iterable) or isinstance(names, str):
                raise InputError(f"names are a list of texts; got {names!r:.60}.")
            called = tuple(check_text("The name of a shot", name) for name in names)
            if len(called) != len(read):
                raise InputError(
                    f"There are {len(read)} shots and {len(called)} names; give each shot one name."
                )
            read = [shot._replace(name=name) for shot, name in zip(read, called, strict=True)]
        return cls._fuse(read)

    @classmethod
    def _fuse(cls, read: Sequence[PersonShot]) -> "Person":
        """Fuse shots of which the maps are gone."""
        used, notes = _choose_shots(read)
        usable = [read[index] for index in used]
        fused = fuse_shots(usable)
        tops, optics = usable[0].tops, usable[0].model.get("optics")
        whole, *regions = (
            _make_region(fused, row, tops, optics) for row in range(1 + len(REGION_NAMES))
        )
        regions = regions if any(shot.has_face for shot in usable) else []
        session = dict(zip(used, (number_sessions(usable) + 1).tolist(), strict=True))
        return cls(
            pigments={"melanin": whole.melanin, "hemoglobin": whole.hemoglobin},
            regions=dict(zip(REGION_NAMES, regions, strict=bool(regions))),
            shots=tuple(shot.name for shot in read),
            sessions=tuple(session.get(index) for index in range(len(read))),
            notes=(*notes, *note_disagreement(*fused), *note_sessions(usable)),
            _read=tuple(read),
        )

    def __repr__(self) -> str:
        intervals = self.interval()
        pigments = ", ".join(
            f"{name} {describe_mean(mean, intervals[name])}" for name, mean in self.means.items()
        )
        used = [session for session in self.sessions if session is not None]
        sessions = max(used)
        return (
            f"<Person in {len(used)} shots of {sessions} session{'s' * (sessions > 1)}: {pigments}>"
        )

    @property
    def means(self) -> dict[str, float]:
        """Mean `melanin` and `hemoglobin` of the skin."""
        return {name: one.mean for name, one in self.pigments.items() if one.mean is not None}

    def interval(self, level: float = LEVEL) -> dict[str, tuple[float, float]]:
        """Find between which fractions the mean pigments of the skin truly lie.

        Args:
            level: Probability that the true mean lies in the interval, between 0 and 1.

        Returns:
            Lowest and highest fraction of `melanin` and `hemoglobin`.

        Raises:
            InputError: The level is no such probability.

        Example:
            >>> from skimage.data import astronaut
            >>> from skinnet import Decomposer
            >>> from skinnet.inference import Person
            >>> shot = Decomposer(threads=1)(astronaut(), detail=False)
            >>> low, high = Person.from_shots([shot, shot]).interval(0.5)["melanin"]
            >>> low < shot.means["melanin"] < high
            True
        """
        find_factor(0.0, level)
        tops = dict(zip(PIGMENTS, self._read[0].tops, strict=True))
        return {
            name: find_interval(mean, self.pigments[name].log_sd, tops[name], level)
            for name, mean in self.means.items()
        }

    def indices(self, level: float = LEVEL) -> SkinIndices | None:
        """Compute colour, typology angle, instrument indices and nearest tone of the mean skin.

        Args:
            level: Probability that a true number lies in its interval, between 0 and 1.

        Returns:
            The indices, as of a `Decomposition`; None if the model's fractions do not belong to the
            preset `measured`. Those of parts of the face are in `regions`.

        Raises:
            InputError: The level is no such probability.

        Example:
            >>> from skimage.data import astronaut
            >>> from skinnet import Decomposer
            >>> from skinnet.inference import Person
            >>> shot = Decomposer(threads=1)(astronaut(), detail=False)
            >>> low, high = Person.from_shots([shot, shot]).indices().typology_angle.interval
            >>> low < shot.indices().typology_angle.value < high
            True
        """
        find_factor(0.0, level)
        melanin, hemoglobin = (self.pigments[name] for name in PIGMENTS)
        means, log_sds = (melanin.mean, hemoglobin.mean), (melanin.log_sd, hemoglobin.log_sd)
        return _find_indices(self._read[0].model.get("optics"), means, log_sds, level)

    def summary(self) -> dict[str, Any]:
        """Summarise the person as numbers for JSON.

        Returns:
            `shots` (of each `name`, `session`, None if it was left out, `pigments` with `mean`,
            `sd` and `interval` as the shot alone states them, `capture_known` and `notes`),
            `pigments` and `regions` (of each `melanin` and `hemoglobin` with `mean`, `sd`,
            `interval`, its probability `level`, the number of `shots`, and their `agreement`),
            `indices` of the whole skin and of each region, as of a `Decomposition`,
            `shared_correlation` of the errors of two sessions, `notes`, `version` and `model`.
        """
        return {
            "shots": [
                {"name": one.name, "session": session, **_summarise(one)}
                for one, session in zip(self._read, self.sessions, strict=True)
            ],
            "pigments": {name: one.to_json() for name, one in self.pigments.items()},
            "indices": None if (indices := self.indices()) is None else indices.to_json(),
            "regions": {name: one.to_json() for name, one in self.regions.items()},
            "shared_correlation": SHARED,
            "notes": list(self.notes),
            "version": __version__,
            "model": self._read[0].model,
        }


def _choose_shots(read: Sequence[PersonShot]) -> tuple[list[int], list[str]]:
    """Leave out shots without skin, and one that is plainly unlike the others. Returns notes."""
    notes = [f"{shot.name} was left out: no skin was found." for shot in read if not shot.has_skin]
    used = [index for index, shot in enumerate(read) if shot.has_skin]
    usable = [read[index] for index in used]
    _refuse_few(usable)
    outlier = find_outlier(usable)
    if outlier is not None:
        notes.append(describe_outlier(usable, outlier))
        used.pop(outlier)
    return used, notes


def _refuse_few(usable: Sequence[PersonShot]) -> None:
    """Refuse less than two shots, and shots that cannot be compared."""
    if len(usable) < 2:
        raise InputError(
            f"A person is read from two shots or more; got {len(usable) or 'none'} with skin. "
            "skinnet predict (in Python Decomposer) reads one."
        )
    models = {(shot.model.get("version"), shot.model.get("optics")) for shot in usable}
    if len(models) > 1:
        raise InputError(
            f"The shots were read with {len(models)} models, whose fractions differ; read all with "
            "one Decomposer."
        )


def _make_region(
    fused: tuple[Fusion, Fusion], row: int, tops: tuple[float, float], optics: str | None
) -> FusedRegion:
    melanin, hemoglobin = (
        make_pigment(each, row, top) for each, top in zip(fused, tops, strict=True)
    )
    means, log_sds = (melanin.mean, hemoglobin.mean), (melanin.log_sd, hemoglobin.log_sd)
    return FusedRegion(melanin, hemoglobin, _find_indices(optics, means, log_sds))


def _summarise(shot: PersonShot) -> dict[str, Any]:
    """What one shot states alone."""
    rows = zip(PIGMENTS, shot.log_means[0], shot.log_sds[0], shot.tops, strict=True)
    pigments = {
        name: summarise_mean(float(np.exp(value)) if shot.has_skin else None, float(log_sd), top)
        for name, value, log_sd, top in rows
    }
    return {
        "pigments": round_all(pigments),
        "capture_known": list(shot.capture_known),
        "notes": list(shot.notes),
    }
