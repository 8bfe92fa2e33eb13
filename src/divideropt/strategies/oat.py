"""One variable at a time: each evenly over its range, the others where the campaign has them.

It is the study of section 3.4 of the thesis, `changeall.m` in C.2; a batch is one variable's sweep.
"""

from typing import Annotated

import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from divideropt.problem import Problem
from divideropt.strategies.base import STRICT, Evaluate


@dataclass(frozen=True, config=STRICT)
class OneAtATime:
    """Options of sweeps of one variable at a time."""

    points: Annotated[int, Field(ge=2, le=100_000)] = 100
    """Designs of each sweep, both ends counted: `nparam` of changeall.m."""

    def budget(self, variables: int) -> int:
        """Evaluations a run asks for; see `Strategy.budget`."""
        return self.points * variables

    def objection(self, variables: int, objectives: int) -> tuple[str, str] | None:
        """Suits any problem; see `Strategy.objection`."""
        return None

    def run(self, problem: Problem, evaluate: Evaluate, seed: int) -> None:
        """Ask for sweep after sweep; the seed decides nothing. See `Strategy.run`."""
        space = problem.space
        base = np.array([problem.fixed[name] for name in space.names])
        for i in range(len(space)):
            designs = np.tile(base, (self.points, 1))
            designs[:, i] = np.linspace(space.lower[i], space.upper[i], self.points)
            evaluate(designs)
