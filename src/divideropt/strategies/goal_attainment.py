"""A sweep of goal-attainment problems over reference directions.

Each direction w asks for the least γ with F_i - w_i γ ≤ F*_i, objectives scaled between the ideal and the nadir
point of what has been found so far (Gembicki 1974); the complex method solves it, warm-started from its neighbour.
A small multiple of the sum is added, so that weakly optimal points lose (Wierzbicki's augmentation).
"""

from collections.abc import Callable, Iterator
from itertools import count
from math import comb
from typing import Annotated

import moocore
import numpy as np
from numpy.typing import NDArray
from pydantic import Field
from pydantic.dataclasses import dataclass

from divideropt.models.base import FloatArray
from divideropt.problem import Problem, Told, merit
from divideropt.problem.problem import INFEASIBLE_MERIT
from divideropt.strategies.base import STRICT, BudgetSpentError, Count, Evaluate, within_budget
from divideropt.strategies.complex_method import Complex, search

AUGMENTATION = 1e-3
"""ρ: what the sum of the scaled objectives counts beside their maximum."""

SMALLEST_WEIGHT = 1e-3
"""Floor of a direction's components: a zero would ignore its objective altogether."""

FIRST_SAMPLE = 10
"""Random designs a variable, from which the sweep sets out."""

VISIT = 5
"""Evaluations a variable that a direction gets at each visit; the sweep comes round again while the budget lasts,
and no visit depends on how often that will be."""

NEIGHBOURHOOD = (0.02, 0.3)
"""Between these parts of the box, at each visit drawn anew, lies the half width from which the points of a
warm-started complex are taken: large ones find, small ones polish."""


@dataclass(frozen=True, config=STRICT)
class GoalAttainment:
    """Options of the sweep."""

    directions: Annotated[int, Field(ge=3, le=10_000)] = 91
    """Reference directions, spread evenly (Das and Dennis); the largest such set of at most this many."""
    evaluations: Count = 9000
    """Budget of evaluations."""

    @property
    def budget(self) -> int:
        """Most evaluations a run asks for."""
        return self.evaluations

    def objection(self, variables: int, objectives: int) -> tuple[str, str] | None:
        """The first sample must fit into the budget, each objective have a direction; see `Strategy.objection`."""
        if self.directions < objectives:
            return "directions", f"{self.directions} are fewer than the {objectives} objectives; give more"
        if self.evaluations < FIRST_SAMPLE * variables:
            least = FIRST_SAMPLE * variables
            return "evaluations", f"{self.evaluations} do not suffice for the first sample; give at least {least}"
        return None

    def run(self, problem: Problem, evaluate: Evaluate, seed: int) -> None:
        """Visit the directions one after the other, round after round; see `Strategy.run`."""
        random = np.random.default_rng(seed)
        archive = _Archive(problem, within_budget(evaluate, self.evaluations))
        directions = reference_directions(len(problem.objectives), self.directions)
        try:
            archive.score(problem.space.sample(FIRST_SAMPLE * len(problem.space), random))
            for _ in count():
                for direction in directions:
                    _visit(direction, archive, problem, random)
        except BudgetSpentError:
            return


def reference_directions(objectives: int, most: int) -> FloatArray:
    """Spread directions evenly over the unit simplex, each next to the one before.

    Args:
        objectives: Number of objectives.
        most: Most directions.

    Returns:
        The largest Das–Dennis set of at most `most`, along a boustrophedon path, shape (n, objectives).
    """
    parts = 1
    while objectives > 1 and comb(parts + objectives, objectives - 1) <= most:
        parts += 1
    lattice = np.array(list(_lattice(objectives, parts)), dtype=float) / parts
    return np.asarray(np.maximum(lattice, SMALLEST_WEIGHT))


def _lattice(dimension: int, total: int) -> Iterator[tuple[int, ...]]:
    if dimension == 1:
        yield (total,)
        return
    for first in range(total + 1):
        rest = list(_lattice(dimension - 1, total - first))
        yield from ((first, *others) for others in (rest if first % 2 == 0 else reversed(rest)))


