"""Integrals and crossings of the load flows after an event.

Integrals are Gauss–Lobatto sums over the solver's own steps, and crossings are located on the steps' polynomials:
nothing here depends on a grid of samples.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise

import numpy as np
from scipy.optimize import brentq

from divideropt.models.base import FloatArray
from divideropt.models.divider.response import Phase
from divideropt.ode.base import NODE_WEIGHTS, NODES, Trajectory, lagrange_weights

_FINE = lagrange_weights(np.linspace(0.0, 1.0, 33)).T


def largest_value(values: FloatArray) -> float:
    """Find the largest value of some states over a trajectory.

    Args:
        values: At the nodes, shape (k, s, NODES_PER_STEP).

    Returns:
        The largest, sought again between the nodes of the step that has it and of its neighbours.
    """
    step = int(np.argmax(values.max(axis=(1, 2))))
    return float(np.max(values[max(step - 1, 0) : step + 2] @ _FINE))


class FlowError:
    """The load flows after an event, over its phases, and what they add up to."""

    def __init__(self, phases: Sequence[Phase]) -> None:
        """Evaluate the flows at the nodes of every step."""
        runs = [(phase, phase.trajectory) for phase in phases if phase.trajectory is not None]
        if not runs or len(runs) < len(phases):
            raise ValueError("a phase that took no time, or was not reached, has no transient")
        self._phases = [phase for phase, run in runs for _ in range(len(run.values))]
        self._edges = np.concatenate([runs[0][1].edges[:1], *(run.edges[1:] for _, run in runs)])
        self._values = np.concatenate([run.values for _, run in runs])
        self._flows = np.concatenate([_flows_at_nodes(phase, run) for phase, run in runs])
        self.begin = float(self._edges[0])

    def settled_at(self, final: float, band: float) -> float | None:
        """Time [s] from which QL1 stays within `band`·`final` of `final`; None if it ends outside."""
        outside = np.abs(self._flows[..., 0] - final) > band * final
        steps, nodes = np.nonzero(outside)
        if len(steps) == 0:
            return self.begin
        step, node = int(steps[-1]), int(nodes[-1])
        if node == len(NODES) - 1:
            return None if step == len(outside) - 1 else float(self._edges[step + 1])

        def beyond(theta: float) -> float:
            return abs(float(self._flow(step, np.array([theta]))[0, 0]) - final) - band * final

        return float(self._time(step, np.array(_root(beyond, NODES[node], NODES[node + 1]))))

    def integrals(self, reference: float, until: float) -> tuple[float, float]:
        """Integrate QL1 - QL2 less a reference, and its magnitude, from the event on.

        Args:
            reference: What to take off [m^3/s].
            until: Upper limit [s], within the phase.

        Returns:
            The two integrals [m^3].
        """
        widths = np.diff(self._edges)
        whole = int(np.searchsorted(self._edges, until, side="right")) - 1
        error = self._flows[:whole, :, 0] - self._flows[:whole, :, 1] - reference
        sums = error @ NODE_WEIGHTS * widths[:whole]
        one_sided = (error.min(axis=1) >= 0.0) | (error.max(axis=1) <= 0.0)
        magnitudes = np.abs(sums)
        for step in np.flatnonzero(~one_sided):
            magnitudes[step] = self._magnitude(int(step), 1.0, reference)
        signed, magnitude = float(sums.sum()), float(magnitudes.sum())
        if whole < len(widths) and until > self._edges[whole]:
            part = float((until - self._edges[whole]) / widths[whole])
            signed += self._between(whole, 0.0, part, reference)
            magnitude += self._magnitude(whole, part, reference)
        return signed, magnitude

    def _magnitude(self, step: int, end: float, reference: float) -> float:
        """Integrate the magnitude over [0, end] of a step, piece by piece between its zeros."""

        def error(theta: float) -> float:
            flows = self._flow(step, np.array([theta]))[0]
            return float(flows[0] - flows[1] - reference)

        places = NODES * end
        signs = [error(float(theta)) for theta in places]
        cuts = [0.0]
        for (left, at_left), (right, at_right) in pairwise(zip(places, signs, strict=True)):
            if at_left * at_right < 0.0:
                cuts.append(_root(error, float(left), float(right)))
        cuts.append(end)
        return sum(abs(self._between(step, a, b, reference)) for a, b in pairwise(cuts))

    def _between(self, step: int, left: float, right: float, reference: float) -> float:
        """Integrate the signed error over a part of a step."""
        flows = self._flow(step, left + (right - left) * NODES)
        error = flows[:, 0] - flows[:, 1] - reference
        return float(error @ NODE_WEIGHTS * (right - left) * (self._edges[step + 1] - self._edges[step]))

    def _flow(self, step: int, theta: FloatArray) -> FloatArray:
        """Load flows at places on a step, shape (m, 2)."""
        states = lagrange_weights(theta) @ self._values[step].T
        return self._phases[step].load_flows(states, self._time(step, theta))

    def _time(self, step: int, theta: FloatArray) -> FloatArray:
        return np.asarray(self._edges[step] + theta * (self._edges[step + 1] - self._edges[step]))


def _flows_at_nodes(phase: Phase, run: Trajectory) -> FloatArray:
    """Load flows at the nodes of every step of a phase, shape (k, NODES_PER_STEP, 2)."""
    times = run.edges[:-1, None] + np.diff(run.edges)[:, None] * NODES
    return phase.load_flows(np.swapaxes(run.values, 1, 2), times)


def _root(function: Callable[[float], float], left: float, right: float) -> float:
    """Root between two places of different sign, or the right one where rounding hides the change."""
    if function(left) * function(right) > 0.0:
        return right
    return float(brentq(function, left, right, xtol=1e-14, rtol=1e-13))
