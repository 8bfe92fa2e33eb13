"""What is done about failed designs in a sensitivity study, and which values that leaves of a quantity."""

from collections.abc import Iterator
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

from divideropt.models.base import FloatArray
from divideropt.problem import Problem
from divideropt.problem.criteria import Values

CONSTANT = 1e-12
"""A quantity that varies by no more than this part of its size is constant: the rest is rounding."""

OUTCOME = "outcome"
"""Stands among the quantities for 1 where a design's outcome is ok, else 0; no quantity has this name, a column
has."""


class Treatment(StrEnum):
    """What is done about failed designs."""

    ALL = "all"
    WORKING = "working"
    SIMULATED = "simulated"
    WORST = "worst"


MEANINGS = {
    Treatment.ALL: "every design, since none failed",
    Treatment.WORKING: "working designs only, by every pair of them in the sample",
    Treatment.SIMULATED: "failed designs with the values simulated for them, where these are defined",
    Treatment.WORST: "failed designs with the worst value of a working one",
}
"""The treatments in words."""


@dataclass(frozen=True)
class Treated:
    """The values of a quantity under one treatment.

    Attributes:
        treatment: What was done.
        values: Shape (n,).
        kept: Those that count, shape (n,).
    """

    treatment: Treatment
    values: FloatArray
    kept: NDArray[np.bool_]

    @property
    def constant(self) -> bool:
        """Whether the values that count are all the same, or there are none."""
        values = self.values[self.kept]
        return not len(values) or bool(np.ptp(values) <= CONSTANT * np.abs(values).max())


@dataclass(frozen=True)
class Undefined:
    """A quantity that has no indices, and why."""

    quantity: str
    treatment: Treatment
    reason: str


def treated(name: str, values: FloatArray, ok: NDArray[np.bool_], worst: float | None) -> Iterator[Treated]:
    """Yield a quantity's values under each treatment that makes a difference, the one to look at first.

    Args:
        name: The quantity.
        values: Shape (n,), NaN where not defined.
        ok: Whether each design's outcome is ok, shape (n,).
        worst: 1 where large values are bad, -1 where small ones are, None where neither is.
    """
    finite = np.isfinite(values)
    if name == OUTCOME or (ok.all() and finite.all()):
        yield Treated(Treatment.ALL, values, finite)
        return
    working = ok & finite
    yield Treated(Treatment.WORKING, values, working)
    if not ok.all():
        yield Treated(Treatment.SIMULATED, values, finite)
    if worst is not None and working.any():
        filled = np.where(working, values, worst * (worst * values[working]).max())
        yield Treated(Treatment.WORST, filled, np.ones(len(values), dtype=bool))


def quantity_columns(
    problem: Problem, quantities: FloatArray, ok: NDArray[np.bool_]
) -> Iterator[tuple[str, FloatArray]]:
    """Yield the outcome and then each quantity of a batch, shape (n, m), of signed ones the magnitude."""
    yield OUTCOME, ok.astype(np.float64)
    entries = problem.model.quantities
    for quantity in [*(o.quantity for o in problem.objectives), *entries.values()]:
        if quantity.name in entries:
            yield quantity.name, Values(list(entries), [quantity]).of(quantities)[:, 0]


def worst_sides(problem: Problem) -> dict[str, float]:
    """Say of objectives and constraints which side is bad: 1 large values, -1 small ones."""
    sides = {c.quantity.name: -1.0 for c in problem.constraints if c.maximum is None}
    sides |= {c.quantity.name: 1.0 for c in problem.constraints if c.minimum is None}
    return sides | {o.quantity.name: 1.0 for o in problem.objectives}
