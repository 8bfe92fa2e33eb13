from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import trapezoid

from divideropt.models.base import Outcome
from divideropt.models.divider import FORMULATIONS, Divider, Event, Scenario, load_step, solver_settings
from divideropt.models.divider.coefficients import Valve
from divideropt.models.divider.kernels import jacobian, rates
from divideropt.models.divider.quantities import EVENT_QUANTITIES, QUANTITIES
from divideropt.models.divider.scenario import Inputs

TIGHT = solver_settings("LSODA", 1e-10, max_steps=100_000)
EVERYTHING = Event(0.5, 0.2, 8e-4, 0.62, (13e6, 4e6))


def test_time_is_divided_by_the_events() -> None:
    scenario = Scenario(events=(load_step(1, 15e6), EVERYTHING, Event(1.0, source_flow=1e-3)), end_time=2.0)
    spans = scenario.spans()
    assert [(s.begin, s.end, s.event, s.moving) for s in spans] == [
        (0.0, 0.0, -1, False),
        (0.0, 0.5, 0, False),
        (0.5, 0.7, 1, True),
        (0.7, 1.0, 1, False),
        (1.0, 2.0, 2, False),
    ]
    assert spans[1].inputs == Inputs(1e-3, 0.5, (15e6, 10e6))
    assert spans[2].inputs == spans[1].inputs
    assert spans[2].final_inputs == spans[3].inputs == Inputs(8e-4, 0.62, (13e6, 4e6))
    assert spans[4].inputs == Inputs(1e-3, 0.62, (13e6, 4e6))


@pytest.mark.parametrize(
    "events",
    [
        (),
        (load_step(1, 15e6, at=-0.1),),
        (load_step(1, 15e6, at=1.0),),  # at the end
        (load_step(1, 15e6, at=0.5, over=0.5),),  # over with the end
        (load_step(1, 15e6, at=0.2), load_step(2, 15e6, at=0.2)),  # at once: one event
        (load_step(1, 15e6, at=0.2, over=0.3), load_step(2, 15e6, at=0.4)),
        (load_step(1, 15e6, at=0.4), load_step(2, 15e6, at=0.2)),
    ],
)
def test_events_that_do_not_follow_each_other_are_refused(events) -> None:
    with pytest.raises(ValueError, match="event"):
        Scenario(events=events)


@pytest.mark.parametrize("formulation", FORMULATIONS)
@pytest.mark.parametrize("loss", [False, True])
@given(share=st.floats(0.0, 1.0))
def test_a_ramp_is_at_each_instant_what_its_inputs_are(design, formulation, loss, share) -> None:
    valve = Valve.of(design(), replace(FORMULATIONS[formulation], groove_loss=loss))
    ramp = Scenario(events=(EVERYTHING,)).spans()[1]
    moving = valve.over(ramp, 1e-3)
    a, b = ramp.inputs, ramp.final_inputs

    def between(first: float, second: float) -> float:
        return first + share * (second - first)

    loads = tuple(between(p, q) for p, q in zip(a.load_pressures, b.load_pressures, strict=True))
    still = valve.under(
        Inputs(between(a.source_flow, b.source_flow), between(a.spool_position, b.spool_position), loads), 1e-3
    )
    y = np.array([19e6, 17.2e6, 17.9e6, 18.1e6, 18.4e6, 1e-3, 2e-4, 12e6, 6e6])
    t = ramp.begin + share * (ramp.end - ramp.begin)
    terms = np.abs(jacobian(0.0, y, still)) @ np.abs(y)
    assert (np.abs(rates(t, y, moving) - rates(0.0, y, still)) <= 1e-12 * terms).all()
    found, expected = jacobian(t, y, moving), jacobian(0.0, y, still)
    np.testing.assert_allclose(found, expected, rtol=1e-9, atol=1e-12 * np.abs(expected).max())


def test_the_record_of_an_input_that_stays_does_not_know_the_time(design) -> None:
    valve = Valve.of(design(), FORMULATIONS["conservative"])
    record = valve.under(Inputs(1e-3, 0.4, (1e7, 1e7)))
    y = np.full(9, 1e7)
    y[5:7] = 0.0
    np.testing.assert_array_equal(rates(0.0, y, record), rates(123.0, y, record))


def test_the_load_orifices_keep_their_size_when_the_source_flow_changes(measured, design) -> None:
    # Half the flow through an orifice that made 10 MPa makes a quarter of it; nothing else is asymmetric.
    scenario = Scenario(events=(Event(0.0, source_flow=5e-4),), end_time=3.0)
    model = Divider(scenario=scenario, settings=TIGHT)
    state = model.respond(design(radial_clearance=1e-7)).phases[-1].rest.state
    assert state[7:9] == pytest.approx([2.5e6, 2.5e6], rel=1e-6)
    assert abs(measured(model, design())["flow_difference"]) < 1e-9


def test_each_event_is_measured_as_if_it_were_the_only_one(measured, design) -> None:
    """Once settled, an event does not know what came before: the same steps one by one give the same metrics."""
    loads = [(10e6, 10e6), (15e6, 10e6), (15e6, 7e6), (12e6, 7e6)]
    events = (load_step(1, 15e6), load_step(2, 7e6, at=1.0), load_step(1, 12e6, at=2.0))
    together = measured(Divider(scenario=Scenario(events=events, end_time=3.0), settings=TIGHT), design())
    assert together["outcome"] is Outcome.OK
    steps = [(1, 15e6), (2, 7e6), (1, 12e6)]
    for number, (before, (load, to)) in enumerate(zip(loads, steps, strict=False), start=1):
        alone_scenario = Scenario(load_pressures=before, events=(load_step(load, to),))
        alone = measured(Divider(scenario=alone_scenario, settings=TIGHT), design())
        for name in EVENT_QUANTITIES:
            found = together[name if number == 3 else f"event_{number}.{name}"]
            assert found == pytest.approx(alone[name], rel=2e-6, abs=1e-13), (number, name)
    margins = [
        measured(Divider(scenario=Scenario(load_pressures=p), settings=TIGHT), design())["stability_margin"]
        for p in loads
    ]
    assert together["stability_margin"] <= min(margins) * (1 + 1e-9)


