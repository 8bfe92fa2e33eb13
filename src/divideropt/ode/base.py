"""What every ODE solver here offers: settings, and a trajectory that knows the states between its steps."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]
Rates = Callable[[float, FloatArray], FloatArray]
Event = Callable[[FloatArray], float]

NODES_PER_STEP = 8
"""Nodes on a step: the polynomial through them is of degree 7, above the order of every stiff method here."""


@dataclass(frozen=True)
class SolverSettings:
    """How to integrate.

    Attributes:
        method: Name of the solver.
        rtol: Relative tolerance.
        atol: Absolute tolerance a state, shape (n,).
        max_steps: Budget of accepted steps between two events; a chattering design ends there.
    """

    method: str
    rtol: float
    atol: tuple[float, ...]
    max_steps: int


class SolverStatus(StrEnum):
    """How an integration ended."""

    FINISHED = "finished"
    EVENT = "event"
    STEP_BUDGET = "step budget"
    FAILED = "failed"


@dataclass(frozen=True)
class Trajectory:
    """States over an interval, a polynomial a step.

    Attributes:
        edges: Step boundaries, shape (k + 1,), strictly increasing.
        values: States at the nodes of each step, shape (k, n, NODES_PER_STEP); the first node of a step is its
            left edge, the last its right.
        status: How the integration ended; after FAILED or STEP_BUDGET the last edge is where it gave up, unless not
            even one step was taken.
        message: What the solver said then.
    """

    edges: FloatArray
    values: FloatArray
    status: SolverStatus
    message: str = ""

    @property
    def final(self) -> FloatArray:
        """State at the last edge, shape (n,)."""
        return self.values[-1, :, -1]

    def then(self, later: "Trajectory") -> "Trajectory":
        """Append a trajectory that begins where this one ends."""
        return Trajectory(
            np.concatenate([self.edges, later.edges[1:]]),
            np.concatenate([self.values, later.values]),
            later.status,
            later.message,
        )

    def at(self, times: FloatArray) -> FloatArray:
        """Interpolate.

        Args:
            times: Shape (m,), within the edges; at an edge the earlier step answers.

        Returns:
            States, shape (m, n).
        """
        step = np.clip(np.searchsorted(self.edges, times, side="left") - 1, 0, len(self.edges) - 2)
        theta = (times - self.edges[step]) / (self.edges[step + 1] - self.edges[step])
        return np.asarray(np.einsum("mj,mnj->mn", lagrange_weights(theta), self.values[step]))


def lagrange_weights(theta: FloatArray) -> FloatArray:
    """Weights of the nodes for the interpolating polynomial, by the barycentric formula.

    Args:
        theta: Places on a step, 0 at its left edge and 1 at its right, shape (m,).

    Returns:
        Weights, shape (m, NODES_PER_STEP); each row sums to 1.
    """
    gap = theta[:, None] - NODES
    exact = gap == 0.0
    terms = _BARYCENTRIC / np.where(exact, 1.0, gap)
    rows = exact.any(axis=1)
    terms[rows] = exact[rows]
    return np.asarray(terms / terms.sum(axis=1, keepdims=True))


def crossing(event: Event, values: FloatArray) -> float:
    """Find where on a step an event that is positive at its end has become so.

    Args:
        event: A function of the state.
        values: States at the nodes of the step, shape (n, NODES_PER_STEP).

    Returns:
        The place, in (0, 1].
    """
    from scipy.optimize import brentq  # noqa: PLC0415 (late: only a rigid stop needs it)

    def at(theta: float) -> float:
        return event(values @ lagrange_weights(np.array([theta]))[0])

    return 1.0 if at(0.0) >= 0.0 else float(brentq(at, 0.0, 1.0))


def _lobatto(n: int) -> tuple[FloatArray, FloatArray]:
    """Nodes and weights of Gauss–Lobatto–Legendre quadrature on [0, 1], exact to degree 2n - 3."""
    legendre = np.polynomial.legendre.Legendre.basis(n - 1)
    x = np.concatenate(([-1.0], legendre.deriv().roots().real, [1.0]))
    return (x + 1) / 2, 1.0 / (n * (n - 1) * legendre(x) ** 2)


NODES, NODE_WEIGHTS = _lobatto(NODES_PER_STEP)
"""Gauss–Lobatto nodes on a step of length 1, and the weights that integrate over it."""

_BARYCENTRIC = 1.0 / np.prod(NODES[:, None] - NODES + np.eye(NODES_PER_STEP), axis=1)
