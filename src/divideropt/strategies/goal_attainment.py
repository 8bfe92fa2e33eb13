"""A sweep of goal-attainment problems over reference directions.

Each direction w asks for the least γ with F_i - w_i γ ≤ F*_i (Gembicki 1974), objectives scaled by what has been
found so far: from the ideal to the nadir point where the complex method solves it, from a utopian to a middle point
where SciPy's methods do (`gembicki.py`). Every visit begins at the best known for its direction, most often a
neighbour's answer. A small multiple of the sum is added, so that weakly optimal points lose (Wierzbicki's
augmentation).
"""

from contextlib import suppress
from functools import partial
from itertools import count
from typing import Annotated, Literal

import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from divideropt.models.base import FloatArray
from divideropt.problem import Problem, Told, merit
from divideropt.strategies.archive import Archive
from divideropt.strategies.base import STRICT, BudgetSpentError, Count, Evaluate, within_budget
from divideropt.strategies.complex_method import Complex, search
from divideropt.strategies.directions import reference_directions
from divideropt.strategies.gembicki import Goal, Solver, attain

AUGMENTATION = 1e-3
"""Default of ρ: enough to tell weakly optimal designs apart, too little to move an answer by more than 1 %."""

FIRST_SAMPLE = 10
"""Random designs a variable, from which the sweep sets out."""

VISIT = 5
"""Evaluations a variable that a direction gets at each visit; the sweep comes round again while the budget lasts,
and no visit depends on how often that will be."""

NEIGHBOURHOOD = (0.02, 0.3)
"""Between these parts of the box, at each visit drawn anew, lies the half width from which the points of a
warm-started complex are taken: large ones find, small ones polish."""


VISIT_BY_SLOPES = 20
"""The same for SciPy's methods, which need some ten slopes; they mostly end by themselves before."""

FINEST = 100_000
"""Most directions of a round of SciPy's methods: what they have solved they cannot improve, so each of their rounds
has twice as fine a lattice as the one before."""


@dataclass(frozen=True, config=STRICT)
class GoalAttainment:
    """Options of the sweep."""

    directions: Annotated[int, Field(ge=3, le=10_000)] = 91
    """Reference directions, spread evenly (Das and Dennis); the largest such set of at most this many."""
    evaluations: Count = 9000
    """Budget of evaluations."""
    solver: Literal["complex", "slsqp", "trust-constr"] = "complex"
    """What solves a direction's problem: the complex method, or SciPy's methods with differences for slopes."""
    augmentation: Annotated[float, Field(ge=0.0, le=1.0)] = AUGMENTATION
    """ρ: what the sum of the scaled objectives counts beside their maximum."""

    def budget(self, variables: int) -> int:
        """Most evaluations a run asks for; see `Strategy.budget`."""
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
        sweep = _Sweep(problem, Archive(problem, within_budget(evaluate, self.evaluations)), seed, self.augmentation)
        visit = sweep.by_complex if self.solver == "complex" else partial(sweep.by_slopes, solver=self.solver)
        objectives = len(problem.objectives)
        most = self.directions if self.solver == "complex" else objectives
        try:
            sweep.sample(FIRST_SAMPLE * len(problem.space))
            for _ in count():
                for direction in reference_directions(objectives, most):
                    visit(direction)
                if self.solver != "complex" and objectives > 1:
                    most = min(most * 2 ** (objectives - 1), FINEST)
        except BudgetSpentError:
            return


class _Sweep:
    """The archive, and the visits to directions."""

    def __init__(self, problem: Problem, archive: Archive, seed: int, augmentation: float) -> None:
        self._space, self._archive, self._augmentation = problem.space, archive, augmentation
        self._random = np.random.default_rng(seed)

    def sample(self, size: int) -> None:
        """Evaluate random designs."""
        self._archive.score(self._space.sample(size, self._random))

    def by_complex(self, direction: FloatArray) -> None:
        """Improve the answer to one direction's problem by a complex around the best known."""
        self._archive.settle()
        ideal, span = self._archive.ideal_and_span()

        def attainment(F: FloatArray) -> FloatArray:
            scaled = (F - ideal) / span / direction
            return np.asarray(scaled.max(axis=1) + self._augmentation * scaled.sum(axis=1))

        grant = self._grant(VISIT)

        def score(designs: FloatArray) -> FloatArray:
            told = grant(designs)
            return merit(attainment(told.F), told)

        space, (nearest, known) = self._space, self._archive.nearest(attainment)
        reach = np.exp(self._random.uniform(*np.log(NEIGHBOURHOOD))) * (space.upper - space.lower)
        scatter = 2 * self._random.random((2 * len(space) - 1, len(space))) - 1
        fresh = space.clip(nearest + reach * scatter)
        with suppress(_VisitOverError):
            points = np.concatenate([nearest[None], fresh])
            search(Complex(points, np.concatenate([[known], score(fresh)])), score, space, self._random)

    def by_slopes(self, direction: FloatArray, solver: Solver) -> None:
        """Improve it from the best known along slopes; before anything is feasible, by a complex."""
        self._archive.settle()
        if not self._archive.feasible:
            self.by_complex(direction)
            return
        goal = Goal(direction, self._archive.scale(), self._augmentation)
        with suppress(_VisitOverError):
            attain(self._archive.nearest(goal.of)[0], goal, self._space, self._grant(VISIT_BY_SLOPES), solver)

    def _grant(self, visit: int) -> Evaluate:
        """Evaluate up to so many designs a variable."""
        left = visit * len(self._space)

        def score(designs: FloatArray) -> Told:
            nonlocal left
            if len(designs) > left:
                raise _VisitOverError
            left -= len(designs)
            return self._archive.score(designs)

        return score


class _VisitOverError(Exception):
    """A visit's evaluations are spent."""
