import numpy as np
import pytest

from divideropt.models.base import Outcome
from divideropt.models.divider import Divider, Scenario
from divideropt.models.divider.metrics import measure
from divideropt.models.divider.oscillation import sustained_oscillation
from divideropt.models.divider.response import Phase, Response
from divideropt.ode import SolverStatus
from divideropt.ode.base import NODES, Trajectory

# No design of ours cycles (none of 2,500 in a box around C.6's has an oscillatory instability), so the response is
# made: the load pressure swings about the equilibrium's.


@pytest.fixture
def swinging(design):
    settled = Divider().respond(design())
    before, after = settled.phases

    def make(amplitude, frequency=20.0, growth=0.0, drift=0.0) -> Response:
        edges = np.linspace(0.0, 1.0, 401)
        times = edges[:-1, None] + np.diff(edges)[:, None] * NODES
        states = np.repeat(after.rest.state[None, :, None], len(times), axis=0) * np.ones((1, 1, len(NODES)))
        swing = amplitude * np.exp(growth * (times - 1)) * np.sin(2 * np.pi * frequency * times) + drift * (1 - times)
        states[:, 7, :] *= (1 + swing) ** 2  # so that the flow swings by just that share
        run = Trajectory(edges, states, SolverStatus.FINISHED)
        phase = Phase(after.span, after.design, run, run.final, after.rest)
        return Response(Scenario(), settled.valve, (before, phase))

    return make


def test_a_sustained_swing_is_a_limit_cycle(swinging) -> None:
    found = sustained_oscillation(swinging(0.05).phases[-1], 1e-3)
    assert found.amplitude == pytest.approx(0.05, rel=1e-3)
    assert found.frequency == pytest.approx(20.0, rel=0.1)
    _, verdict = measure(swinging(0.05))
    assert verdict.outcome is Outcome.LIMIT_CYCLE
    assert "by 5 % to either side" in verdict.text
    assert "stable against small disturbances" in verdict.text


@pytest.mark.parametrize(
    "shape",
    [
        {"amplitude": 1e-4},  # too small to matter
        {"amplitude": 0.05, "growth": -1.0},  # dies away
        {"amplitude": 0.05, "growth": 1.0},  # grows
        {"amplitude": 0.0, "drift": 0.05},  # creeps
        {"amplitude": 0.05, "frequency": 3.0},  # has not swung often enough to say
    ],
)
def test_what_is_no_limit_cycle(swinging, shape) -> None:
    assert sustained_oscillation(swinging(**shape).phases[-1], 1e-3) is None


def test_a_settled_response_has_none(design) -> None:
    assert sustained_oscillation(Divider().respond(design()).phases[-1], 1e-3) is None
