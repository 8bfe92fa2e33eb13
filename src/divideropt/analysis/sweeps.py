"""A one-at-a-time study to sweeps: what each parameter moves, where a quantity crosses zero, where designs fail."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

import numpy as np
from numpy.typing import NDArray

from divideropt.models.base import FloatArray, Quantity, Verdict
from divideropt.problem import Evaluations, Problem
from divideropt.store.schema import DEVIATION_FLOOR


@dataclass(frozen=True)
class FailedStretch:
    """Designs that failed one after the other.

    Attributes:
        begin: The first one's value of the parameter.
        end: The last one's.
        outcomes: How many ended how.
        example: The sentence of the first.
    """

    begin: float
    end: float
    outcomes: Mapping[str, int]
    example: str

    @property
    def count(self) -> int:
        """How many they are."""
        return sum(self.outcomes.values())


@dataclass(frozen=True)
class Sweep:
    """One parameter varied, the others where the campaign has them.

    Attributes:
        parameter: Its name.
        base: The campaign's own value of it, in its unit.
        values: Its values, rising, in its unit, shape (n,).
        quantities: Every quantity by name, in its unit, NaN where it is not defined, shape (n,) each.
        verdicts: One a value.
    """

    parameter: str
    base: float
    values: FloatArray
    quantities: Mapping[str, FloatArray]
    verdicts: Sequence[Verdict]

    @property
    def ok(self) -> NDArray[np.bool_]:
        """Where the outcome is ok, shape (n,)."""
        return np.array([verdict.ok for verdict in self.verdicts], dtype=bool)

    @property
    def failed(self) -> int:
        """How many designs failed."""
        return int((~self.ok).sum())

    def sound(self, quantity: str) -> FloatArray:
        """Return a quantity with NaN also where the outcome is not ok, shape (n,)."""
        return np.where(self.ok, self.quantities[quantity], np.nan)

    def failures(self) -> tuple[FailedStretch, ...]:
        """Say where designs failed: each unbroken stretch."""
        runs = groupby(range(len(self.values)), key=lambda row: self.verdicts[row].ok)
        return tuple(self._stretch(list(rows)) for ok, rows in runs if not ok)

    def crossings(self, quantity: str) -> tuple[float, ...]:
        """Find where a quantity crosses zero, by a straight line between two neighbours that are both ok.

        Returns:
            Values of the parameter. A quantity that touches zero and turns back does not cross it.
        """
        found = []
        sound = self.sound(quantity)
        for begin, end in _stretches(np.isfinite(sound)):
            rows = begin + np.flatnonzero(sound[begin:end])  # a zero between two signs is passed over
            for i, j in zip(rows[:-1].tolist(), rows[1:].tolist(), strict=True):
                if sound[i] * sound[j] < 0.0:
                    share = sound[i] / (sound[i] - sound[j])
                    between = self.values[i] + share * (self.values[j] - self.values[i])
                    found.append(float(self.values[i + 1] if j > i + 1 else between))
        return tuple(found)

    def _stretch(self, rows: Sequence[int]) -> FailedStretch:
        verdicts = [self.verdicts[i] for i in rows]
        outcomes = Counter(str(verdict.outcome) for verdict in verdicts)
        first, last = float(self.values[rows[0]]), float(self.values[rows[-1]])
        return FailedStretch(first, last, dict(outcomes.most_common()), verdicts[0].text)


@dataclass(frozen=True)
class Effect:
    """What a parameter makes of a quantity over its range, failed designs aside.

    Attributes:
        quantity: Its name.
        least: Smallest value; NaN where no design has one.
        greatest: Largest value.
        relative: Their difference over the magnitude of the quantity at the campaign's own design, or over 1 % of the
            quantity's scale where that is more; NaN where the campaign's own design has none.
    """

    quantity: str
    least: float
    greatest: float
    relative: float


@dataclass(frozen=True)
class Sweeps:
    """Sweeps of one campaign.

    Attributes:
        sweeps: In the order in which they were run; each whole.
        base: Every quantity of the campaign's own design, as `base_of` finds it.
    """

    sweeps: tuple[Sweep, ...]
    base: Mapping[str, float]


def sweeps_of(evaluations: Evaluations, problem: Problem, points: int) -> Sweeps:
    """Take a log apart.

    Args:
        evaluations: In the order of the log: sweep after sweep, in the order of the problem's variables.
        problem: Whose variables are the parameters and whose fixed parameters hold their own values.
        points: Designs of a sweep; one that is not whole yet is left out.

    Returns:
        The sweeps that are there.

    Raises:
        ValueError: These are no sweeps of this problem.
    """
    sweeps = []
    for place, variable in enumerate(problem.space.variables[: len(evaluations) // points]):
        part = evaluations.part(place * points, (place + 1) * points)
        others = np.delete(np.arange(len(problem.space)), place)
        base = np.array([problem.fixed[name] for name in problem.space.names])
        values = part.designs[:, place]
        if (part.designs[:, others] != base[others]).any() or (np.diff(values) <= 0.0).any():
            raise ValueError(
                f"batch {place} of the log does not vary {variable.parameter.name} alone, and rising: it is of no "
                "study one parameter at a time"
            )
        quantities = dict(zip(problem.model.quantities, part.quantities.T, strict=True))
        sweeps.append(Sweep(variable.parameter.name, float(base[place]), values, quantities, part.verdicts))
    return Sweeps(tuple(sweeps), base_of(sweeps, list(problem.model.quantities)))


def base_of(sweeps: Sequence[Sweep], names: Sequence[str]) -> Mapping[str, float]:
    """Find the quantities of the campaign's own design, through which every sweep goes.

    Of all sweeps the one with a design nearest to it, in parts of the distance between two designs, tells: by that
    design if it is the same, else by a straight line between its two neighbours.

    Args:
        sweeps: Any number.
        names: The quantities.

    Returns:
        Their values by name, NaN where a neighbour has none or failed, or where the campaign's own value of every
        parameter lies outside its range.
    """
    spanning = [sweep for sweep in sweeps if sweep.values[0] <= sweep.base <= sweep.values[-1]]
    if not spanning:
        return dict.fromkeys(names, float("nan"))
    nearest = min(spanning, key=_distance)
    return {name: _interpolated(nearest, name) for name in names}


def effects_of(sweep: Sweep, base: Mapping[str, float], quantities: Mapping[str, Quantity]) -> tuple[Effect, ...]:
    """Say what a parameter moves, the most moved first; those that nothing is known of come last.

    Args:
        sweep: The parameter's.
        base: Every quantity of the campaign's own design.
        quantities: What there is; a logical one has no effect.
    """
    found = [_effect(sweep, quantity, base[name]) for name, quantity in quantities.items() if not quantity.logical]
    return tuple(sorted(found, key=lambda effect: -effect.relative if np.isfinite(effect.relative) else np.inf))


def _effect(sweep: Sweep, quantity: Quantity, base: float) -> Effect:
    sound = sweep.sound(quantity.name)
    known = sound[np.isfinite(sound)]
    if not len(known):
        return Effect(quantity.name, float("nan"), float("nan"), float("nan"))
    least, greatest = float(known.min()), float(known.max())
    size = max(abs(base), DEVIATION_FLOOR * quantity.scale) if np.isfinite(base) else float("nan")
    return Effect(quantity.name, least, greatest, (greatest - least) / size)


def _distance(sweep: Sweep) -> float:
    """How far its nearest design is from the campaign's own, in parts of the distance between two of its designs."""
    return float(np.abs(sweep.values - sweep.base).min() / np.diff(sweep.values).mean())


def _interpolated(sweep: Sweep, name: str) -> float:
    sound = sweep.sound(name)
    same = np.flatnonzero(sweep.values == sweep.base)
    if len(same):
        return float(sound[same[0]])
    above = int(np.searchsorted(sweep.values, sweep.base))
    pair = slice(above - 1, above + 1)
    return float(np.interp(sweep.base, sweep.values[pair], sound[pair]))


def _stretches(works: NDArray[np.bool_]) -> Iterator[tuple[int, int]]:
    """The unbroken stretches, as begin and end."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], works, [False]]).astype(np.int8)))
    yield from zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True)
