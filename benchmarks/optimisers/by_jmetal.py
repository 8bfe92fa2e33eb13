"""jMetalPy's NSGA-II, with the comparator that it has for constraints."""

import logging
import random
from typing import Any

import numpy as np
from jmetal.algorithm.multiobjective.nsgaii import NSGAII
from jmetal.core.problem import FloatProblem
from jmetal.operator.crossover import SBXCrossover
from jmetal.operator.mutation import PolynomialMutation
from jmetal.util.comparator import DominanceWithConstraintsComparator
from jmetal.util.evaluator import Evaluator
from jmetal.util.termination_criterion import StoppingByEvaluations

from .interview import Interview


def nsga2(interview: Interview, seed: int) -> None:
    """As in jMetalPy's examples: population 100; SBX 1.0, η 20; polynomial mutation 1/d, η 20."""
    logging.getLogger("jmetal").setLevel(logging.ERROR)
    random.seed(seed)
    np.random.seed(seed)  # noqa: NPY002 - jMetalPy draws from numpy's common generator
    NSGAII(
        problem=_Box(interview),
        population_size=100,
        offspring_population_size=100,
        mutation=PolynomialMutation(1.0 / interview.variables, 20),
        crossover=SBXCrossover(1.0, 20),
        termination_criterion=StoppingByEvaluations(10**9),
        population_evaluator=_Asking(interview),
        dominance_comparator=DominanceWithConstraintsComparator(),
    ).run()


class _Box(FloatProblem):  # type: ignore[misc]
    """The design space; what evaluates is the evaluator."""

    def __init__(self, interview: Interview) -> None:
        super().__init__()
        self._interview = interview
        self.lower_bound, self.upper_bound = interview.lower.tolist(), interview.upper.tolist()
        self.directions = [self.MINIMIZE] * interview.objectives

    def number_of_objectives(self) -> int:
        return self._interview.objectives

    def number_of_constraints(self) -> int:
        return self._interview.constraints

    def evaluate(self, solution: Any) -> Any:
        return _answered([solution], self._interview)[0]

    def name(self) -> str:
        return "box"


class _Asking(Evaluator):  # type: ignore[misc]
    """Evaluates a generation in one batch."""

    def __init__(self, interview: Interview) -> None:
        self._interview = interview

    def evaluate(self, solution_list: list[Any], problem: Any) -> list[Any]:
        return _answered(solution_list, self._interview)


def _answered(solutions: list[Any], interview: Interview) -> list[Any]:
    """Constraints are met where at least 0 there."""
    told = interview(np.array([s.variables for s in solutions]))
    for solution, objectives, constraints in zip(solutions, told.F.tolist(), (-told.G).tolist(), strict=True):
        solution.objectives, solution.constraints = objectives, constraints
    return solutions
