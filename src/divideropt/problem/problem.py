"""The adapter from a model to an optimiser.

Simulated results are logged as they are. What an optimiser is told is derived from them afresh each time, so a
log answers exactly as the simulation did, and no penalty is ever logged.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from divideropt.models.base import FloatArray, Model, Verdict
from divideropt.problem.criteria import Constraint, Objective
from divideropt.problem.simulation import simulate
from divideropt.problem.space import DesignSpace

FAILED_OBJECTIVE = 1e4
"""What an optimiser is told of each objective of a failed design, in scales of the quantity: finite, since pymoo
ranks NaN first, and beyond what an honest design reaches."""

LARGEST_VIOLATION = 1e6
"""Cap of one constraint's relative violation, so that a failed design outranks any sum of them."""

FAILURE_VIOLATION = 1e9
"""Violation of the failure constraint by a design whose outcome is not ok."""

INFEASIBLE_MERIT = 1e9
"""Merit at which infeasible designs begin: beyond any aggregate of a working valve, and small enough that a
violation of 1e-6 is not lost beside it."""


@dataclass(frozen=True)
class Evaluations:
    """A batch as simulated.

    Attributes:
        designs: Shape (n, d), in the variables' units.
        quantities: Shape (n, m), in the quantities' units, NaN where one is not defined.
        verdicts: One a design.
    """

    designs: FloatArray
    quantities: FloatArray
    verdicts: Sequence[Verdict]

    def __len__(self) -> int:
        """Number of designs."""
        return len(self.designs)


@dataclass(frozen=True)
class Told:
    """A batch as an optimiser sees it; every number is finite.

    Attributes:
        F: Objectives, to be minimised, shape (n, k).
        G: Constraints, met where at most 0, shape (n, 1 + c); the first is the failure constraint.
    """

    F: FloatArray
    G: FloatArray

    @property
    def violation(self) -> FloatArray:
        """Sum of the violations, shape (n,); 0 where feasible."""
        return np.asarray(np.maximum(self.G, 0.0).sum(axis=1))

    @property
    def feasible(self) -> NDArray[np.bool_]:
        """Whether the outcome is ok and every constraint met, shape (n,)."""
        return np.asarray(self.violation == 0.0)


@dataclass(frozen=True)
class Problem:
    """What is optimised.

    Attributes:
        model: Simulates designs.
        fixed: The model's parameters by name, in its units; the variables replace theirs.
        space: The variables and their bounds.
        objectives: At least one.
        constraints: Any number.
    """

    model: Model
    fixed: Mapping[str, float]
    space: DesignSpace
    objectives: tuple[Objective, ...]
    constraints: tuple[Constraint, ...] = ()

    @property
    def constraint_count(self) -> int:
        """Number of columns of `Told.G`."""
        return 1 + sum((c.minimum is not None) + (c.maximum is not None) for c in self.constraints)

    def simulate(self, designs: FloatArray) -> Evaluations:
        """Run the model.

        Args:
            designs: Shape (n, d), in the variables' units.

        Returns:
            What came out.
        """
        quantities, verdicts = simulate(self.model, self.fixed, self.space.names, designs)
        return Evaluations(designs, quantities, verdicts)

    def tell(self, evaluations: Evaluations) -> Told:
        """Word a batch for an optimiser: penalties for failures, violations for constraints."""
        ok = np.array([v.ok for v in evaluations.verdicts], dtype=bool)
        column = {name: evaluations.quantities[:, i] for i, name in enumerate(self.model.quantities)}
        F = np.column_stack([o.value(column[o.quantity.name]) for o in self.objectives])
        ok &= np.isfinite(F).all(axis=1)
        F = np.where(ok[:, None], F, [FAILED_OBJECTIVE * o.quantity.scale for o in self.objectives])
        failure = np.where(ok, 0.0, FAILURE_VIOLATION)[:, None]
        G = np.column_stack([failure, *(c.violations(column[c.quantity.name]) for c in self.constraints)])
        G = np.where(np.isnan(G), LARGEST_VIOLATION, G)
        G[:, 1:] = np.clip(G[:, 1:], -LARGEST_VIOLATION, LARGEST_VIOLATION)
        return Told(F, G)


def merit(value: FloatArray, told: Told) -> FloatArray:
    """Order designs for a method that knows one number only.

    Args:
        value: An aggregate of the objectives, shape (n,).
        told: The batch.

    Returns:
        The value where feasible, at most `INFEASIBLE_MERIT`; elsewhere that and the violation. Shape (n,).
    """
    return np.where(told.feasible, np.minimum(value, INFEASIBLE_MERIT), INFEASIBLE_MERIT + told.violation)
