import numpy as np
import pytest

from divideropt.models.base import Outcome
from divideropt.models.divider import Divider, Scenario, load_step, solver_settings
from divideropt.models.divider.kernels import rates
from divideropt.models.divider.states import STATES
from divideropt.ode import SolverStatus

TIGHT = solver_settings("LSODA", 1e-10, max_steps=100_000)
X = STATES.index("x")


@pytest.mark.parametrize(
    ("file", "base", "step_time"),
    [
        ("listing_response_base_divfitag", {}, 0.05),
        ("listing_response_base_changeall", {}, 0.6),
        (
            "listing_response_tab33_divfitag",
            {
                "spool_radius": 13.3e-3,
                "groove_width": 1.35e-3,
                "total_pressure_drop": 7.91e6,
                "fixed_drop_ratio": 0.886,
                "centred_opening": 0.421,
            },
            0.05,
        ),
    ],
)
def test_responses_of_the_authors_code(reference, design, file, base, step_time) -> None:
    rows = reference(file)
    times = rows["t"].to_numpy()
    scenario = Scenario(settled=False, events=(load_step(1, 15e6, at=step_time),), end_time=float(times[-1]))
    response = Divider("listing", scenario, TIGHT).respond(design(**base))
    first, second = response.phases
    before = times <= step_time  # at the very instant the old area still applies
    states = np.concatenate([first.trajectory.at(times[before]), second.trajectory.at(times[~before])])
    expected = rows[list(STATES)].to_numpy()
    assert (np.abs(states - expected) <= 1e-6 * np.ptp(expected, axis=0)).all()
    flows = np.concatenate([first.load_flows(states[before]), second.load_flows(states[~before])])
    elsewhere = times != step_time
    flows_expected = rows[["QL1", "QL2"]].to_numpy()
    error = np.abs(flows - flows_expected)[elsewhere]
    assert (error <= 1e-6 * np.ptp(flows_expected, axis=0)).all()
    assert len(times) >= 1000


def test_a_settled_start_is_at_rest_until_the_step(design) -> None:
    before, after = Divider(settings=TIGHT).respond(design()).phases
    assert before.trajectory is None
    assert before.rest is not None
    np.testing.assert_array_equal(before.end, before.rest.state)
    np.testing.assert_allclose(after.trajectory.values[0, :, 0], before.rest.state, rtol=1e-9, atol=1e-15)
    assert (after.trajectory.edges[0], after.trajectory.edges[-1]) == (0.0, 1.0)
    assert after.trajectory.status is SolverStatus.FINISHED
    # And by the end it is at the other equilibrium, which is sought with algebra alone.
    np.testing.assert_allclose(after.end[[0, 1, 2, 7, 8]], after.rest.state[[0, 1, 2, 7, 8]], rtol=1e-8)
    assert after.end[X] == pytest.approx(after.rest.state[X], rel=1e-6)


def test_a_cold_start_is_empty_and_joins_up_at_the_step(design) -> None:
    scenario = Scenario(settled=False, events=(load_step(1, 15e6, at=0.05),))
    before, after = Divider("conservative", scenario, TIGHT).respond(design()).phases
    np.testing.assert_array_equal(before.trajectory.values[0, :, 0], np.zeros(9))
    np.testing.assert_allclose(after.trajectory.values[0, :, 0], before.end, rtol=1e-9, atol=1e-12)
    assert (before.trajectory.edges[-1], after.trajectory.edges[-1]) == (0.05, 1.0)
    assert before.design[0].load_1 > after.design[0].load_1  # AL1 drops
    assert before.design[0].load_2 == after.design[0].load_2


def test_both_starts_end_at_one_equilibrium(design) -> None:
    settled = Divider(settings=TIGHT).respond(design()).phases[-1]
    cold = Divider(
        "conservative", Scenario(settled=False, events=(load_step(1, 15e6, at=0.05),), end_time=1.5), TIGHT
    )
    np.testing.assert_allclose(
        cold.respond(design()).phases[-1].rest.state, settled.rest.state, rtol=1e-9, atol=1e-15
    )


@pytest.mark.parametrize("method", ["rosenbrock", "LSODA", "BDF", "Radau"])
def test_polynomials_between_the_steps_solve_the_equations(design, method) -> None:
    # Integrated over a step, the rates must make the step's change: a check that uses no other solver.
    settings = solver_settings(method, 1e-8, max_steps=100_000)
    phase = Divider(settings=settings).respond(design()).phases[-1]
    run = phase.trajectory
    fine = np.linspace(0.0, 0.2, 20_001)
    states = run.at(fine)
    slopes = np.array([rates(0.0, y, phase.design) for y in states])
    change = np.cumsum((slopes[1:] + slopes[:-1]) / 2, axis=0) * (fine[1] - fine[0])
    slow = [0, X]  # source pressure and spool position: all that a grid of 10 µs resolves
    error = np.abs(states[1:] - states[0] - change)[:, slow]
    assert (error <= 1e-5 * np.ptp(states, axis=0)[slow]).all()


