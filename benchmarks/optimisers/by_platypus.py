"""Platypus's NSGA-II and NSGA-III, with its own handling of constraints."""

import random
from typing import Any

import numpy as np
from platypus import NSGAII, NSGAIII, Evaluator, Problem, Real

from .interview import Interview

FOR_EVER = 10**9
"""Evaluations: the recorder ends the run."""

DIVISIONS = {2: 99, 3: 12}
"""Of NSGA-III's reference directions, by the number of objectives: 100 and 91."""


def nsga2(interview: Interview, seed: int) -> None:
    """Platypus's defaults: population 100; SBX 1.0, η 15; polynomial mutation, η 20."""
    random.seed(seed)
    NSGAII(_problem(interview), evaluator=_Asking(interview)).run(FOR_EVER)


def nsga3(interview: Interview, seed: int) -> None:
    """100 directions, in three objectives 91, a population to match; the rest Platypus's defaults."""
    random.seed(seed)
    divisions = DIVISIONS[interview.objectives]
    NSGAIII(_problem(interview), divisions, evaluator=_Asking(interview)).run(FOR_EVER)


def _problem(interview: Interview) -> Any:
    problem = Problem(interview.variables, interview.objectives, interview.constraints)
    problem.types[:] = [Real(a, b) for a, b in zip(interview.lower.tolist(), interview.upper.tolist(), strict=True)]
    problem.constraints[:] = "<=0"
    return problem


class _Asking(Evaluator):  # type: ignore[misc]
    """Evaluates a generation in one batch."""

    def __init__(self, interview: Interview) -> None:
        super().__init__()
        self._interview = interview

    def evaluate_all(self, jobs: list[Any], **kwargs: object) -> list[Any]:
        told = self._interview(np.array([list(job.solution.variables) for job in jobs]))
        for job, objectives, constraints, violation in zip(
            jobs, told.F.tolist(), told.G.tolist(), told.violation.tolist(), strict=True
        ):
            solution = job.solution
            solution.objectives[:], solution.constraints[:] = objectives, constraints
            solution.constraint_violation, solution.feasible = violation, violation == 0.0
            solution.evaluated = True
        return jobs
