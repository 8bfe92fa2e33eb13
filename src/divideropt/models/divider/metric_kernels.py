"""The metrics of section 3.1 and what validates them, compiled, from the arrays of a response.

Steady quantities are those of the state in which an event ends: of the equilibrium reached for a settled start
without friction, else of the last instant before the next event or the end, as the author took them.
"""

import math

from divideropt.models.divider.groove_kernels import groove_inlets
from divideropt.models.divider.ideal import desired_flows
from divideropt.models.divider.kernels import load_flows
from divideropt.models.divider.rest_kernels import margin
from divideropt.models.divider.states import STATES
from divideropt.models.divider.transient import (
    fill_flows,
    integrals,
    largest_pressure,
    largest_travel,
    settled,
)
from divideropt.ode.compiled import compiled

SETTLING_BAND = 0.02
"""Band around the final flow of branch 1, section 3.1."""

ROUNDING = 1e-9
"""A sum of two times may exceed a third by this part of it."""

REST_TOLERANCE = 1e-3
"""How near the flows at the end must be to the equilibrium's for a settled start to count as settled again."""

LARGEST_REYNOLDS = 2000.0
"""Laminar flow in a duct below about this."""

LARGEST_VELOCITY_RATIO = 1.0
"""The pressure that drives a groove could not give a loss-free jet more than this."""

_X, _FIRST, _SECOND = STATES.index("x"), STATES.index("PL1"), STATES.index("PL2")


@compiled
def measure_course(course, whole, by_event, i):  # type: ignore[no-untyped-def]
    """Measure a response.

    Args:
        course: A `Course`.
        whole: `WHOLE`, shape (n,), NaN everywhere; the i-th receives what is defined.
        by_event: `BY_EVENT`, shape (n, events), NaN everywhere; the i-th row receives what is defined.
        i: Which.
    """
    g, w = course.derived[0], whole[i]
    w.open_drop, w.spool_mass, w.spool_length = g.open_drop, g.mass, g.spool_length
    w.stroke = 2.0 * g.stop_position
    w.peak_pressure = largest_pressure(course)
    w.stop_clearance = g.stop_position - largest_travel(course)
    w.stability_margin = _worst_margin(course)
    _grooves(course, w)
    share = math.nan  # of the source flow that goes to load 1 before an event
    if course.reached[0] != 0:
        first, second = _flows_in(course, 0, course.ends)
        w.ratio_bias = _signed_error(course, 0, first, second)
        share = first / (first + second)
    fill_flows(course)
    phase, phases = 0, course.spans.size
    for event in range(course.rules[0].events):
        while course.spans[phase].event < event:
            phase += 1
        begin = phase
        while phase + 1 < phases and course.spans[phase + 1].event == event:
            phase += 1
        share = _event(course, begin, phase, share, by_event[i, event])


@compiled
def rests_at_root(course):  # type: ignore[no-untyped-def]
    """Return whether a final state is an equilibrium to be solved for, and not wherever the response ends."""
    return course.rules[0].settled != 0 and course.row[0].coulomb_friction == 0.0


@compiled
def distance_from_rest(course, phase):  # type: ignore[no-untyped-def]
    """Return the largest distance of a load flow at a phase's end from the rest's, in shares; NaN if unknown."""
    if course.reached[phase] == 0 or course.rested[phase] == 0:
        return math.nan
    first, second = _flows_in(course, phase, course.ends)
    rest_first, rest_second = _flows_in(course, phase, course.rests)
    return max(abs(first / rest_first - 1.0), abs(second / rest_second - 1.0))


@compiled
def on_stop(course, phase, states):  # type: ignore[no-untyped-def]
    """Return whether the spool is on its stop, or beyond it; never where the formulation has none."""
    d = course.designs[phase]
    return d.stop != 2 and abs(states[phase, _X]) >= d.stop_position


@compiled
def _flows_in(course, phase, states):  # type: ignore[no-untyped-def]
    """Load flows [m^3/s] in a state that belongs to a phase's end."""
    end = course.spans[phase].end
    return load_flows(end, states[phase, _FIRST], states[phase, _SECOND], course.designs[phase])


@compiled
def _desired(course, phase):  # type: ignore[no-untyped-def]
    span = course.spans[phase]
    return desired_flows(span.final_spool_position, course.row[0].fixed_area_ratio, span.final_source_flow)


@compiled
def _signed_error(course, phase, first, second):  # type: ignore[no-untyped-def]
    """(3.11) [%]: as (3.6), signed."""
    desired = _desired(course, phase)
    gap = (first - second) - (desired[0] - desired[1])
    return 100.0 * gap / course.spans[phase].final_source_flow


@compiled
def _worst_margin(course):  # type: ignore[no-untyped-def]
    """Smallest stability margin over the equilibria; NaN where one is missing or is a rest on a rigid stop."""
    worst = math.inf
    for phase in range(course.spans.size):
        if course.spans[phase].moving != 0:
            continue
        if course.rested[phase] == 0:
            return math.nan
        if course.designs[phase].stop == 1 and on_stop(course, phase, course.rests):
            return math.nan
        here = margin(course.designs[phase : phase + 1], course.rests[phase])
        if math.isnan(here):
            return math.nan
        worst = min(worst, here)
    return worst


