"""Objectives and constraints: what is asked of a model's quantities."""

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

    def value(self, column: FloatArray) -> FloatArray:
        """What is minimised, from a column of the quantity, same shape."""
        return np.abs(column) if self.quantity.signed else column


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

    def violations(self, column: FloatArray) -> FloatArray:
        """Measure the violations.

        Args:
            column: The quantity, shape (n,).

        Returns:
            A column a bound, shape (n, 1 or 2): positive where violated, divided by the bound, or by the
            quantity's scale where the bound is 0; NaN where the quantity is.
        """
        value = np.abs(column) if self.quantity.signed else column
        excess = []
        if self.minimum is not None:
            excess.append((self.minimum - value) / (abs(self.minimum) or self.quantity.scale))
        if self.maximum is not None:
            excess.append((value - self.maximum) / (abs(self.maximum) or self.quantity.scale))
        return np.column_stack(excess)
