"""The contract of a strategy.

A strategy is a deterministic function of its seed and of what it has been told: no clock, no unseeded
generator, and no decision that depends on its budget, so that a larger budget extends a run. It is written as
`run(problem, evaluate, seed)`, and whoever calls it may answer `evaluate` from a log: that is how a store is
resumed.
"""

from collections.abc import Callable
from typing import Annotated, Literal, Protocol

from pydantic import ConfigDict, Field

from divideropt.models.base import FloatArray
from divideropt.problem import Problem, Told

Evaluate = Callable[[FloatArray], Told]
"""Designs, shape (n, d), in the variables' units, to what the optimiser is told of them."""

STRICT = ConfigDict(extra="forbid", strict=True)
"""Options come from a campaign's file, where a string for a number is a mistake."""

Count = Annotated[int, Field(ge=1, le=10**9)]
"""A budget or a size."""

AggregateName = Literal["goal_attainment", "power_sum"]
"""How several objectives become one: (3.24), or the power sum of C.5."""


class Strategy(Protocol):
    """A method of optimisation with its options."""

    def budget(self, variables: int) -> int:
        """Most evaluations a run asks for, of a problem with so many variables."""
        ...

    def objection(self, variables: int, objectives: int) -> tuple[str, str] | None:
        """Say which option does not suit a problem of that size.

        Args:
            variables: Number of variables.
            objectives: Number of objectives.

        Returns:
            The option and a sentence with the remedy, or None.
        """
        ...

    def run(self, problem: Problem, evaluate: Evaluate, seed: int) -> None:
        """Ask for designs until the budget is spent.

        Args:
            problem: What is optimised: its variables' bounds, objectives and constraints.
            evaluate: Answers a batch, shape (n, d); every row counts as an evaluation.
            seed: Seeds every random draw.
        """
        ...


class BudgetSpentError(Exception):
    """The next batch would exceed the budget; a run ends here."""


def within_budget(evaluate: Evaluate, budget: int) -> Evaluate:
    """Count evaluations and end the run before a batch that would exceed the budget.

    A batch is never cut short: the same run with a larger budget asks for the same batches.

    Args:
        evaluate: What answers.
        budget: Most evaluations.

    Returns:
        The same, but raising `BudgetSpentError` when the budget is spent.
    """
    spent = 0

    def counted(designs: FloatArray) -> Told:
        nonlocal spent
        if spent + len(designs) > budget:
            raise BudgetSpentError
        spent += len(designs)
        return evaluate(designs)

    return counted
