"""A Morris study's sample: trajectories that change one variable after the other, by SALib.

Morris (1991), Technometrics 33, 161-174. More trajectories begin with the fewer.
"""

from typing import Annotated

from pydantic import AfterValidator, Field
from pydantic.dataclasses import dataclass

from divideropt.models.base import FloatArray
from divideropt.problem import DesignSpace, Problem
from divideropt.strategies.base import STRICT, Evaluate


def _even(levels: int) -> int:
    if levels % 2:
        raise ValueError(
            f"{levels} is odd, and only with an even number is every level as likely; write {levels + 1}"
        )
    return levels


TOGETHER = 10
"""Trajectories in a batch: enough for several processes."""


def _in_tens(trajectories: int) -> int:
    if trajectories % TOGETHER:
        above = trajectories + TOGETHER - trajectories % TOGETHER
        raise ValueError(
            f"{trajectories} is not a multiple of {TOGETHER}, as many as are simulated together; write {above}"
        )
    return trajectories


@dataclass(frozen=True, config=STRICT)
class Morris:
    """Options of a Morris study."""

    trajectories: Annotated[int, Field(ge=10, le=100_000), AfterValidator(_in_tens)] = 100
    """A multiple of 10; each has one design more than there are variables."""
    levels: Annotated[int, Field(ge=4, le=100), AfterValidator(_even)] = 8
    """Values that a variable takes, evenly over its range."""

    def budget(self, variables: int) -> int:
        """Evaluations a run asks for; see `Strategy.budget`."""
        return self.trajectories * (variables + 1)

    def objection(self, variables: int, objectives: int) -> tuple[str, str] | None:
        """Suits any problem; see `Strategy.objection`."""
        return None

    def run(self, problem: Problem, evaluate: Evaluate, seed: int) -> None:
        """Ask for some trajectories at a time; see `Strategy.run`."""
        designs, length = self._sample(problem.space, seed), len(problem.space) + 1
        step = TOGETHER * length
        for begin in range(0, len(designs), step):
            evaluate(designs[begin : begin + step])

    def _sample(self, space: DesignSpace, seed: int) -> FloatArray:
        from SALib.sample import morris  # noqa: PLC0415 (brings matplotlib with it)

        box = {"num_vars": len(space), "names": list(space.names), "bounds": [[0.0, 1.0]] * len(space)}
        unit: FloatArray = morris.sample(box, self.trajectories, num_levels=self.levels, seed=seed)
        return space.clip(space.lower + (space.upper - space.lower) * unit)
