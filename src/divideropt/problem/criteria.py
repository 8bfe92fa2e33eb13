"""Objectives and constraints: what is asked of a model's quantities, and how a batch of them is read."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from divideropt.models.base import FloatArray, Quantity


@dataclass(frozen=True)
class Objective:
    """A quantity to be made small.

    Attributes:
        quantity: Which one; a signed quantity counts by its magnitude.
        goal: F* of (3.24), in the quantity's unit, or None.
        weight: w of (3.24); a greater one matters more.
    """

    quantity: Quantity
    goal: float | None = None
    weight: float = 1.0


@dataclass(frozen=True)
class Constraint:
    """Inclusive bounds on a quantity.

    Attributes:
        quantity: Which one; a signed quantity counts by its magnitude.
        minimum: Smallest permitted value, in the quantity's unit, or None.
        maximum: Largest permitted value, or None.
    """

    quantity: Quantity
    minimum: float | None = None
    maximum: float | None = None


class Values:
    """Columns of a batch of quantities, of signed ones the magnitudes."""

    def __init__(self, quantities: Sequence[str], wanted: Sequence[Quantity]) -> None:
        """Find the columns.

        Args:
            quantities: Names of a model's quantities, in their order.
            wanted: Those to be read, in any order, also several times.
        """
        places = {name: i for i, name in enumerate(quantities)}
        self._columns = np.array([places[q.name] for q in wanted], dtype=np.intp)
        self._signed = np.array([i for i, q in enumerate(wanted) if q.signed], dtype=np.intp)

    def of(self, quantities: FloatArray) -> FloatArray:
        """Read a batch, shape (n, m), to shape (n, number wanted)."""
        values = quantities.take(self._columns, axis=1)
        if len(self._signed):
            values[:, self._signed] = np.abs(values[:, self._signed])
        return values


class Bounds:
    """The bounds of several constraints, the lower of each before its upper."""

    def __init__(self, quantities: Sequence[str], constraints: Sequence[Constraint]) -> None:
        """Lay the bounds out; `quantities` are the names of a model's, in their order."""
        sides = (
            (c.quantity, side, bound) for c in constraints for side, bound in ((1.0, c.minimum), (-1.0, c.maximum))
        )
        given = [(q, side, bound) for q, side, bound in sides if bound is not None]
        self._values = Values(quantities, [q for q, _, _ in given])
        self._sides = np.array([side for _, side, _ in given])
        self._bounds = np.array([side * bound for _, side, bound in given])
        self._sizes = np.array([abs(bound) or q.scale for q, _, bound in given])

    def __len__(self) -> int:
        """Number of bounds."""
        return len(self._sides)

    def violations(self, quantities: FloatArray) -> FloatArray:
        """Measure the violations of a batch of quantities, shape (n, m).

        Returns:
            A column a bound, shape (n, len(self)): positive where violated, divided by the bound, or by the
            quantity's scale where the bound is 0; NaN where the quantity is.
        """
        return np.asarray((self._bounds - self._sides * self._values.of(quantities)) / self._sizes)