def test_a_step_on_the_other_load_is_the_mirror_image(design) -> None:
    one = (
        Divider(scenario=Scenario(events=(load_step(1, 15e6),)), settings=TIGHT)
        .respond(design())
        .phases[-1]
        .trajectory
    )
    two = (
        Divider(scenario=Scenario(events=(load_step(2, 15e6),)), settings=TIGHT)
        .respond(design())
        .phases[-1]
        .trajectory
    )
    times = np.linspace(0.0, 1.0, 200)
    mirrored = two.at(times)[:, [0, 2, 1, 4, 3, 5, 6, 8, 7]] * np.array([1, 1, 1, 1, 1, -1, -1, 1, 1])
    straight = one.at(times)
    assert (np.abs(mirrored - straight) <= 1e-8 * np.ptp(straight, axis=0)).all()


def test_load_flows_take_states_of_any_shape(design) -> None:
    phase = Divider(settings=TIGHT).respond(design()).phases[-1]
    d = phase.design[0]
    states = phase.trajectory.at(np.array([0.0, 0.01, 0.1]))
    expected = np.sqrt(states[:, 7:9]) * [d.load_1, d.load_2]
    np.testing.assert_allclose(phase.load_flows(states), expected, rtol=1e-14)
    np.testing.assert_array_equal(phase.load_flows(states[1]), phase.load_flows(states)[1])
    np.testing.assert_array_equal(phase.load_flows(states[None])[0], phase.load_flows(states))
    empty = states[0] - 1e9
    np.testing.assert_array_equal(phase.load_flows(empty), [0.0, 0.0])  # C.3's max(p, 0)


def test_the_budget_is_one_of_each_phase(design) -> None:
    settings = solver_settings(max_steps=20)
    cold = Divider("conservative", Scenario(settled=False, events=(load_step(1, 15e6, at=0.05),)), settings).respond(
        design()
    )
    first, second = cold.phases
    assert first.trajectory.status is SolverStatus.STEP_BUDGET
    assert first.end is None
    assert (second.trajectory, second.end) == (None, None)
    assert second.rest is not None  # an equilibrium is there, whether or not the simulation gets to it


def test_the_listing_stays_on_the_stop_it_ran_into(reference, listing_design) -> None:
    rows = reference("listing_objectives")
    jammed = rows[(rows["at_stop"] == 1) & (rows["istate"] == 2)].iloc[0]
    scenario = Scenario(settled=False, events=(load_step(1, 15e6, at=0.05),))
    response = Divider("listing", scenario, TIGHT).respond(listing_design(jammed))
    stop = response.geometry.stop_position
    run = response.phases[-1].trajectory
    assert run.status is SolverStatus.FINISHED
    x = np.abs(run.values[:, X, :])
    beyond = np.flatnonzero((x > stop).any(axis=1))
    assert len(beyond) > 0
    assert x.max() == pytest.approx(stop, rel=1e-12)
    assert (x[beyond[0] + 1 :] > stop).all()  # once there, for ever
    assert (np.diff(run.edges) > 0).all()


def test_parameters_and_geometry_come_with_the_response(design) -> None:
    response = Divider().respond(design(centred_opening=0.4))
    assert response.parameters["centred_opening"] == 0.4
    assert response.geometry.port_offset == pytest.approx(0.2 * response.geometry.port_radius)
    assert response.scenario == Scenario()


def test_a_budget_that_a_fast_mode_eats_is_rescued(measured, design) -> None:
    # Eigenvalues at -1130 ± 31285i 1/s: LSODA's formulas go in steps of 20 µs, Radau's need a hundred steps in all.
    p = design(
        radial_clearance=3e-6,
        spool_radius=15.9e-3,
        groove_width=0.61e-3,
        total_pressure_drop=9.9e6,
        fixed_drop_ratio=0.8,
        centred_opening=0.33,
    )
    model = Divider(groove_loss=True, settings=solver_settings("LSODA"))
    run = model.respond(p).phases[-1].trajectory
    assert run.status is SolverStatus.FINISHED
    assert len(run.edges) < 500
    fast, exact = measured(model, p), measured(model.reference(), p)
    assert fast["outcome"] is Outcome.OK
    assert fast["dynamic_error"] == pytest.approx(exact["dynamic_error"], rel=2e-3)
