import numpy as np
import pytest

from divideropt.models.divider import Scenario, load_step, solver_settings
from divideropt.models.divider.equilibrium import (
    find_equilibrium,
    initial_guess,
    rests_on_stop,
    stability_margin,
    without_friction,
)
from divideropt.models.divider.kernels import jacobian, rates, zero_state
from divideropt.ode import integrate

PRESSURES = [0, 1, 2, 3, 4, 7, 8]
MIRROR = np.array([0, 2, 1, 4, 3, 5, 6, 8, 7])
MIRROR_SIGNS = np.array([1, 1, 1, 1, 1, -1, -1, 1, 1])


def imbalances(rec, y: np.ndarray) -> np.ndarray:
    """Rates as flows over the source flow, and as a force over 1 MPa on the end area."""
    d = rec[0]
    end_1, end_2 = (d.bulk_modulus / (d.end_volume + s * d.end_area * y[6]) for s in (1, -1))
    gains = np.array([d.source_gain, d.chamber_gain, d.chamber_gain, end_1, end_2, d.load_gain, d.load_gain])
    out = rates(0.0, y, rec)
    flows = out[PRESSURES] / gains / d.source_flow
    return np.array([*flows, out[5] * d.mass / (1e6 * d.end_area)])


def mass_gap(rec, y: np.ndarray) -> float:
    """QL1 + QL2 + end-seal leakage - Qs [m³/s]."""
    d = rec[0]
    loads = d.load_1 * np.sqrt(y[7]) + d.load_2 * np.sqrt(y[8])
    return float(loads + d.seal_leakage * (y[3] + y[4]) - d.source_flow)


def found_from_guess(rec):
    return find_equilibrium(rec, initial_guess(rec))


@pytest.fixture(scope="module")
def conservative_rests(box_designs, record):
    """Records and equilibria of 200 designs of C.6's box, before and after the step."""
    recs = [record(p, phase=phase) for p in box_designs(200) for phase in (0, 1)]
    return [(rec, found_from_guess(rec)) for rec in recs]


def test_residuals_over_the_box(conservative_rests) -> None:
    for rec, rest in conservative_rests:
        assert rest is not None
        assert rest.state[5] == 0.0
        assert np.abs(imbalances(rec, rest.state)).max() <= 1e-10
        assert rest.residual <= 1e-10


def test_residuals_of_the_listing_over_the_box(box_designs, record) -> None:
    for p in box_designs(64):
        for phase in (0, 1):
            rec = record(p, "listing", phase)
            rest = found_from_guess(rec)
            if rest is None:
                # Both rims vanish where the spool leaves port 1: more than half open, the listing's flow force can
                # jump through zero there (reference/README.md), and only there is nothing to be found.
                assert p["centred_opening"] > 0.5
                continue
            found = imbalances(rec, rest.state)
            assert rest.state[5] == 0.0
            assert np.abs(found[:-1]).max() <= 1e-10
            if rests_on_stop(rec, rest.state):
                assert found[-1] * rest.state[6] >= 0.0  # pressed on
            else:
                assert abs(found[-1]) <= 1e-10


def test_no_fluid_is_lost_over_the_box(conservative_rests) -> None:
    gaps = [abs(mass_gap(rec, rest.state)) / rec[0].source_flow for rec, rest in conservative_rests]
    assert max(gaps) < 1e-12


@pytest.mark.parametrize("clearance", [1e-6, 2.9e-6, 20e-6])
def test_no_fluid_is_lost_at_the_base_set(design, record, clearance) -> None:
    rec = record(design(radial_clearance=clearance))
    assert abs(mass_gap(rec, found_from_guess(rec).state)) < 1e-12 * rec[0].source_flow


@pytest.mark.parametrize(("clearance", "gap"), [(2.9e-6, 4.04e-8), (20e-6, 1.42e-5)])
def test_the_listing_makes_fluid_from_nothing(design, record, clearance, gap) -> None:
    # model.md section 2, measured there with independent prototypes; three digits.
    rec = record(design(radial_clearance=clearance), "listing")
    assert mass_gap(rec, found_from_guess(rec).state) == pytest.approx(gap, rel=0.5 / 142)


def test_where_it_is_does_not_depend_on_where_the_search_begins(design, record) -> None:
    rec = record(design())
    expected = found_from_guess(rec).state
    stop = rec[0].stop_position
    moving = np.array([1e7, 1e7, 1e7, 1e7, 1e7, 1.0, 0.0, 1e7, 1e7])
    starts = [zero_state(), moving]
    for place in (-0.99, 0.5, 0.99):
        start = initial_guess(rec)
        start[6] = place * stop
        starts.append(start)
    starts.append(expected * (1 + 1e-3 * np.sin(np.arange(9))))
    for start in starts:
        np.testing.assert_allclose(find_equilibrium(rec, start).state, expected, rtol=1e-9, atol=1e-15)


