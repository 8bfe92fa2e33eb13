"""Whether a response has come to an oscillation that neither dies nor grows: a limit cycle."""

from dataclasses import dataclass

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.models.divider.response import Phase

STEADY = 0.02
"""By how much, of itself, the amplitude of a sustained oscillation may differ between the last two quarters."""

FEWEST_CROSSINGS = 4
"""Of the equilibrium's flow in each of those quarters: two whole swings, so that no slow drift counts."""


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
    if phase.end is None or phase.rest is None or phase.trajectory is None:
        return None
    rest = float(phase.load_flows(phase.rest.state)[0])
    if rest <= 0.0:
        return None
    end = phase.span.end
    quarter = (end - phase.span.begin) / 4
    late = _swing(phase, rest, end - quarter, end)
    if late.size == 0 or np.abs(late).max() < smallest:
        return None
    early = _swing(phase, rest, end - 2 * quarter, end - quarter)
    if early.size == 0:
        return None
    amplitudes = [float(np.abs(swing).max()) for swing in (early, late)]
    crossings = [int(np.count_nonzero(np.diff(np.signbit(swing)))) for swing in (early, late)]
    steady = abs(amplitudes[1] - amplitudes[0]) <= STEADY * amplitudes[0]
    if not steady or min(crossings) < FEWEST_CROSSINGS:
        return None
    return Oscillation(max(amplitudes), sum(crossings) / 2 / (2 * quarter))


def _swing(phase: Phase, rest: float, begin: float, end: float) -> FloatArray:
    """Flow to load 1 at the nodes of the solver's steps over a stretch, less the equilibrium's, in shares of it."""
    run = phase.trajectory
    assert run is not None
    steps = slice(*np.searchsorted(run.edges, [begin, end]))
    states = np.swapaxes(run.values[steps], 1, 2).reshape(-1, run.values.shape[1])
    return np.asarray(phase.load_flows(states)[:, 0] / rest - 1)
