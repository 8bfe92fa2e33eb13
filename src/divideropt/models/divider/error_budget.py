"""What the steady-state error is made of: each cause switched off in turn, beside Kwan's estimate."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace

from divideropt.models.base import FloatArray, Verdict
from divideropt.models.divider.metrics import measure
from divideropt.models.divider.model import Divider
from divideropt.models.divider.record import Design
from divideropt.models.divider.response import Response

TOTAL, REST = "total", "rest"

CAUSES: Mapping[str, str] = {
    "flow_force": "the pressure on the rims of the ports",
    "pilot_flow": "what passes the grooves and so by the fixed orifices",
    "end_seal_leakage": "from the end chambers to tank",
    "friction": "Coulomb friction, by which the spool rests off its root",
}
"""What is switched off, by name."""


@dataclass(frozen=True)
class ErrorBudget:
    """Shares of the steady-state error.

    Attributes:
        total: The error with everything on, signed as (3.11) [%].
        without: The error with one cause off, by the cause's name [%].
        rest: The error with every cause off [%]: leakage over the lands, and nothing else.
        kwan: Kwan's estimate of the flow force's share, `sserr_th` of C.2, with every hole counted [%].
        verdict: How the simulation with everything on ended.
    """

    total: float
    without: Mapping[str, float]
    rest: float
    kwan: float
    verdict: Verdict

    @property
    def shares(self) -> dict[str, float]:
        """How much of the total goes with each cause [%]; they need not add up, since causes act on each other."""
        return {cause: self.total - error for cause, error in self.without.items()}

    @property
    def interaction(self) -> float:
        """What the shares and the rest leave of the total [%]."""
        return self.total - sum(self.shares.values()) - self.rest


def error_budget(model: Divider, parameters: Mapping[str, float]) -> ErrorBudget:
    """Switch off each cause of the steady-state error in turn, and all of them together.

    Args:
        model: Formulation, scenario, solver.
        parameters: Every parameter by name, SI.

    Returns:
        The errors after the scenario's last event; NaN where one is not defined.
    """
    response = model.respond(parameters)
    total, verdict = _error(model, response)
    without = {cause: _error(model, _respond(model, parameters, {cause}))[0] for cause in CAUSES}
    rest = _error(model, _respond(model, parameters, set(CAUSES)))[0]
    return ErrorBudget(total, without, rest, _kwan(response), verdict)


def _respond(model: Divider, parameters: Mapping[str, float], off: set[str]) -> Response:
    """Simulate the design with some causes switched off."""
    changes = {"rim_thickness": 0.0} if "flow_force" in off else {}
    changes |= {"coulomb_friction": 0.0} if "friction" in off else {}
    formulation = replace(
        model.reading,
        pilot_bypass="pilot_flow" not in off,
        end_seals=model.reading.end_seals and "end_seal_leakage" not in off,
    )
    return model.respond({**parameters, **changes}, formulation)


def _error(model: Divider, response: Response) -> tuple[float, Verdict]:
    """Signed error after the last event [%], and how the simulation ended."""
    row, verdict = measure(response)
    found = dict(zip(model.quantities, row.tolist(), strict=True))
    return found["cumulative_steady_error_percent"], verdict


def _kwan(response: Response) -> float:
    """Flow force over twice the mean drop at the fixed orifices times the end area (C.2) [%]."""
    last = response.phases[-1]
    state = last.end if not response.rests_at_root or last.rest is None else last.rest.state
    if state is None:
        return math.nan
    drop = float(state[0] - (state[1] + state[2]) / 2)
    return 100 * _flow_force(last.design, state) / (2 * drop * response.geometry.end_area)


def _flow_force(design: Design, y: FloatArray) -> float:
    """Third and fourth term of (2.17) [N], with (2.18)."""
    d = design[0]
    reach = [d.port_radius**2 - (d.port_offset + side * y[6]) ** 2 for side in (-1, 1)]
    first, second = (d.rim_holes * 2 * d.rim_thickness * math.sqrt(max(square, 0.0)) for square in reach)
    return float(first / 2 * (y[7] - y[1]) - second / 2 * (y[8] - y[2]))
