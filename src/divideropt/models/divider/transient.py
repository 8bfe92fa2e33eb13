"""Integrals and crossings of the load flows after an event.

Integrals are Gauss–Lobatto sums over the solver's own steps, and crossings are located on the steps' polynomials:
nothing here depends on a grid of samples.
"""

import math
from collections.abc import Sequence

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.models.divider.kernels import STATES, load_flows
from divideropt.models.divider.response import Phase
from divideropt.ode.base import NODE_WEIGHTS, NODES, lagrange_weights
from divideropt.ode.compiled import compiled
from divideropt.ode.interpolate import interpolate

BISECTIONS = 60
"""Halvings of the distance between two nodes: to the last bit."""

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
        self._designs = np.concatenate([phase.design for phase, _ in runs])
        self._which = np.repeat(np.arange(len(runs)), [len(run.values) for _, run in runs])
        self._edges = np.concatenate([runs[0][1].edges[:1], *(run.edges[1:] for _, run in runs)])
        pressures = [np.ascontiguousarray(run.values[:, _LOADS]) for _, run in runs]
        self._pressures = np.concatenate(pressures)
        self._flows = node_flows(self._edges, self._pressures, self._designs, self._which)
        self.begin = float(self._edges[0])

    def settled_at(self, final: float, band: float) -> float | None:
        """Time [s] from which QL1 stays within `band`·`final` of `final`; None if it ends outside."""
        found = settled(self._edges, self._pressures, self._flows, self._designs, self._which, final, band)
        return None if np.isnan(found) else float(found)

    def integrals(self, reference: float, until: float) -> tuple[float, float]:
        """Integrate QL1 - QL2 less a reference, and its magnitude, from the event on.

        Args:
            reference: What to take off [m^3/s].
            until: Upper limit [s], within the phases.

        Returns:
            The two integrals [m^3].
        """
        return integrals(self._edges, self._pressures, self._flows, self._designs, self._which, reference, until)  # type: ignore[no-any-return]


_LOADS = slice(STATES.index("PL1"), STATES.index("PL2") + 1)


@compiled
def node_flows(edges, pressures, designs, which):  # type: ignore[no-untyped-def]
    """Return the load flows at the nodes of every step [m^3/s], shape (k, 2, NODES_PER_STEP).

    Args:
        edges: Times of the steps, shape (k + 1,).
        pressures: PL1 and PL2 at the nodes, shape (k, 2, NODES_PER_STEP).
        designs: The records of the phases, shape (p,).
        which: Phase of each step, shape (k,).
    """
    flows = np.empty_like(pressures)
    for i in range(which.size):
        width = edges[i + 1] - edges[i]
        for m in range(NODES.size):
            time = edges[i] + NODES[m] * width
            flows[i, 0, m], flows[i, 1, m] = load_flows(
                time, pressures[i, 0, m], pressures[i, 1, m], designs[which[i]]
            )
    return flows


@compiled
def settled(edges, pressures, flows, designs, which, final, band):  # type: ignore[no-untyped-def]
    """Return from when on QL1 stays within `band`·`final` of `final` [s]; NaN if it ends outside."""
    last = NODES.size - 1
    for i in range(which.size - 1, -1, -1):
        for m in range(last, -1, -1):
            if not abs(flows[i, 0, m] - final) > band * final:
                continue
            if m == last:
                return math.nan if i == which.size - 1 else edges[i + 1]
            low, high = NODES[m], NODES[m + 1]
            for _ in range(BISECTIONS):
                middle = 0.5 * (low + high)
                flow = _flows_at(i, middle, edges, pressures, designs, which)[0]
                if abs(flow - final) > band * final:
                    low = middle
                else:
                    high = middle
            return edges[i] + high * (edges[i + 1] - edges[i])
    return edges[0]


@compiled
def integrals(edges, pressures, flows, designs, which, reference, until):  # type: ignore[no-untyped-def]
    """Return the integrals of QL1 - QL2 less a reference, and of its magnitude, up to a time [m^3]."""
    signed, magnitude = 0.0, 0.0
    for i in range(which.size):
        width = edges[i + 1] - edges[i]
        if edges[i] >= until:
            break
        end = min((until - edges[i]) / width, 1.0)
        low, high, total = math.inf, -math.inf, 0.0
        for m in range(NODES.size):
            error = flows[i, 0, m] - flows[i, 1, m] - reference
            low, high, total = min(low, error), max(high, error), total + error * NODE_WEIGHTS[m]
        if end == 1.0 and (low >= 0.0 or high <= 0.0):
            signed += total * width
            magnitude += abs(total) * width
            continue
        signed += _piece(i, 0.0, end, reference, edges, pressures, designs, which)
        magnitude += _pieces(i, end, reference, edges, pressures, designs, which)
    return signed, magnitude


@compiled
def _pieces(i, end, reference, edges, pressures, designs, which):  # type: ignore[no-untyped-def]
    """Integrate the magnitude over [0, end] of a step, piece by piece between its zeros."""
    total, cut = 0.0, 0.0
    place, here = 0.0, _error_at(i, 0.0, reference, edges, pressures, designs, which)
    for m in range(1, NODES.size):
        after = NODES[m] * end
        there = _error_at(i, after, reference, edges, pressures, designs, which)
        if here * there < 0.0:
            low, high = place, after
            for _ in range(BISECTIONS):
                middle = 0.5 * (low + high)
                if _error_at(i, middle, reference, edges, pressures, designs, which) * here > 0.0:
                    low = middle
                else:
                    high = middle
            total += abs(_piece(i, cut, high, reference, edges, pressures, designs, which))
            cut = high
        place, here = after, there
    return total + abs(_piece(i, cut, end, reference, edges, pressures, designs, which))


@compiled
def _piece(i, left, right, reference, edges, pressures, designs, which):  # type: ignore[no-untyped-def]
    """Integrate the signed error over a part of a step."""
    total = 0.0
    for m in range(NODES.size):
        theta = left + (right - left) * NODES[m]
        total += NODE_WEIGHTS[m] * _error_at(i, theta, reference, edges, pressures, designs, which)
    return total * (right - left) * (edges[i + 1] - edges[i])


@compiled
def _error_at(i, theta, reference, edges, pressures, designs, which):  # type: ignore[no-untyped-def]
    flows = _flows_at(i, theta, edges, pressures, designs, which)
    return flows[0] - flows[1] - reference


@compiled
def _flows_at(i, theta, edges, pressures, designs, which):  # type: ignore[no-untyped-def]
    """Load flows at a place on a step, from the pressures' polynomials there."""
    time = edges[i] + theta * (edges[i + 1] - edges[i])
    first, second = interpolate(theta, pressures[i, 0]), interpolate(theta, pressures[i, 1])
    return load_flows(time, first, second, designs[which[i]])