class _Archive:
    """What a sweep keeps of all that it was told: what can be nearest to a direction, and what sets the scale.

    That is the front, since a dominated design is nowhere nearer than one that dominates it; before anything is
    feasible, the design of least violation, and the front of the infeasible.
    """

    def __init__(self, problem: Problem, evaluate: Evaluate) -> None:
        self._evaluate = evaluate
        self._fresh: list[tuple[FloatArray, Told]] = []
        self._X = np.empty((0, len(problem.space)))
        self._F = np.empty((0, len(problem.objectives)))
        self._least: tuple[FloatArray, float] | None = None
        """The design of least violation and its merit; None once something is feasible."""
        self._feasible = False

    def score(self, designs: FloatArray) -> Told:
        """Evaluate designs; they are kept with the next `settle`."""
        told = self._evaluate(designs)
        self._fresh.append((designs.copy(), told))
        return told

    def settle(self) -> None:
        """Keep what is worth it."""
        X = np.concatenate([designs for designs, _ in self._fresh])
        told = Told(*(np.concatenate(parts) for parts in zip(*((t.F, t.G) for _, t in self._fresh), strict=True)))
        self._fresh = []
        feasible = told.feasible
        if feasible.any():
            if not self._feasible:
                self._feasible, self._X, self._F = True, self._X[:0], self._F[:0]
            self._X, self._F = _joined((self._X, self._F), (X[feasible], told.F[feasible]))
        elif not self._feasible:
            self._X, self._F = _joined((self._X, self._F), (X, told.F))
            merits = merit(np.zeros(len(X)), told)
            row = int(merits.argmin())
            if self._least is None or merits[row] < self._least[1]:
                self._least = X[row], float(merits[row])

    def ideal_and_span(self) -> tuple[FloatArray, FloatArray]:
        """Ideal point of the front found so far, and its extent, 1 where it has none."""
        ideal = self._F.min(axis=0)
        span = self._F.max(axis=0) - ideal
        return ideal, np.where(span > 0, span, 1.0)

    def nearest(self, value: Callable[[FloatArray], FloatArray]) -> tuple[FloatArray, float]:
        """Return the design of least value, shape (d,), and its merit, by a value of objectives, (n, k) to (n,)."""
        if not self._feasible and self._least is not None:
            return self._least
        values = np.minimum(value(self._F), INFEASIBLE_MERIT)
        row = int(values.argmin())
        return self._X[row], float(values[row])


_Points = tuple[FloatArray, FloatArray]
"""Designs, shape (n, d), and their objectives, shape (n, k), column after column in memory, as they are swept."""


def _joined(front: _Points, fresh: _Points) -> _Points:
    """Return the non-dominated of a front and of a few points more, the first of equals."""
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


def _visit(direction: FloatArray, archive: _Archive, problem: Problem, random: np.random.Generator) -> None:
    """Improve the answer to one direction's problem by a complex that is given `VISIT` evaluations a variable."""
    archive.settle()
    ideal, span = archive.ideal_and_span()
    spent, granted = 0, VISIT * len(problem.space)

    def attainment(F: FloatArray) -> FloatArray:
        scaled = (F - ideal) / span / direction
        return np.asarray(scaled.max(axis=1) + AUGMENTATION * scaled.sum(axis=1))

    def score(designs: FloatArray) -> FloatArray:
        nonlocal spent
        if spent + len(designs) > granted:
            raise _VisitOverError
        spent += len(designs)
        told = archive.score(designs)
        return merit(attainment(told.F), told)

    space, (nearest, known) = problem.space, archive.nearest(attainment)
    reach = np.exp(random.uniform(*np.log(NEIGHBOURHOOD))) * (space.upper - space.lower)
    scatter = 2 * random.random((2 * len(space) - 1, len(space))) - 1
    fresh = space.clip(nearest + reach * scatter)
    try:
        points = np.concatenate([nearest[None], fresh])
        search(Complex(points, np.concatenate([[known], score(fresh)])), score, space, random)
    except _VisitOverError:
        return


class _VisitOverError(Exception):
    """A visit's evaluations are spent."""