def test_a_turn_of_the_spool_ends_where_a_turned_valve_is(measured, design) -> None:
    turned = Scenario(events=(Event(0.0, 0.05, spool_position=0.4),), end_time=2.0)
    model = Divider(scenario=turned, settings=TIGHT)
    expected = Divider(scenario=Scenario(spool_position=0.4), settings=TIGHT).respond(design()).phases[0].rest.state
    response = model.respond(design())
    np.testing.assert_allclose(response.phases[-1].rest.state, expected, rtol=1e-9)
    np.testing.assert_allclose(response.phases[-1].end, expected, rtol=1e-5, atol=1e-6)
    q = measured(model, design())
    ideal = 100 * (1.5**0.5 - 1) / (1.5**0.5 + 1)  # (2.6) at 0.4
    assert q["cumulative_steady_error_percent"] == pytest.approx(q["flow_difference"] - ideal, abs=1e-9)
    assert q["load_regulation"] > 5.0  # from 50 to 55 % of the flow, and some error


def test_metrics_of_a_ramp_against_brute_force(measured, design) -> None:
    scenario = Scenario(events=(load_step(1, 15e6, over=0.03),), accumulation_time=0.15)
    model = Divider(scenario=scenario, settings=TIGHT)
    q, response = measured(model, design()), model.respond(design())
    _, way, stay = response.phases
    times, flows = [], []
    for phase in (way, stay):
        t = np.concatenate(
            [np.linspace(a, b, 33) for a, b in zip(phase.trajectory.edges, phase.trajectory.edges[1:], strict=False)]
        )
        pressure = 10e6 + 5e6 * np.minimum(t / 0.03, 1.0)  # the load goes evenly
        states = phase.trajectory.at(t)
        times.append(t)
        flows.append(5e-4 * np.sqrt(states[:, 7:9] / np.column_stack([pressure, np.full_like(t, 10e6)])))
    t, f = np.concatenate(times), np.concatenate(flows)
    final = 5e-4 * np.sqrt(stay.rest.state[7:9] / np.array([15e6, 10e6]))
    outside = np.flatnonzero(np.abs(f[:, 0] - final[0]) > 0.02 * final[0])[-1]
    assert t[outside] - 1e-12 <= q["settling_time"] <= t[outside + 1] + 1e-12
    error = (f[:, 0] - f[:, 1]) - (final[0] - final[1])
    inside = t <= q["settling_time"]
    assert q["dynamic_error"] == pytest.approx(trapezoid(error[inside], t[inside]), rel=1e-3)
    gathered = t <= 0.15
    assert q["cumulative_error"] == pytest.approx(trapezoid((f[:, 0] - f[:, 1])[gathered], t[gathered]), rel=1e-3)
    # A ramp ends where a step ends.
    step = measured(Divider(settings=TIGHT), design())
    assert q["steady_state_error"] == pytest.approx(step["steady_state_error"], rel=1e-9)


def test_quantities_of_earlier_events_have_a_prefix() -> None:
    model = Divider(scenario=Scenario(events=(load_step(1, 15e6), load_step(1, 10e6, at=0.5))))
    assert list(model.quantities) == [*QUANTITIES, *(f"event_1.{name}" for name in EVENT_QUANTITIES)]
    assert model.quantities["event_1.dynamic_error"].signed


def test_an_event_too_short_to_settle_has_no_metrics(measured, design) -> None:
    # What it would have come to was never reached: the next event's change is not counted from there either.
    events = (load_step(1, 15e6), load_step(1, 10e6, at=0.02))
    q = measured(Divider(scenario=Scenario(events=events), settings=TIGHT), design())
    assert all(np.isnan(q[f"event_1.{name}"]) for name in EVENT_QUANTITIES)
    assert np.isnan(q["load_regulation"])
    assert np.isfinite(q["steady_state_error"])
    assert q["outcome"] is Outcome.OK


def test_times_that_differ_by_rounding_are_one() -> None:
    ramp = Event(0.1, 0.7, load_pressures=(15e6, None))  # 0.1 + 0.7 is 0.7999999999999999
    scenario = Scenario(events=(ramp, Event(0.8, source_flow=8e-4)), end_time=2.0)
    assert [(s.begin, s.end) for s in scenario.spans()] == [(0.0, 0.1), (0.1, 0.8), (0.8, 2.0)]
    late = Event(0.1, 0.2, load_pressures=(15e6, None))  # 0.1 + 0.2 is 0.30000000000000004
    Scenario(events=(late, Event(0.3, source_flow=8e-4)), end_time=2.0)


def test_a_ramp_that_lasts_until_the_next_event_has_no_metrics(measured, design) -> None:
    events = (Event(0.0, 0.1, load_pressures=(15e6, None)), Event(0.1, 0.1, load_pressures=(10e6, None)))
    scenario = Scenario(events=events)
    assert scenario.measured_events == ()
    model = Divider(scenario=scenario, settings=TIGHT)
    assert list(model.quantities) == list(QUANTITIES)
    assert measured(model, design())["outcome"] is Outcome.OK