@compiled
def _grooves(course, w):  # type: ignore[no-untyped-def]
    """Measure the pilot grooves at the worst equilibrium and groove, against assumption 5 of section 2.3.

    It is laminar flow without losses at entrance and exit: the Reynolds number is over the hydraulic diameter b/√3,
    the velocity over that of a loss-free jet, √(2(Ps - Pa)/ρ).
    """
    p, g = course.row[0], course.derived[0]
    reynolds, ratio, share = -math.inf, -math.inf, -math.inf
    for phase in range(course.spans.size):
        if course.rested[phase] == 0:
            continue
        state, d = course.rests[phase], course.designs[phase]
        flows = groove_inlets(state, d)
        share = max(share, 2.0 * (flows[0] + flows[1]) / d.source_flow)
        for side in range(2):
            velocity = abs(flows[side]) / g.groove_area
            jet = math.sqrt(2.0 * max(state[0] - state[1 + side], 0.0) / p.density)
            reynolds = max(reynolds, velocity * g.groove_diameter / p.kinematic_viscosity)
            ratio = max(ratio, velocity / jet if jet > 0.0 else math.inf)
    if share > -math.inf:
        w.groove_reynolds, w.groove_velocity_ratio, w.pilot_share = reynolds, ratio, share
        w.within_validity = 1.0 if reynolds <= LARGEST_REYNOLDS and ratio <= LARGEST_VELOCITY_RATIO else 0.0


@compiled
def _event(course, begin, stay, share, m):  # type: ignore[no-untyped-def]
    """Measure what follows one event, over its phases up to `stay`; return the share of load 1 it ends with."""
    if course.spans[stay].moving != 0 or course.reached[stay] == 0:
        return math.nan
    at_root = rests_at_root(course)
    if at_root and course.rested[stay] == 0:
        return math.nan
    last = stay == course.spans.size - 1  # whose judgement says whether it has settled
    if not last and at_root and distance_from_rest(course, stay) > REST_TOLERANCE:
        return math.nan
    final = course.rests if at_root else course.ends
    first, second = _flows_in(course, stay, final)
    _steady(course, stay, final, first, second, m)
    _dynamic(course, begin, stay, first, second, m)
    m.load_regulation = 100.0 * (first / (first + second) - share)
    return first / (first + second)


@compiled
def _steady(course, stay, states, first, second, m):  # type: ignore[no-untyped-def]
    """What the final state alone decides."""
    total, final = course.spans[stay].final_source_flow, states[stay]
    desired = _desired(course, stay)
    m.steady_state_error = 100.0 * (abs(first - desired[0]) + abs(second - desired[1])) / total  # (3.6)
    m.flow_difference = 100.0 * (first - second) / total  # (3.5)
    m.cumulative_steady_error_percent = _signed_error(course, stay, first, second)
    m.friction_band = _friction_band(course, stay)
    m.source_pressure = final[0]
    m.pressure_loss = final[0] - max(final[_FIRST], final[_SECOND])
    m.load_flow_1, m.load_flow_2 = first, second
    m.leakage = total - first - second


@compiled
def _friction_band(course, stay):  # type: ignore[no-untyped-def]
    """Width [%] in steady-state error between the rests at which friction holds to one side and to the other."""
    if course.row[0].coulomb_friction == 0.0:
        return 0.0
    if course.banded[stay] == 0:
        return math.nan
    end, bands, d = course.spans[stay].end, course.bands[stay], course.designs[stay]
    low = load_flows(end, bands[0, _FIRST], bands[0, _SECOND], d)
    high = load_flows(end, bands[1, _FIRST], bands[1, _SECOND], d)
    return abs(_signed_error(course, stay, low[0], low[1]) - _signed_error(course, stay, high[0], high[1]))


@compiled
def _dynamic(course, begin, stay, first, second, m):  # type: ignore[no-untyped-def]
    """What the way to the final state decides."""
    rules, span = course.rules[0], course.spans[stay]
    start = course.spans[begin].begin
    time = settled(course, begin, stay, first, SETTLING_BAND * first)
    if not math.isnan(time):
        dynamic, magnitude = integrals(course, begin, stay, first - second, time)
        m.settling_time = time - start
        m.dynamic_error, m.dynamic_error_abs = dynamic, magnitude  # (3.10)
        m.dynamic_error_percent = 100.0 * dynamic / (span.final_source_flow * rules.accumulation_time)  # (3.12)
    until = start + rules.accumulation_time
    if until <= span.end * (1.0 + ROUNDING):
        desired = _desired(course, stay)
        m.cumulative_error = integrals(course, begin, stay, desired[0] - desired[1], until)[0]  # (3.8)
