"""Blood of a face over time: hemoglobin as a function of expression and state."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from skinnet.appearance._amounts import check_amounts, join_states
from skinnet.appearance._blood_change import BloodChange
from skinnet.appearance._dynamic_file import ARRAYS, FIELD_SIZE, read_model, write_model
from skinnet.appearance._dynamic_fit import (
    Example,
    find_lags,
    fit_means,
    fit_spreads,
    measure_held_out,
)
from skinnet.appearance._ridge import find_amounts
from skinnet.appearance._sequence_statistics import measure_means
from skinnet.appearance._time_course import PULSE, beat, follow, respond
from skinnet.appearance.blood_sequence import BloodSequence
from skinnet.errors import InputError

_WINDOW, _RIDGE = 0.03, 0.05
"""Standard deviation of the local window in sides of the chart (a sixteenth of a face), and what is
added to each coefficient's sum of squares."""

_MOST = 0.15
"""Largest volume fraction of blood in the shipped skin model."""

_RATE = 70.0

Amounts = Mapping[str, int | float]


@dataclass(frozen=True, eq=False, repr=False)
class DynamicModel:
    """Hemoglobin of a face as a function of expression, state and time; melanin does not change.

    log f = log f_rest + sum_k a_k (M_k + S_k (log f_rest - local mean of log f_rest))

    The a_k are amounts of states (flush, pallor) and weights of expressions. Each moves the local
    mean of log hemoglobin by M_k and stretches its local standard deviation by 1 + S_k, as Jimenez
    et al. match local distributions, so that the fine structure of the face at rest stays. Fields
    lie on a chart that landmarks give to every face.

    Attributes:
        names: Names of the coefficients.
        mean: M of each coefficient, float32 [names, size, size].
        spread: S of each, the same.
        landmarks: Places of the 478 landmarks on the chart, from 0 to 1, [478, 2].
        seconds: Time in which blood follows each coefficient by 63 %, [names].
        states: Coefficients of each named state at an amount of 1.
        sources: Where each state is from.
        errors: Error of the log change on frames that the fit has not seen: `rmse`, `rest_rmse`
            (that of no change), `r` and `frames`.
        window: Standard deviation of the local window in sides of the chart.

    Source:
        J. Jimenez et al., A practical appearance model for dynamic facial color, ACM Transactions
        on Graphics 29 (SIGGRAPH Asia), 2010. Section 7 of Alotaibi & Smith (2017) names such models
        as future work.

    Example:
        >>> model = DynamicModel.load()
        >>> rest = np.full((96, 96), 0.04, np.float32)
        >>> flushed = model.sample(rest, {"flush": 0.7})
        >>> bool(flushed.max() > 0.05), bool((model.sample(rest, {"flush": 0.0}) == rest).all())
        (True, True)
    """

    names: tuple[str, ...]
    mean: NDArray[np.float32]
    spread: NDArray[np.float32]
    landmarks: NDArray[np.float32]
    seconds: NDArray[np.float32]
    states: Mapping[str, Amounts] = field(default_factory=dict)
    sources: Mapping[str, str] = field(default_factory=dict)
    errors: Amounts = field(default_factory=dict)
    window: float = _WINDOW

    def __repr__(self) -> str:
        return f"<DynamicModel of {len(self.names)} coefficients: {', '.join(self.states)}>"

    @classmethod
    def fit(
        cls,
        sequences: Sequence[BloodSequence],
        *,
        landmarks: NDArray[np.floating] | None = None,
        seconds: Amounts | None = None,
        states: Mapping[str, Amounts] | None = None,
        sources: Mapping[str, str] | None = None,
        ridge: int | float = _RIDGE,
        size: int = FIELD_SIZE,
    ) -> "DynamicModel":
        """Fit the model to sequences of maps on one chart.

        Single frames and places that do not fit the others lose their weight (Huber), and slopes
        of coefficients that hardly vary are drawn to 0.

        Args:
            sequences: One or more; a coefficient that one of them lacks is 0 in it.
            landmarks: Places of the 478 landmarks on the chart; None: those of the shipped model.
            seconds: Time constants by name; others are 0. None: they are found.
            states: Coefficients of named states; None: each coefficient is a state of its own.
            sources: Where each state is from.
            ridge: Added to each coefficient's sum of squares.
            size: Side of the fields.

        Returns:
            The model, with its error on the fourth part that was held out; fields are of all
            frames.

        Raises:
            InputError: There is no sequence, or none has coefficients.

        Example:
            >>> rest = np.full((32, 32), 0.05)
            >>> amount = np.linspace(0, 1, 12)
            >>> maps = rest * np.exp(0.4 * amount)[:, None, None]
            >>> model = DynamicModel.fit([BloodSequence(rest, maps, amount, {"flush": amount})])
            >>> abs(float(model.mean[0, 24, 24]) - 0.4) < 0.01
            True
        """
        names = tuple(dict.fromkeys(name for each in sequences for name in each.coefficients))
        if not names:
            raise InputError(
                "A dynamic model is fitted to sequences with known amounts; give coefficients."
            )
        examples = [_measure(each, names, size) for each in sequences]
        if seconds is None:
            lags = find_lags(names, examples, ridge)
        else:
            lags = np.array([float(seconds.get(name, 0.0)) for name in names])
        errors = measure_held_out(examples, lags, ridge, _WINDOW)
        mean = fit_means(examples, lags, ridge, _WINDOW)
        spread = fit_spreads(examples, mean, lags, ridge, _WINDOW)
        chart = cls.load().landmarks if landmarks is None else landmarks
        return cls(
            names,
            mean.reshape(-1, size, size).astype(np.float32),
            spread.reshape(-1, size, size).astype(np.float32),
            np.asarray(chart, np.float32),
            lags.astype(np.float32),
            states or {name: {name: 1.0} for name in names},
            sources or {},
            errors,
        )

    def change(
        self, amounts: Amounts, time: int | float | None = None, rate: int | float = _RATE
    ) -> BloodChange:
        """Make the change of hemoglobin for some states, such as `Decomposer.edit` takes.

        Args:
            amounts: Amount of each state or coefficient, from 0 to 1.
            time: Seconds since all of them began; None: long after, at the peak of the pulse.
            rate: Pulse in beats per minute.

        Returns:
            The change.

        Raises:
            InputError: A state is not known, or an amount is not from 0 to 1.

        Example:
            >>> DynamicModel.load().change({"flush": 0.5}).amounts
            {'flush': 0.5}
        """
        check_amounts(amounts, self.states, self.names)
        wanted = join_states(amounts, self.states, self.names)
        if time is not None:
            lags = self.seconds.tolist()
            wanted = np.array(
                [
                    amount * beat(time, rate) if name == PULSE else respond(amount, lag, time)
                    for name, amount, lag in zip(self.names, wanted.tolist(), lags, strict=True)
                ]
            )
        return self._mix(wanted, dict(amounts))

    def sample(
        self,
        rest: NDArray[np.floating],
        amounts: Amounts,
        landmarks: NDArray[np.floating] | None = None,
        *,
        skin: NDArray[np.floating] | None = None,
        time: int | float | None = None,
        rate: int | float = _RATE,
        most: int | float = _MOST,
    ) -> NDArray[np.float32]:
        """Compute hemoglobin of a face in some states.

        Args:
            rest: Volume fractions at rest, [h, w], of any size.
            amounts: Amount of each state or coefficient, from 0 to 1.
            landmarks: Columns and rows of the face's landmarks in pixels of the map, as
                `Face.landmarks`, [478, 2]; None for a map on the chart.
            skin: Where there is skin, from 0 to 1, [h, w]; None: everywhere.
            time: Seconds since all amounts began; None: long after, at the peak of the pulse.
            rate: Pulse in beats per minute.
            most: The largest volume fraction.

        Returns:
            Volume fractions, float32 [h, w]; with amounts of 0 exactly those at rest.

        Raises:
            InputError: A state is not known, an amount is not from 0 to 1, or a map has no two
                axes.
        """
        level = np.asarray(rest, np.float32)
        weight = np.ones_like(level) if skin is None else np.asarray(skin, np.float32)
        if level.ndim != 2 or weight.shape != level.shape:
            raise InputError(
                f"Hemoglobin is a map [h, w], and skin has its shape; got {level.shape} and "
                f"{weight.shape}."
            )
        change = self.change(amounts, time, rate)
        if landmarks is None:
            sides = np.array(level.shape[::-1])
            changed = change(level, self.landmarks * sides, weight, most)
        else:
            changed = change(level, np.asarray(landmarks), weight, most)
        return np.where(weight > 0, changed, level)

    def follow(
        self,
        amounts: Mapping[str, NDArray[np.float64]],
        times: NDArray[np.float64],
        rate: int | float = _RATE,
    ) -> dict[str, NDArray[np.float64]]:
        """Compute how blood follows amounts that change: with its lag, and with each beat.

        Args:
            amounts: Amounts of states and coefficients over time, [frames] each.
            times: In seconds, [frames].
            rate: Pulse in beats per minute.

        Returns:
            Coefficients over time, [frames] each, whose values at a frame `sample` takes.

        Raises:
            InputError: As of `sample`, or amounts and times differ in number.

        Example:
            >>> model = DynamicModel.load()
            >>> course = model.follow({"flush": np.ones(3)}, np.arange(3.0))
            >>> course["flush"].tolist()
            [1.0, 1.0, 1.0]
        """
        lengths = {len(each) for each in amounts.values()}
        if not lengths <= {len(times)}:
            raise InputError(
                f"Amounts over time are one for each of the {len(times)} times; got {lengths}."
            )
        wanted = np.zeros((len(times), len(self.names)))
        for frame in range(len(times)):
            each = {name: float(values[frame]) for name, values in amounts.items()}
            check_amounts(each, self.states, self.names)
            wanted[frame] = join_states(each, self.states, self.names)
        return {
            name: column * beat(times, rate) if name == PULSE else follow(column, times, float(lag))
            for name, column, lag in zip(self.names, wanted.T, self.seconds, strict=True)
            if column.any()
        }

    def explain(
        self, sequence: BloodSequence, names: Sequence[str], ridge: int | float = _RIDGE
    ) -> dict[str, NDArray[np.float64]]:
        """Find the amounts that explain a sequence, so that another face can be given them.

        Args:
            sequence: Such as `BloodSequence.from_track` reads.
            names: The coefficients that may explain it.
            ridge: As of `fit`.

        Returns:
            Amounts over time, from 0 to 1, [frames] each; 0 where nothing is known.

        Raises:
            InputError: A coefficient is not known.
        """
        check_amounts(dict.fromkeys(names, 0.0), {}, self.names)
        chosen = [self.names.index(name) for name in names]
        size = self.mean.shape[-1]
        values = measure_means(sequence.rest, sequence.maps, self.window, size)
        fields = self.mean[chosen].reshape(len(chosen), -1).T.astype(np.float64)
        amounts = np.array([find_amounts(fields, each, ridge) for each in values])
        return dict(zip(names, amounts.reshape(-1, len(names)).T, strict=True))

    def save(self, path: str | Path) -> None:
        """Write the model to an .npz file, all of it or nothing.

        Args:
            path: It ends in .npz.

        Raises:
            InputError: It has another ending, or cannot be written.
        """
        header = {
            "names": list(self.names),
            "states": {name: dict(each) for name, each in self.states.items()},
            "sources": dict(self.sources),
            "errors": dict(self.errors),
            "window": self.window,
        }
        write_model(Path(path), header, {name: getattr(self, name) for name in ARRAYS})

    @classmethod
    def load(cls, path: str | Path | None = None) -> "DynamicModel":
        """Read a model.

        Args:
            path: A file that `save` wrote; None for the shipped model.

        Returns:
            The model, bit by bit.

        Raises:
            InputError: The file is missing, damaged or of another kind.
        """
        header, arrays = read_model(None if path is None else Path(path))
        return cls(
            header["names"],
            arrays["mean"],
            arrays["spread"],
            arrays["landmarks"],
            arrays["seconds"],
            header["states"],
            header["sources"],
            header["errors"],
            header["window"],
        )

    def _mix(self, wanted: NDArray[np.float64], amounts: dict[str, int | float]) -> BloodChange:
        share = wanted.astype(np.float32)
        mean, spread = (np.tensordot(share, each, 1) for each in (self.mean, self.spread))
        return BloodChange(mean, spread, self.landmarks, self.window, amounts)


def _measure(sequence: BloodSequence, names: Sequence[str], size: int) -> Example:
    none = np.zeros(len(sequence.times))
    columns = [np.asarray(sequence.coefficients.get(name, none), np.float64) for name in names]
    means = measure_means(sequence.rest, sequence.maps, _WINDOW, size)
    times = np.asarray(sequence.times, np.float64)
    return Example(sequence.rest, sequence.maps, times, np.stack(columns, 1), means)
