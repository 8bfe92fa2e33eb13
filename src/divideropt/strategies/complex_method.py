"""Box's complex method (1965), as the thesis ran it (section 3.5.1, C.7), with restarts.

A complex of points is held in the box. The worst is reflected over the centroid of the others; where that is no
better than what it replaces, the trial retreats towards the centroid and, as the retreats mount, towards the best
point (C.7, after Guin, and Krus and Andersson), with a random part that shrinks.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass as plain_dataclass
from itertools import count
from typing import Annotated

import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from divideropt.models.base import FloatArray
from divideropt.problem import AGGREGATES, DesignSpace, Problem, merit
from divideropt.strategies.base import (
    STRICT,
    AggregateName,
    BudgetSpentError,
    Count,
    Evaluate,
    within_budget,
)

REFLECTION = 1.3
"""α of Box and of C.7: how far beyond the centroid the worst point is reflected."""

RETREAT_MEMORY = 4
"""n_r of C.7: the larger, the slower a retreat turns from the centroid to the best point."""

MOST_RETREATS = 12
"""Retreats of one trial; C.7 has no limit. A trial still no better then means that the complex is stuck."""

COLLAPSED = 1e-5
"""A complex whose points lie within this part of the box in every variable has converged."""

Score = Callable[[FloatArray], FloatArray]
"""Designs, shape (n, d), to merits, shape (n,): the smaller the better."""


@dataclass(frozen=True, config=STRICT)
class ComplexMethod:
    """Options of the complex method."""

    aggregate: AggregateName = "goal_attainment"
    """How several objectives become one."""
    points: Annotated[int, Field(ge=3, le=1000)] | None = None
    """Points of a complex; twice the number of variables where not given."""
    evaluations: Count = 2000
    """Budget of evaluations."""

    @property
    def budget(self) -> int:
        """Most evaluations a run asks for."""
        return self.evaluations

    def objection(self, variables: int, objectives: int) -> tuple[str, str] | None:
        """A complex must span the box and fit into the budget; see `Strategy.objection`."""
        points = self.points or 2 * variables
        if points <= variables:
            return "points", f"{points} points do not span {variables} variables; give at least {variables + 1}"
        if self.evaluations < points:
            return "evaluations", f"{self.evaluations} do not even make a complex of {points} points; give more"
        return None

    def run(self, problem: Problem, evaluate: Evaluate, seed: int) -> None:
        """Search from random complexes, one after the other; see `Strategy.run`."""
        aggregate = AGGREGATES[self.aggregate]
        counted = within_budget(evaluate, self.evaluations)
        random = np.random.default_rng(seed)
        points = self.points or 2 * len(problem.space)

        def score(designs: FloatArray) -> FloatArray:
            told = counted(designs)
            return merit(aggregate(told.F, problem.objectives), told)

        try:
            for _ in count():
                start = problem.space.sample(points, random)
                search(Complex(start, score(start)), score, problem.space, random)
        except BudgetSpentError:
            return


@plain_dataclass
class Complex:
    """The points held, and their merits.

    Attributes:
        points: Shape (k, d).
        merits: Shape (k,).
    """

    points: FloatArray
    merits: FloatArray

    @property
    def best(self) -> int:
        """Index of the best point."""
        return int(self.merits.argmin())

    @property
    def worst(self) -> int:
        """Index of the worst point."""
        return int(self.merits.argmax())


def search(held: Complex, score: Score, space: DesignSpace, random: np.random.Generator) -> None:
    """Improve a complex until it has collapsed or is stuck.

    Args:
        held: Improved in place.
        score: Answers a trial; may end the run by raising.
        space: The box; a trial outside is moved to its nearest point.
        random: Draws the random part of the retreats.
    """
    width = space.upper - space.lower
    while (held.points.max(axis=0) - held.points.min(axis=0) > COLLAPSED * width).any():
        worst, best = held.worst, held.best
        others = np.concatenate([held.points[:worst], held.points[worst + 1 :]])
        for trial in _trials(held.points[worst], held.points[best], others.mean(axis=0), space, random):
            value = float(score(trial[None])[0])
            if value < held.merits[worst]:
                held.points[worst], held.merits[worst] = trial, value
                break
        else:
            return


def _trials(
    worst: FloatArray, best: FloatArray, centroid: FloatArray, space: DesignSpace, random: np.random.Generator
) -> Iterator[FloatArray]:
    """Yield the reflection of the worst point, then its retreats."""
    trial = space.clip(centroid + REFLECTION * (centroid - worst))
    yield trial
    for k in range(1, MOST_RETREATS + 1):
        share = (RETREAT_MEMORY / (RETREAT_MEMORY + k + 1)) ** ((RETREAT_MEMORY + k - 1) / RETREAT_MEMORY)
        target = share * centroid + (1 - share) * best
        scatter = (centroid - best) * (1 - share) * (2 * random.random() - 1)
        trial = space.clip((trial + target) / 2 + scatter)
        yield trial
