"""What a search by directions keeps of all that it was told."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from divideropt.models.base import FloatArray
from divideropt.problem import Problem, Told, merit
from divideropt.problem.problem import INFEASIBLE_MERIT
from divideropt.strategies.base import Evaluate

UTOPIA_MARGIN = 0.05
"""How far a scale's zero lies below the ideal point, in its units: without it no step could improve an extreme."""


@dataclass(frozen=True)
class Scale:
    """Makes objectives comparable: 0 at a utopian point, 1 in the midst of a front.

    Attributes:
        utopia: Shape (k,), in the objectives' units.
        unit: Shape (k,), above 0.
    """

    utopia: FloatArray
    unit: FloatArray

    def of(self, F: FloatArray) -> FloatArray:
        """Scale objectives, shape (n, k); what lies at the utopian point or below stays just above 0."""
        return np.maximum((F - self.utopia) / self.unit, np.finfo(float).tiny)


class Archive:
    """Keeps what can be nearest to a direction, and what sets the scale.

    That is the front, since a dominated design is nowhere nearer than one that dominates it; before anything is
    feasible, the design of least violation, and the front of the infeasible.
    """

    def __init__(self, problem: Problem, evaluate: Evaluate) -> None:
        """Begin with nothing."""
        self._evaluate = evaluate
        self._fresh: list[tuple[FloatArray, Told]] = []
        self.X = np.empty((0, len(problem.space)))
        """Designs of the front, shape (n, d)."""
        self.F = np.empty((0, len(problem.objectives)))
        """Their objectives, shape (n, k)."""
        self._least: tuple[FloatArray, float] | None = None
        """The design of least violation and its merit; None once something is feasible."""
        self.feasible = False
        """Whether a feasible design is known."""

    def score(self, designs: FloatArray) -> Told:
        """Evaluate designs; they are kept with the next `settle`."""
        told = self._evaluate(designs)
        self._fresh.append((designs.copy(), told))
        return told

    def settle(self) -> None:
        """Keep what is worth it."""
        if not self._fresh:
            return
        X = np.concatenate([designs for designs, _ in self._fresh])
        told = Told(*(np.concatenate(parts) for parts in zip(*((t.F, t.G) for _, t in self._fresh), strict=True)))
        self._fresh = []
        feasible = told.feasible
        if feasible.any():
            if not self.feasible:
                self.feasible, self.X, self.F = True, self.X[:0], self.F[:0]
            self.X, self.F = _joined((self.X, self.F), (X[feasible], told.F[feasible]))
        elif not self.feasible:
            self.X, self.F = _joined((self.X, self.F), (X, told.F))
            merits = merit(np.zeros(len(X)), told)
            row = int(merits.argmin())
            if self._least is None or merits[row] < self._least[1]:
                self._least = X[row], float(merits[row])

    def ideal_and_span(self) -> tuple[FloatArray, FloatArray]:
        """Ideal point of the front found so far, and its extent to the nadir, 1 where it has none."""
        ideal = self.F.min(axis=0)
        span = self.F.max(axis=0) - ideal
        return ideal, np.where(span > 0, span, 1.0)

    def scale(self) -> Scale:
        """The front's scale: its median above the ideal point is the unit, since a nadir hangs on a few outliers."""
        ideal = self.F.min(axis=0)
        unit = np.median(self.F, axis=0) - ideal
        extent = self.F.max(axis=0) - ideal
        unit = np.where(unit > 0.0, unit, np.where(extent > 0.0, extent, 1.0))
        return Scale(ideal - UTOPIA_MARGIN * unit, unit)

    def nearest(self, value: Callable[[FloatArray], FloatArray]) -> tuple[FloatArray, float]:
        """Return the design of least value, shape (d,), and its merit, by a value of objectives, (n, k) to (n,)."""
        if not self.feasible and self._least is not None:
            return self._least
        values = np.minimum(value(self.F), INFEASIBLE_MERIT)
        row = int(values.argmin())
        return self.X[row], float(values[row])


def reached(archive: Archive, scale: Scale, directions: FloatArray) -> FloatArray:
    """Return the least λ = max_i z_i/w_i of the front in each direction, shape (m, k) to (m,); see `Scale`."""
    scaled = np.ascontiguousarray(scale.of(archive.F).T)
    return np.array([(scaled / direction[:, None]).max(axis=0).min() for direction in directions])


_Points = tuple[FloatArray, FloatArray]
"""Designs, shape (n, d), and their objectives, shape (n, k), column after column in memory, as they are swept."""


def _joined(front: _Points, fresh: _Points) -> _Points:
    """Return the non-dominated of a front and of a few points more, the first of equals."""
    import moocore  # noqa: PLC0415 (late: it brings ssl and email with it)

    X, F = (part[moocore.is_nondominated(fresh[1])] for part in fresh)
    new = np.array([not _all_of(np.less_equal, front[1], point).any() for point in F], dtype=bool)
    held = np.ones(len(front[1]), dtype=bool)
    for point in F[new]:
        held &= ~_all_of(np.greater_equal, front[1], point)
    if not new.any():
        return front
    joined = (np.concatenate([old[held], more[new]]) for old, more in zip(front, (X, F), strict=True))
    return next(joined), np.asfortranarray(next(joined))


def _all_of(compare: np.ufunc, F: FloatArray, point: FloatArray) -> NDArray[np.bool_]:
    """Compare each of many points with one, in every objective."""
    found = compare(F[:, 0], point[0])
    for column, value in zip(F.T[1:], point[1:], strict=True):
        found &= compare(column, value)
    return np.asarray(found)
