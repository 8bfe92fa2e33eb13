"""The metrics of section 3.1, to the letter, and the outcome of a response.

The steady quantities are those of the final state: of the equilibrium reached for a settled start without
friction, else of the end of the response, as the author took them.
"""

import math

import numpy as np

from divideropt.models.base import FloatArray, Outcome, Verdict
from divideropt.models.divider.equilibrium import (
    find_equilibrium,
    rests_on_stop,
    stability_margin,
    without_friction,
)
from divideropt.models.divider.formulations import Stop
from divideropt.models.divider.ideal import desired_flows
from divideropt.models.divider.kernels import STATES
from divideropt.models.divider.quantities import QUANTITIES
from divideropt.models.divider.response import Response
from divideropt.models.divider.transient import FlowError, largest_value
from divideropt.ode import SolverStatus

SETTLING_BAND = 0.02
"""Band around the final flow of branch 1, section 3.1."""

REST_TOLERANCE = 1e-3
"""How near the flows at the end must be to the equilibrium's for a settled start to count as settled again."""

ROUNDING = 1e-9
"""A sum of two times may exceed a third by this part of it."""

LAST_PART = 0.1
"""Where the final flows are the end's own, leaving the band in this last part of the time is unsettled."""

_XDOT, _X = STATES.index("xdot"), STATES.index("x")


def measure(response: Response) -> tuple[FloatArray, Verdict]:
    """Measure a response.

    Args:
        response: One design's response.

    Returns:
        The quantities in the order of `QUANTITIES`, NaN where one is not defined, and the verdict.
    """
    first, last = response.phases[0], response.phases[-1]
    found = dict.fromkeys(QUANTITIES, math.nan)
    found |= _geometric(response) | _extremes(response)
    found["stability_margin"] = _worst_margin(response)
    earlier = None if first.end is None else first.load_flows(first.end)
    if earlier is not None:
        found["ratio_bias"] = _signed_error(response, earlier)
    final = _final_state(response)
    if final is not None and last.trajectory is not None and earlier is not None:
        flows = last.load_flows(final)
        found |= _steady(response, final, flows) | _dynamic(response, flows)
        found["load_regulation"] = 100 * float(flows[0] / flows.sum() - earlier[0] / earlier.sum())
    return np.array([found[name] for name in QUANTITIES]), _verdict(response, found)


def _geometric(response: Response) -> dict[str, float]:
    g = response.geometry
    return {
        "open_drop": g.open_drop,
        "spool_mass": g.mass,
        "stroke": 2 * g.stop_position,
        "spool_length": g.spool_length,
    }


def _extremes(response: Response) -> dict[str, float]:
    """Peak pressure and stop clearance, over the whole response."""
    values = [p.trajectory.values for p in response.phases if p.trajectory is not None]
    if not values:
        return {}
    peak = max(largest_value(v[:, :_XDOT]) for v in values)
    travel = max(max(largest_value(v[:, [_X]]), largest_value(-v[:, [_X]])) for v in values)
    return {"peak_pressure": peak, "stop_clearance": response.geometry.stop_position - travel}


def _worst_margin(response: Response) -> float:
    """Smallest stability margin over the equilibria; NaN where one is missing or is a rest on a rigid stop."""
    margins = []
    for phase in response.phases:
        rigid = phase.design[0].stop == Stop.FROZEN
        if phase.rest is None or (rigid and rests_on_stop(phase.design, phase.rest.state)):
            return math.nan
        margins.append(stability_margin(phase.design, phase.rest.state))
    return min(margins)


def _rests_at_root(response: Response) -> bool:
    """Whether the final state is an equilibrium to be solved for, and not wherever the response ends."""
    return response.scenario.settled and response.parameters["coulomb_friction"] == 0.0


def _final_state(response: Response) -> FloatArray | None:
    last = response.phases[-1]
    if last.end is None or not _rests_at_root(response):
        return last.end
    return None if last.rest is None else last.rest.state


def _steady(response: Response, final: FloatArray, flows: FloatArray) -> dict[str, float]:
    """What the final state alone decides."""
    total = response.scenario.source_flow
    first, second = float(flows[0]), float(flows[1])
    return {
        "steady_state_error": _steady_state_error(response, flows),
        "flow_difference": 100 * (first - second) / total,
        "cumulative_steady_error_percent": _signed_error(response, flows),
        "friction_band": _friction_band(response),
        "source_pressure": float(final[0]),
        "pressure_loss": float(final[0] - max(final[7], final[8])),
        "load_flow_1": first,
        "load_flow_2": second,
        "leakage": total - first - second,
    }


