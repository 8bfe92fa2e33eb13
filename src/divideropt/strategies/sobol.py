"""A Sobol' study's sample: Saltelli's blocks of a scrambled Sobol' sequence, by SALib.

Saltelli (2002), Computer Physics Communications 145, 280-297. A block is a row of A, that row with each variable in
turn from B, with second order the row of B with each from A too, and the row of B. A larger sample begins with the
smaller one.
"""

from typing import Annotated

from pydantic import AfterValidator, Field
from pydantic.dataclasses import dataclass

from divideropt.models.base import FloatArray
from divideropt.problem import DesignSpace, Problem
from divideropt.strategies.base import STRICT, Evaluate

BATCH = 64
"""Blocks in a batch: enough for several processes, and little to lose."""


def _power_of_two(samples: int) -> int:
    if samples & (samples - 1):
        above = 1 << samples.bit_length()
        raise ValueError(
            f"{samples} is no power of two, without which a Sobol' sequence is not balanced; write {above // 2} "
            f"or {above}"
        )
    return samples


@dataclass(frozen=True, config=STRICT)
class Sobol:
    """Options of a Sobol' study."""

    samples: Annotated[int, Field(ge=2, le=2**20), AfterValidator(_power_of_two)] = 4096
    """Blocks, a power of two; each has two designs more than there are variables, or with second order twice that."""
    second_order: bool = True
    """Whether indices of pairs are wanted."""

    def budget(self, variables: int) -> int:
        """Evaluations a run asks for; see `Strategy.budget`."""
        return self.samples * self.block(variables)

    def block(self, variables: int) -> int:
        """Return how many designs make a block with so many variables."""
        return (2 * variables + 2) if self.second_order else variables + 2

    def objection(self, variables: int, objectives: int) -> tuple[str, str] | None:
        """Suits any problem; see `Strategy.objection`."""
        return None

    def run(self, problem: Problem, evaluate: Evaluate, seed: int) -> None:
        """Ask for block after block, in batches that end at every power of two; see `Strategy.run`."""
        designs = self._sample(problem.space, seed)
        size, begin = self.block(len(problem.space)), 0
        while begin < self.samples:
            count = min(max(begin, 2), BATCH)
            evaluate(designs[begin * size : (begin + count) * size])
            begin += count

    def _sample(self, space: DesignSpace, seed: int) -> FloatArray:
        from SALib.sample import sobol  # noqa: PLC0415 (brings matplotlib with it)

        box = {"num_vars": len(space), "names": list(space.names), "bounds": [[0.0, 1.0]] * len(space)}
        unit: FloatArray = sobol.sample(box, self.samples, calc_second_order=self.second_order, seed=seed)
        return space.clip(space.lower + (space.upper - space.lower) * unit)
