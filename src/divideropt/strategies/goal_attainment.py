"""A sweep of goal-attainment problems over reference directions.

Each direction w asks for the least γ with F_i - w_i γ ≤ F*_i, objectives scaled between the ideal and the nadir
point of what has been found so far (Gembicki 1974); the complex method solves it, warm-started from its neighbour.
A small multiple of the sum is added, so that weakly optimal points lose (Wierzbicki's augmentation).
"""

from collections.abc import Iterator
from itertools import count
from math import comb
from typing import Annotated

import moocore
import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from divideropt.models.base import FloatArray
from divideropt.problem import Problem, Told, merit
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

    Attributes:
        X: The designs kept, in the order in which they were told.
        told: What was told of them.
    """

    def __init__(self, problem: Problem, evaluate: Evaluate) -> None:
        self._evaluate = evaluate
        self._fresh: list[tuple[FloatArray, FloatArray, FloatArray]] = []
        self._front = np.empty((0, len(problem.objectives)))
        self.X = np.empty((0, len(problem.space)))
        self.told = Told(self._front, np.empty((0, problem.constraint_count)))

    def score(self, designs: FloatArray) -> Told:
        """Evaluate designs; they are kept with the next `settle`."""
        told = self._evaluate(designs)
        self._fresh.append((designs.copy(), told.F, told.G))
        return told

    def settle(self) -> None:
        """Keep what is worth it."""
        old = (self.X, self.told.F, self.told.G)
        X, F, G = (np.concatenate(parts) for parts in zip(old, *self._fresh, strict=True))
        told = Told(F, G)
        kept = np.flatnonzero(told.feasible)
        if len(kept):
            kept = kept[moocore.is_nondominated(F[kept])]
            self._front = F[kept]
        else:
            front = np.concatenate([self._front, *(F for _, F, _ in self._fresh)])
            self._front = front[moocore.is_nondominated(front)]
            kept = np.array([merit(np.zeros(len(F)), told).argmin()])
        self.X, self.told, self._fresh = X[kept], Told(F[kept], G[kept]), []

    def ideal_and_span(self) -> tuple[FloatArray, FloatArray]:
        """Ideal point of the front found so far, and its extent, 1 where it has none."""
        span = np.ptp(self._front, axis=0)
        return self._front.min(axis=0), np.where(span > 0, span, 1.0)


def _visit(direction: FloatArray, archive: _Archive, problem: Problem, random: np.random.Generator) -> None:
    """Improve the answer to one direction's problem by a complex that is given `VISIT` evaluations a variable."""
    archive.settle()
    ideal, span = archive.ideal_and_span()
    spent, granted = 0, VISIT * len(problem.space)

    def attainment(told: Told) -> FloatArray:
        scaled = (told.F - ideal) / span / direction
        return merit(scaled.max(axis=1) + AUGMENTATION * scaled.sum(axis=1), told)

    def score(designs: FloatArray) -> FloatArray:
        nonlocal spent
        if spent + len(designs) > granted:
            raise _VisitOverError
        spent += len(designs)
        return attainment(archive.score(designs))

    known = attainment(archive.told)
    space, nearest = problem.space, int(np.argmin(known))
    reach = np.exp(random.uniform(*np.log(NEIGHBOURHOOD))) * (space.upper - space.lower)
    scatter = 2 * random.random((2 * len(space) - 1, len(space))) - 1
    fresh = space.clip(archive.X[nearest] + reach * scatter)
    try:
        points = np.concatenate([archive.X[[nearest]], fresh])
        search(Complex(points, np.concatenate([known[[nearest]], score(fresh)])), score, space, random)
    except _VisitOverError:
        return


class _VisitOverError(Exception):
    """A visit's evaluations are spent."""