def _dynamic(response: Response, final_flows: FloatArray) -> dict[str, float]:
    """What the way to the final state decides."""
    scenario, last = response.scenario, response.phases[-1]
    error = FlowError(last)
    found: dict[str, float] = {}
    settled = error.settled_at(float(final_flows[0]), SETTLING_BAND)
    if settled is not None:
        dynamic, magnitude = error.integrals(_gap(final_flows), settled)
        found |= {
            "settling_time": settled - error.begin,
            "dynamic_error": dynamic,
            "dynamic_error_abs": magnitude,
            "dynamic_error_percent": 100 * dynamic / (scenario.source_flow * scenario.accumulation_time),
        }
    until = error.begin + scenario.accumulation_time
    if until <= scenario.end_time * (1 + ROUNDING):
        found["cumulative_error"] = error.integrals(_gap(_desired(response)), until)[0]
    return found


def _friction_band(response: Response) -> float:
    """Width [%] in steady-state error between the rests at which friction holds to one side and to the other."""
    friction, last = response.parameters["coulomb_friction"], response.phases[-1]
    if friction == 0.0:
        return 0.0
    errors = []
    for force in (-friction, friction):
        design = without_friction(last.design, force)
        rest = None if last.end is None else find_equilibrium(design, last.end)
        if rest is None:
            return math.nan
        errors.append(_signed_error(response, last.load_flows(rest.state)))
    return abs(errors[0] - errors[1])


def _desired(response: Response) -> FloatArray:
    scenario, ratio = response.scenario, response.parameters["fixed_area_ratio"]
    return np.array(desired_flows(scenario.spool_position, ratio, scenario.source_flow))


def _gap(flows: FloatArray) -> float:
    return float(flows[0] - flows[1])


def _steady_state_error(response: Response, flows: FloatArray) -> float:
    """(3.6) [%]."""
    return float(100 * np.abs(flows - _desired(response)).sum() / response.scenario.source_flow)


def _signed_error(response: Response, flows: FloatArray) -> float:
    """(3.11) [%]: as (3.6), signed."""
    return 100 * (_gap(flows) - _gap(_desired(response))) / response.scenario.source_flow


def _verdict(response: Response, found: dict[str, float]) -> Verdict:
    """Name the first thing wrong, the gravest first."""
    for check in (_not_completed, _at_stop, _no_equilibrium, _unstable, _unsettled):
        verdict = check(response, found)
        if verdict is not None:
            return verdict
    return Verdict(Outcome.OK)


def _not_completed(response: Response, found: dict[str, float]) -> Verdict | None:
    for phase in response.phases:
        run = phase.trajectory
        if run is not None and run.status is not SolverStatus.FINISHED:
            return Verdict(
                Outcome.NOT_COMPLETED,
                f"the solver stopped at t = {run.edges[-1]:.6g} s ({run.status}): {run.message}",
            )
    return None


def _at_stop(response: Response, found: dict[str, float]) -> Verdict | None:
    for phase in response.phases:
        places = [phase.end] if phase.rest is None else [phase.end, phase.rest.state]
        for state in places:
            if phase.end is not None and state is not None and rests_on_stop(phase.design, state):
                where = abs(state[_X]) * 1e3
                text = f"the spool rests on its stop, {where:.4g} mm from the centre: the flows are not controlled"
                return Verdict(Outcome.AT_STOP, text)
    return None


def _no_equilibrium(response: Response, found: dict[str, float]) -> Verdict | None:
    for phase, when in zip(response.phases, ("before", "after"), strict=True):
        if phase.rest is None:
            return Verdict(Outcome.NO_EQUILIBRIUM, f"no equilibrium within the stroke {when} the step")
    return None


def _unstable(response: Response, found: dict[str, float]) -> Verdict | None:
    margin = found["stability_margin"]
    if not margin < 0.0:  # NaN is not unstable
        return None
    return Verdict(Outcome.UNSTABLE, f"an equilibrium is unstable: a disturbance grows at {-margin:.4g} 1/s")


def _unsettled(response: Response, found: dict[str, float]) -> Verdict | None:
    last = response.phases[-1]
    if last.end is None or last.rest is None:
        return None
    if _rests_at_root(response):
        rest = last.load_flows(last.rest.state)
        off = float(np.max(np.abs(last.load_flows(last.end) / rest - 1)))
        settled = off <= REST_TOLERANCE and not math.isnan(found["settling_time"])
        text = f"at the end a load flow is {100 * off:.3g} % from that of the equilibrium"
    else:
        begin, end = response.scenario.step_time, response.scenario.end_time
        settled = found["settling_time"] <= (1 - LAST_PART) * (end - begin)
        text = "the flow of branch 1 still leaves its 2 % band in the last tenth of the time"
    return None if settled else Verdict(Outcome.UNSETTLED, text)
