"""The metrics of section 3.1, to the letter.

The steady quantities are those of the state in which an event ends: of the equilibrium reached for a settled start
without friction, else of the last instant before the next event or the end, as the author took them. The last event's
have plain names; those of an earlier one are prefixed `event_1.`, `event_2.` and so on, and are not defined where the
next event comes before the flows have settled.
"""

import math

import numpy as np

from divideropt.models.base import FloatArray, Verdict
from divideropt.models.divider.equilibrium import (
    find_equilibrium,
    rests_on_stop,
    stability_margin,
    without_friction,
)
from divideropt.models.divider.formulations import Stop
from divideropt.models.divider.ideal import desired_flows
from divideropt.models.divider.kernels import STATES
from divideropt.models.divider.quantities import quantities_of
from divideropt.models.divider.response import Phase, Response, distance_from_rest
from divideropt.models.divider.transient import FlowError, largest_value
from divideropt.models.divider.validity import groove_quantities
from divideropt.models.divider.verdicts import REST_TOLERANCE, judge

SETTLING_BAND = 0.02
"""Band around the final flow of branch 1, section 3.1."""

ROUNDING = 1e-9
"""A sum of two times may exceed a third by this part of it."""

_XDOT, _X = STATES.index("xdot"), STATES.index("x")


def measure(response: Response) -> tuple[FloatArray, Verdict]:
    """Measure a response.

    Args:
        response: One design's response.

    Returns:
        The quantities in the order of `quantities_of(events)`, NaN where one is not defined, and the verdict.
    """
    names = quantities_of(response.scenario.measured_events)
    found = dict.fromkeys(names, math.nan)
    found |= _geometric(response) | _extremes(response) | groove_quantities(response)
    found["stability_margin"] = _worst_margin(response)
    first = response.phases[0]
    flows = None if first.end is None else first.load_flows(first.end)
    if flows is not None:
        found["ratio_bias"] = _signed_error(response, first, flows)
    last = len(response.windows) - 1
    for number, window in enumerate(response.windows):
        metrics, flows = _event_metrics(response, window, flows)
        prefix = "" if number == last else f"event_{number + 1}."
        found |= {prefix + name: value for name, value in metrics.items()}
    return np.array([found[name] for name in names]), judge(response, found)


def _event_metrics(
    response: Response, window: tuple[Phase, ...], earlier: FloatArray | None
) -> tuple[dict[str, float], FloatArray | None]:
    """Measure what follows one event; also return the load flows it ends with."""
    stay = window[-1]
    final = None if stay.span.moving else _final_state(response, stay)
    if final is None or any(phase.trajectory is None for phase in window):
        return {}, None
    last = stay is response.phases[-1]  # whose outcome says whether it has settled
    if not last and response.rests_at_root and distance_from_rest(stay) > REST_TOLERANCE:
        return {}, None
    flows = stay.load_flows(final)
    metrics = _steady(response, stay, final, flows) | _dynamic(response, window, flows)
    if earlier is not None:
        metrics["load_regulation"] = 100 * float(flows[0] / flows.sum() - earlier[0] / earlier.sum())
    return metrics, flows


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
        if phase.span.moving:
            continue
        rigid = phase.design["stop"][0] == Stop.FROZEN
        if phase.rest is None or (rigid and rests_on_stop(phase.design, phase.rest.state)):
            return math.nan
        margins.append(stability_margin(phase.design, phase.rest.state))
    return float(np.min(margins))


def _final_state(response: Response, stay: Phase) -> FloatArray | None:
    if stay.end is None or not response.rests_at_root:
        return stay.end
    return None if stay.rest is None else stay.rest.state


def _steady(response: Response, stay: Phase, final: FloatArray, flows: FloatArray) -> dict[str, float]:
    """What the final state alone decides."""
    total = stay.span.final_inputs.source_flow
    first, second = float(flows[0]), float(flows[1])
    return {
        "steady_state_error": float(100 * np.abs(flows - _desired(response, stay)).sum() / total),  # (3.6)
        "flow_difference": 100 * (first - second) / total,
        "cumulative_steady_error_percent": _signed_error(response, stay, flows),
        "friction_band": _friction_band(response, stay),
        "source_pressure": float(final[0]),
        "pressure_loss": float(final[0] - max(final[7], final[8])),
        "load_flow_1": first,
        "load_flow_2": second,
        "leakage": total - first - second,
    }


def _dynamic(response: Response, window: tuple[Phase, ...], final_flows: FloatArray) -> dict[str, float]:
    """What the way to the final state decides."""
    scenario, stay = response.scenario, window[-1]
    error = FlowError(window)
    found: dict[str, float] = {}
    settled = error.settled_at(float(final_flows[0]), SETTLING_BAND)
    if settled is not None:
        dynamic, magnitude = error.integrals(_gap(final_flows), settled)
        volume = stay.span.final_inputs.source_flow * scenario.accumulation_time
        found |= {
            "settling_time": settled - error.begin,
            "dynamic_error": dynamic,
            "dynamic_error_abs": magnitude,
            "dynamic_error_percent": 100 * dynamic / volume,
        }
    until = error.begin + scenario.accumulation_time
    if until <= stay.span.end * (1 + ROUNDING):
        found["cumulative_error"] = error.integrals(_gap(_desired(response, stay)), until)[0]
    return found


def _friction_band(response: Response, stay: Phase) -> float:
    """Width [%] in steady-state error between the rests at which friction holds to one side and to the other."""
    friction = response.parameters["coulomb_friction"]
    if friction == 0.0:
        return 0.0
    errors = []
    for force in (-friction, friction):
        design = without_friction(stay.design, force)
        rest = None if stay.end is None else find_equilibrium(design, stay.end)
        if rest is None:
            return math.nan
        errors.append(_signed_error(response, stay, stay.load_flows(rest.state)))
    return abs(errors[0] - errors[1])


def _desired(response: Response, phase: Phase) -> FloatArray:
    inputs, ratio = phase.span.final_inputs, response.parameters["fixed_area_ratio"]
    return np.array(desired_flows(inputs.spool_position, ratio, inputs.source_flow))


def _gap(flows: FloatArray) -> float:
    return float(flows[0] - flows[1])


def _signed_error(response: Response, phase: Phase, flows: FloatArray) -> float:
    """(3.11) [%]: as (3.6), signed."""
    return 100 * (_gap(flows) - _gap(_desired(response, phase))) / phase.span.final_inputs.source_flow