def test_the_valve_is_symmetric(design, record) -> None:
    p = design(centred_opening=0.4)
    one = record(p, scenario=Scenario(events=(load_step(1, 15e6),)))
    two = record(p, scenario=Scenario(events=(load_step(2, 15e6),)))
    np.testing.assert_allclose(
        found_from_guess(two).state,
        MIRROR_SIGNS * found_from_guess(one).state[MIRROR],
        rtol=1e-10,
        atol=1e-18,
    )


def test_equal_loads_leave_the_spool_centred(box_designs, record) -> None:
    for p in box_designs(16):
        rec = record(p, phase=0)
        state = found_from_guess(rec).state
        assert abs(state[6]) < 1e-12
        np.testing.assert_allclose(state[[1, 3, 7]], state[[2, 4, 8]], rtol=1e-12)


def test_no_equilibrium_is_none(design, record) -> None:
    # With the listing the force jumps through zero at x = d0 + rv, where it lets both rims vanish: there is no root.
    rec = record(
        design(
            spool_radius=0.01216672736689613,
            groove_width=0.0008711971524745354,
            total_pressure_drop=4781832.437796149,
            fixed_drop_ratio=0.6985849115549425,
            centred_opening=0.6222131552921463,
        ),
        "listing",
    )
    assert found_from_guess(rec) is None


def test_the_listing_rests_pressed_on_its_stop(reference, listing_design, record) -> None:
    rows = reference("listing_objectives")
    for row in rows[rows["at_stop"] == 1].itertuples():
        rec = record(listing_design(row), "listing")
        start = initial_guess(rec)
        start[6] = np.nextafter(np.copysign(row.xmax, row.x_end), np.inf * row.x_end)
        rest = find_equilibrium(rec, start)
        assert rest is not None
        assert rest.state[6] == np.copysign(rec[0].stop_position, row.x_end)
        assert rests_on_stop(rec, rest.state)
        found = imbalances(rec, rest.state)
        assert np.abs(found[:-1]).max() < 1e-10
        assert found[-1] * rest.state[6] > 0
        assert rest.state[0] == pytest.approx(row.ssPs, rel=1e-6)  # the author's integration ended there


@pytest.mark.parametrize("name", ["thesis_base", "thesis_prototype"])
def test_margin_is_the_rate_at_which_a_disturbance_dies(design, record, name) -> None:
    rec = record(design(name))
    rest = found_from_guess(rec).state
    margin = stability_margin(rec, rest)
    # Any small disturbance is the slowest mode after a while: watch the source pressure come back.
    begin = rest.copy()
    begin[0] += 1e4
    times = np.linspace(4.0, 7.0, 9) / margin
    run = integrate(
        lambda t, y: rates(t, y, rec),
        lambda t, y: jacobian(t, y, rec),
        (0.0, float(times[-1])),
        begin,
        solver_settings("LSODA", 1e-11, max_steps=100_000),
    )
    gap = np.abs(run.at(times)[:, 0] - rest[0])
    slope = np.polyfit(times, np.log(gap), 1)[0]
    assert margin == pytest.approx(-slope, rel=2e-3)


def test_margin_is_taken_without_coulomb_friction(design, record) -> None:
    free, sticky = record(design()), record(design(coulomb_friction=10.0))
    rest = found_from_guess(free).state
    assert stability_margin(sticky, rest) == stability_margin(free, rest)
    assert sticky[0].coulomb_friction == 10.0  # and the design stays as it was


def test_without_friction_changes_a_copy(design, record) -> None:
    rec = record(design(coulomb_friction=10.0))
    free = without_friction(rec, 3.0)
    assert (free[0].coulomb_friction, free[0].extra_force) == (0.0, 3.0)
    assert (rec[0].coulomb_friction, rec[0].extra_force) == (10.0, 0.0)


def test_an_extra_force_moves_the_balance_by_itself(design, record) -> None:
    rec = without_friction(record(design()), 5.0)
    y = find_equilibrium(rec, initial_guess(rec)).state
    assert rates(0.0, y, record(design()))[5] * rec[0].mass == pytest.approx(-5.0, rel=1e-8)


def test_margin_of_a_state_that_is_not_a_number_is_not_a_number(design, record) -> None:
    assert np.isnan(stability_margin(record(design()), np.full(9, np.nan)))
