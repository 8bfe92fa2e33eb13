"""The adapter from a model to an optimiser.

Simulated results are logged as they are. What an optimiser is told is derived from them afresh each time, so a
log answers exactly as the simulation did, and no penalty is ever logged.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from divideropt.models.base import FloatArray, Model, Threaded, Verdict
from divideropt.problem.criteria import Bounds, Constraint, Objective, Values
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

    def part(self, begin: int, end: int) -> "Evaluations":
        """Return some of the designs, sharing their numbers with the whole."""
        return Evaluations(self.designs[begin:end], self.quantities[begin:end], self.verdicts[begin:end])

    @classmethod
    def together(cls, batches: "Sequence[Evaluations]") -> "Evaluations":
        """Return several batches as one, at least one."""
        return cls(
            np.concatenate([batch.designs for batch in batches]),
            np.concatenate([batch.quantities for batch in batches]),
            [verdict for batch in batches for verdict in batch.verdicts],
        )


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
        return 1 + len(self._bounds)

    def simulate(self, designs: FloatArray) -> Evaluations:
        """Run the model.

        Args:
            designs: Shape (n, d), in the variables' units.

        Returns:
            What came out.
        """
        quantities, verdicts = simulate(self.model, self.fixed, self.space.names, designs)
        return Evaluations(designs, quantities, verdicts)

    def on_threads(self, threads: int) -> "Problem | None":
        """Return the same problem with a model whose batches so many threads share; None if it gains nothing."""
        model = self.model.on_threads(threads) if isinstance(self.model, Threaded) else None
        return None if model is None else replace(self, model=model)

    def tell(self, evaluations: Evaluations) -> Told:
        """Word a batch for an optimiser: penalties for failures, violations for constraints."""
        F = self._values.of(evaluations.quantities)
        ok = np.array([v.ok for v in evaluations.verdicts], dtype=bool) & np.isfinite(F).all(axis=1)
        F = np.where(ok[:, None], F, self._failed)
        violations = self._bounds.violations(evaluations.quantities)
        violations[np.isnan(violations)] = LARGEST_VIOLATION
        G = np.empty((len(F), self.constraint_count))
        G[:, 0] = np.where(ok, 0.0, FAILURE_VIOLATION)
        np.clip(violations, -LARGEST_VIOLATION, LARGEST_VIOLATION, out=G[:, 1:])
        return Told(F, G)

    @cached_property
    def _values(self) -> Values:
        return Values(list(self.model.quantities), [o.quantity for o in self.objectives])

    @cached_property
    def _failed(self) -> FloatArray:
        """What is told of the objectives of a failed design, shape (k,)."""
        return np.array([FAILED_OBJECTIVE * o.quantity.scale for o in self.objectives])

    @cached_property
    def _bounds(self) -> Bounds:
        return Bounds(list(self.model.quantities), self.constraints)


def merit(value: FloatArray, told: Told) -> FloatArray:
    """Order designs for a method that knows one number only.

    Args:
        value: An aggregate of the objectives, shape (n,).
        told: The batch.

    Returns:
        The value where feasible, at most `INFEASIBLE_MERIT`; elsewhere that and the violation. Shape (n,).
    """
    return np.where(told.feasible, np.minimum(value, INFEASIBLE_MERIT), INFEASIBLE_MERIT + told.violation)
