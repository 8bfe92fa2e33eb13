"""A sweep of goal-attainment problems over reference directions.

Each direction w asks for the least γ with F_i - w_i γ ≤ F*_i, objectives scaled between the ideal and the nadir
point of what has been found so far (Gembicki 1974); the complex method solves it, warm-started from its neighbour.
A small multiple of the sum is added, so that weakly optimal points lose (Wierzbicki's augmentation).
"""

from itertools import count
from typing import Annotated

import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from divideropt.models.base import FloatArray
from divideropt.problem import Problem, merit
from divideropt.strategies.archive import Archive
from divideropt.strategies.base import STRICT, BudgetSpentError, Count, Evaluate, within_budget
from divideropt.strategies.complex_method import Complex, search
from divideropt.strategies.directions import reference_directions

AUGMENTATION = 1e-3
"""ρ: what the sum of the scaled objectives counts beside their maximum."""

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
        archive = Archive(problem, within_budget(evaluate, self.evaluations))
        directions = reference_directions(len(problem.objectives), self.directions)
        try:
            archive.score(problem.space.sample(FIRST_SAMPLE * len(problem.space), random))
            for _ in count():
                for direction in directions:
                    _visit(direction, archive, problem, random)
        except BudgetSpentError:
            return


def _visit(direction: FloatArray, archive: Archive, problem: Problem, random: np.random.Generator) -> None:
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
