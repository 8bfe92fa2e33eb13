"""Whether a response has come to an oscillation that neither dies nor grows: a limit cycle."""

import math
from dataclasses import dataclass

import numpy as np

from divideropt.models.divider.kernels import load_flows
from divideropt.models.divider.response import Phase
from divideropt.models.divider.states import STATES
from divideropt.ode.base import NODES
from divideropt.ode.compiled import compiled

STEADY = 0.02
"""By how much, of itself, the amplitude of a sustained oscillation may differ between the last two quarters."""

FEWEST_CROSSINGS = 4
"""Of the equilibrium's flow in each of those quarters: two whole swings, so that no slow drift counts."""

_FIRST, _SECOND = STATES.index("PL1"), STATES.index("PL2")


@dataclass(frozen=True)
class Oscillation:
    """A sustained oscillation of the flow to load 1.

    Attributes:
        amplitude: Largest distance from the equilibrium's flow, in shares of it.
        frequency: Swings a second [1/s].
    """

    amplitude: float
    frequency: float


def sustained_oscillation(phase: Phase, smallest: float) -> Oscillation | None:
    """Look for an oscillation at the end of a phase.

    Args:
        phase: Under inputs that stay.
        smallest: Amplitude below which there is none, in shares of the equilibrium's flow.

    Returns:
        It, or None where the response settles, drifts, grows, dies away, or has no equilibrium.
    """
    run = phase.trajectory
    if phase.end is None or phase.rest is None or run is None:
        return None
    amplitude, frequency = oscillation(
        run.edges, run.values, phase.design, phase.rest.state, phase.span.begin, phase.span.end, smallest
    )
    return None if math.isnan(amplitude) else Oscillation(amplitude, frequency)


@compiled
def oscillation(edges, values, design, rest, begin, end, smallest):  # type: ignore[no-untyped-def]
    """Return amplitude and frequency of an oscillation, NaN where there is none; compiled.

    Args:
        edges: Times of the steps [s], shape (k + 1,).
        values: States at the nodes of each, shape (k, 9, NODES_PER_STEP).
        design: `COEFFICIENTS`, shape (1,), under inputs that stay.
        rest: The equilibrium, shape (9,).
        begin: Of the phase [s].
        end: Of the phase [s].
        smallest: As for `sustained_oscillation`.
    """
    d = design[0]
    flow = load_flows(end, rest[_FIRST], rest[_SECOND], d)[0]
    if not flow > 0.0:
        return math.nan, math.nan
    quarter = (end - begin) / 4.0
    late, late_crossings = _swing(edges, values, d, flow, end - quarter, end)
    if not late >= smallest:
        return math.nan, math.nan
    early, early_crossings = _swing(edges, values, d, flow, end - 2.0 * quarter, end - quarter)
    if not abs(late - early) <= STEADY * early or min(early_crossings, late_crossings) < FEWEST_CROSSINGS:
        return math.nan, math.nan
    return max(early, late), (early_crossings + late_crossings) / 2.0 / (2.0 * quarter)


@compiled
def _swing(edges, values, d, flow, begin, end):  # type: ignore[no-untyped-def]
    """Largest distance of the flow to load 1 from the equilibrium's, in shares of it, and how often it crosses it.

    It is looked at in the nodes of the steps that begin within the stretch; NaN where there are none.
    """
    first, after = np.searchsorted(edges, begin), np.searchsorted(edges, end)
    largest, crossings, above = math.nan, 0, False
    for i in range(first, min(after, values.shape[0])):
        for m in range(NODES.size):
            swing = load_flows(edges[i], values[i, _FIRST, m], values[i, _SECOND, m], d)[0] / flow - 1.0
            if math.isnan(largest):
                largest = abs(swing)
            else:
                largest = max(largest, abs(swing))
                crossings += above != (swing >= 0.0)
            above = swing >= 0.0
    return largest, crossings
