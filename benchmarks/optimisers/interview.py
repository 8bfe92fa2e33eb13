"""What a peer is told: objectives of one scale, and constraints in the form that it understands."""

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.problem import Problem, Told
from divideropt.strategies import Evaluate

BEYOND = 1e4
"""Added to each objective of an infeasible design where a peer has no constraints: more than any objective."""


class Interview:
    """The recorder as a peer sees it. Objectives are told over `scale`, since some peers compare one with another."""

    def __init__(self, problem: Problem, evaluate: Evaluate, scale: FloatArray) -> None:
        """Let `evaluate` answer."""
        self.problem, self.scale = problem, scale
        self.lower, self.upper = problem.space.lower, problem.space.upper
        self.variables, self.objectives = len(problem.space), len(problem.objectives)
        self.constraints = problem.constraint_count
        self._evaluate = evaluate

    def __call__(self, designs: FloatArray) -> Told:
        """Answer designs, shape (n, d)."""
        told = self._evaluate(np.ascontiguousarray(designs, dtype=np.float64))
        return Told(told.F / self.scale, told.G)

    def penalised(self, designs: FloatArray) -> FloatArray:
        """Answer with objectives alone, shape (n, k).

        All objectives of an infeasible design are the same, `BEYOND` and the sum of its violations. Any feasible
        design dominates it, and of two infeasible ones the less violated dominates: Deb's rule by dominance alone.
        """
        told = self(designs)
        return np.where(told.feasible[:, None], told.F, BEYOND + told.violation[:, None])
