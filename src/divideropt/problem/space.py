"""The design space: which parameters vary, and between what bounds."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from divideropt.models.base import FloatArray, Parameter


@dataclass(frozen=True)
class Variable:
    """One parameter that the optimiser chooses.

    Attributes:
        parameter: What it is.
        lower: Smallest value, in the parameter's unit.
        upper: Largest value.
    """

    parameter: Parameter
    lower: float
    upper: float


@dataclass(frozen=True)
class DesignSpace:
    """A box of variables.

    Attributes:
        variables: In the order of a design's columns.
    """

    variables: tuple[Variable, ...]

    def __len__(self) -> int:
        """Number of variables."""
        return len(self.variables)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """Names of the variables."""
        return tuple(v.parameter.name for v in self.variables)

    @cached_property
    def lower(self) -> FloatArray:
        """Lower bounds, shape (d,)."""
        return _constant([v.lower for v in self.variables])

    @cached_property
    def upper(self) -> FloatArray:
        """Upper bounds, shape (d,)."""
        return _constant([v.upper for v in self.variables])

    def clip(self, designs: FloatArray) -> FloatArray:
        """Move designs, shape (…, d), to the nearest point of the box."""
        return designs.clip(self.lower, self.upper)

    def sample(self, count: int, random: np.random.Generator) -> FloatArray:
        """Draw designs uniformly, shape (count, d)."""
        return self.lower + (self.upper - self.lower) * random.random((count, len(self)))


def _constant(values: list[float]) -> FloatArray:
    array = np.array(values)
    array.setflags(write=False)
    return array
