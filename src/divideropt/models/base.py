"""What every model offers: named parameters and quantities with units, and `evaluate` for a batch.

Anything with these three can be optimised, a user's own class included, which a campaign names as
`package.module:Class`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import Protocol, runtime_checkable

import numpy as np

from divideropt.ode.base import FloatArray

__all__ = [
    "VALIDITY",
    "Domain",
    "FloatArray",
    "Model",
    "Outcome",
    "Parameter",
    "Quantity",
    "Threaded",
    "Verdict",
    "Verifiable",
]


VALIDITY = "within_validity"
"""The quantity by which a model says whether its assumptions hold: 1 where they do, else 0."""


@dataclass(frozen=True)
class Domain:
    """An interval of permitted values.

    Attributes:
        lower: Smallest value, in the parameter's unit.
        upper: Largest value.
        open_lower: Whether `lower` itself is forbidden.
        open_upper: Whether `upper` itself is forbidden.
    """

    lower: float = -np.inf
    upper: float = np.inf
    open_lower: bool = False
    open_upper: bool = False

    def contains(self, value: float) -> bool:
        """Whether the value lies inside; NaN never does."""
        above = value > self.lower if self.open_lower else value >= self.lower
        below = value < self.upper if self.open_upper else value <= self.upper
        return bool(above and below and np.isfinite(value))

    def __str__(self) -> str:
        """Words such as `above 0 and at most 1`, for an error's sentence."""
        parts = []
        if np.isfinite(self.lower):
            parts.append(f"{'above' if self.open_lower else 'at least'} {self.lower:g}")
        if np.isfinite(self.upper):
            parts.append(f"{'below' if self.open_upper else 'at most'} {self.upper:g}")
        return " and ".join(parts) or "finite"


@dataclass(frozen=True)
class Parameter:
    """A named input of a model.

    Attributes:
        name: Name in files, tables and the API.
        unit: The unit inside, "" if it has none.
        symbol: Symbol in the equations.
        description: What it is, in a line.
        default: The value where nobody gives one.
        domain: What the model accepts.
        source: Where the default comes from.
    """

    name: str
    unit: str
    symbol: str
    description: str
    default: float
    domain: Domain
    source: str = ""


@dataclass(frozen=True)
class Quantity:
    """A named result of a model.

    Attributes:
        name: Name in files, tables and the API.
        unit: The unit inside, "" if it has none; percentages are numbers in "%".
        symbol: Symbol, or the equation's number.
        description: What it is, in a line.
        scale: A typical size, in `unit`; divides a violation where the bound is 0.
        signed: Whether objectives and constraints act on its magnitude, while tables hold it signed.
        logical: Whether it is 1 or 0, and tables say true or false.
    """

    name: str
    unit: str
    symbol: str
    description: str
    scale: float
    signed: bool = False
    logical: bool = False


class Outcome(StrEnum):
    """How the simulation of one design ended."""

    OK = "ok"
    NOT_COMPLETED = "not_completed"
    NO_EQUILIBRIUM = "no_equilibrium"
    UNSTABLE = "unstable"
    LIMIT_CYCLE = "limit_cycle"
    UNSETTLED = "unsettled"
    AT_STOP = "at_stop"
    TIMED_OUT = "timed_out"
    CRASHED = "crashed"


@dataclass(frozen=True)
class Verdict:
    """An outcome and the sentence that says what happened.

    Attributes:
        outcome: How it ended.
        text: A sentence a user can act on; empty for `ok`.
    """

    outcome: Outcome
    text: str = ""

    @property
    def ok(self) -> bool:
        """Whether the simulation ended well."""
        return self.outcome is Outcome.OK


class Model(Protocol):
    """A simulated component."""

    @property
    def parameters(self) -> Mapping[str, Parameter]:
        """Every input, in the order of a design's columns."""
        ...

    @property
    def quantities(self) -> Mapping[str, Quantity]:
        """Every result, in the order of a row of quantities."""
        ...

    def evaluate(self, designs: FloatArray) -> tuple[FloatArray, Sequence[Verdict]]:
        """Simulate a batch.

        Args:
            designs: Shape (n, d), one column a parameter, in the parameters' units.

        Returns:
            The quantities, shape (n, m), NaN where one is not defined, and a verdict a row.
        """
        ...


@runtime_checkable
class Verifiable(Model, Protocol):
    """A model that can be checked: it offers the same equations solved another way, and far more exactly."""

    def reference(self) -> Model:
        """Return the model by which this one is verified, with the same parameters and quantities."""
        ...


@runtime_checkable
class Threaded(Model, Protocol):
    """A model whose batches threads of one process can share, which spares the way to other processes."""

    def on_threads(self, threads: int) -> Model | None:
        """Return the same model on so many threads, with the same results bit for bit; None if it gains nothing."""
        ...
