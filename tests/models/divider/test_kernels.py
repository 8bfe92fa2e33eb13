import math
from collections.abc import Iterator
from contextlib import contextmanager

import numpy as np
import pytest
from hypothesis import Phase, assume, given, settings
from hypothesis import strategies as st

from divideropt.models.divider import Scenario, groove_kernels, kernels
from divideropt.models.divider.formulations import OrificeLaw, PortRange, Stop
from divideropt.models.divider.kernels import ROOT_BLEND, jacobian, rates, signed_root
from divideropt.models.divider.states import N_STATES, STATES

NESTED = [
    (module, name, f.py_func)
    for module in (kernels, groove_kernels)
    for name, f in vars(module).items()
    if hasattr(f, "py_func") and name not in ("rates", "jacobian")
]
FORMULATIONS = ("conservative", "text", "listing")

STATE_SCALES = np.array([1e7, 1e7, 1e7, 1e7, 1e7, 0.1, 1e-3, 1e7, 1e7])

DESIGNS = st.fixed_dictionaries(
    {
        "spool_radius": st.floats(6e-3, 16e-3),
        "groove_width": st.floats(0.6e-3, 2e-3),
        "total_pressure_drop": st.floats(2e6, 10e6),
        "fixed_drop_ratio": st.floats(0.3, 0.95),
        "centred_opening": st.floats(0.1, 0.9),
        "coulomb_friction": st.sampled_from([0.0, 10.0]),
        "fixed_area_ratio": st.floats(0.5, 2.0),
    }
)
PRESSURE = st.floats(-2e6, 4e7)
# ẋ near 0 too, where friction acts; x in thousandths of the stop, to 1.1 of it.
SPEED = st.floats(-0.5, 0.5) | st.floats(-3e-6, 3e-6)
PLACE = st.integers(-1100, 1100).map(lambda k: k / 1000)
STATE = st.tuples(*[PRESSURE] * 5, SPEED, PLACE, PRESSURE, PRESSURE)


def state_of(drawn, d) -> np.ndarray:
    y = np.array(drawn)
    y[STATES.index("x")] *= d.stop_position
    return y


@contextmanager
def python_instead() -> Iterator[None]:
    """Let the kernels' Python sources call each other's Python sources, not the compiled functions."""
    with pytest.MonkeyPatch.context() as patch:
        for module, name, source in NESTED:
            patch.setattr(module, name, source)
        yield


def ports_are_numbers(y: np.ndarray, d) -> bool:
    """Whether both ports stay within their arccosines: beyond, the compiled kernel gives NaN, Python raises."""
    x1 = y[6]
    if d.port_range == PortRange.FIRST:
        x = math.copysign(min(abs(y[6]), d.stop_position), y[6])
        x1 = min(max(x, d.port_offset - d.port_radius), d.port_offset + d.port_radius)
    return max(abs(d.port_offset + x1), abs(d.port_offset - x1)) < d.port_radius


@pytest.mark.parametrize("formulation", FORMULATIONS)
@given(DESIGNS, STATE)
def test_compiled_and_python_source_agree(design, record, formulation, changes, drawn) -> None:
    rec = record(design(**changes), formulation)
    y = state_of(drawn, rec[0])
    assume(formulation == "conservative" or ports_are_numbers(y, rec[0]))
    compiled = rates(0.0, y, rec), jacobian(0.0, y, rec)
    with python_instead():
        python = rates.py_func(0.0, y, rec), jacobian.py_func(0.0, y, rec)
    # Sums of terms that cancel: rounding is relative to the terms, and so to a row of the Jacobian times the state.
    terms = np.abs(compiled[1]) @ np.maximum(np.abs(y), STATE_SCALES)
    assert (np.abs(compiled[0] - python[0]) <= 1e-14 * (terms + np.abs(compiled[0]))).all()
    np.testing.assert_allclose(
        compiled[1] * STATE_SCALES, python[1] * STATE_SCALES, rtol=1e-13, atol=1e-14 * terms.max()
    )


@given(st.lists(st.floats(-1e8, 1e8), min_size=1, max_size=20), st.sampled_from(OrificeLaw))
def test_compiled_and_python_root_agree(drops, law) -> None:
    drop = np.array(drops)
    compiled = signed_root(drop, law)
    with python_instead():
        python = signed_root.py_func(drop, law)
    np.testing.assert_allclose(compiled, python, rtol=1e-15)


# States away from every kink in the pressures: each on a grid of its own, so that none is within 15 kPa of 0 and
# no two within 25 kPa of each other.
OFFSETS = 15e3 + 25e3 * np.arange(7)


def smooth_states(lowest: int) -> st.SearchStrategy[np.ndarray]:
    return st.tuples(st.tuples(*[st.integers(lowest, 200)] * 7), SPEED, PLACE).map(
        lambda drawn: np.insert(2e5 * np.array(drawn[0]) + OFFSETS, 5, [drawn[1], drawn[2]])
    )


def distance_to_a_kink(y: np.ndarray, d) -> float:
    """How far x [m] is from a port's edge or the stop."""
    edges = [abs(abs(d.port_offset + side * y[6]) - d.port_radius) for side in (-1, 1)]
    return min(*edges, abs(abs(y[6]) - d.stop_position))


@pytest.mark.parametrize("formulation", FORMULATIONS)
@given(DESIGNS, smooth_states(lowest=0))
def test_jacobian_is_the_central_difference_of_the_rates(design, record, formulation, changes, drawn) -> None:
    check_jacobian(record(design(**changes), formulation), drawn)


@pytest.mark.parametrize("formulation", FORMULATIONS)
@settings(phases=[Phase.explicit, Phase.generate])
@given(DESIGNS, smooth_states(lowest=-20))
def test_jacobian_holds_for_negative_pressures(design, record, formulation, changes, drawn) -> None:
    check_jacobian(record(design(**changes), formulation), drawn)


def check_jacobian(rec, drawn) -> None:
    d = rec[0]
    y = state_of(drawn, d)
    assume(d.port_range == PortRange.OWN or ports_are_numbers(y, d))
    assume(distance_to_a_kink(y, d) > 1e-6)
    in_friction = d.coulomb_friction > 0.0 and abs(y[5]) < 5e-4
    steps = np.array([100.0] * 5 + [1e-9 if in_friction else 1e-4, 1e-8, 100.0, 100.0])
    exact = jacobian(0.0, y, rec)
    terms = np.abs(exact) @ np.maximum(np.abs(y), STATE_SCALES)
    for column, step in enumerate(steps):
        shift = np.zeros(N_STATES)
        shift[column] = step
        near = rates(0.0, y + shift, rec) - rates(0.0, y - shift, rec)
        far = rates(0.0, y + 2 * shift, rec) - rates(0.0, y - 2 * shift, rec)
        numerical = (8 * near - far) / (12 * step)  # of fourth order: what is left is rounding of the terms
        error = np.abs(numerical - exact[:, column])
        assert (error <= 1e-6 * np.abs(exact[:, column]) + 4e-15 * terms / step).all(), STATES[column]


def test_derivatives_of_the_authors_code(reference, listing_design, record) -> None:
    rows = reference("listing_derivatives")
    expected = rows[[f"d{name}" for name in STATES]].to_numpy()
    found = np.empty_like(expected)
    rounding = np.zeros(expected.shape, dtype=bool)
    for i, row in enumerate(rows.itertuples()):
        p = listing_design(row)
        scenario = Scenario(source_flow=row.Qs, spool_position=row.phi_ratio)
        rec = record(p, "listing", scenario=scenario)
        per_area = p["load_discharge"] * math.sqrt(2 / p["density"])
        rec[0].load_1, rec[0].load_2 = per_area * row.AL1, per_area * row.AL2
        found[i] = rates(row.t, np.array([getattr(row, name) for name in STATES]), rec)
        for port in ("1", "2"):
            if clipped_onto_edge(row, port):
                rounding[i, [STATES.index(f"Pa{port}"), STATES.index(f"PL{port}")]] = True
    scale = np.nanmax(np.abs(expected), axis=0)
    # At a clip rounding decides between acos(±1) and acos of more, a number and NaN: either will do, but two
    # numbers must agree there too.
    differ = np.isnan(found) != np.isnan(expected)
    assert not (differ & ~rounding).any()
    both = ~np.isnan(found) & ~np.isnan(expected)
    error = np.where(both, np.abs(found - expected), 0.0) / scale
    assert error.max() <= 1e-12
    assert np.isnan(expected).sum() > 100  # the data do hold such cases
    assert both.sum() > 2000


def clipped_onto_edge(row, port: str) -> bool:
    """Whether C.3 clips x to port 1's range and so puts this port's arccosine at ±1, up to rounding."""
    x = math.copysign(min(abs(row.x), row.xmax), row.x)
    x1 = min(max(x, row.d0 - row.rv), row.d0 + row.rv)
    e = row.d0 - x1 if port == "1" else row.d0 + x1
    return x1 != x and abs(abs(e) / row.rv - 1) < 4 * np.finfo(float).eps


DROPS = st.floats(-1e8, 1e8).filter(lambda p: p == 0.0 or abs(p) > 1e-250)


@given(DROPS, st.sampled_from(OrificeLaw))
def test_orifice_law_is_odd(drop, law) -> None:
    plus, minus = signed_root(np.array([drop, -drop]), law)
    assert plus == -minus


@given(st.floats(ROOT_BLEND, 1e8))
def test_orifice_law_is_the_root_beyond_the_blend(drop) -> None:
    for law in (OrificeLaw.SMOOTH_ROOT, OrificeLaw.SIGNED_ROOT):
        assert signed_root(np.array([drop]), law)[0] == math.sqrt(drop)


@given(st.floats(0.0, 1e8))
def test_printed_orifice_law(drop) -> None:
    found = signed_root(np.array([drop]), OrificeLaw.TANH_ROOT)[0]
    assert found == pytest.approx(math.tanh(drop / 1e4) * math.sqrt(drop), rel=1e-14)  # (2.9), p_tan of model.md


def test_smooth_root_is_once_continuously_differentiable_at_the_blend() -> None:
    assert ROOT_BLEND == 100.0  # model.md section 1
    steps = np.array([1e-3, 1e-4, 1e-5])
    for sign in (-1.0, 1.0):
        inner = signed_root(sign * (100.0 - steps), OrificeLaw.SMOOTH_ROOT)
        # Value sqrt(100) = 10 and slope 1/(2 sqrt(100)) = 0.05, with a second derivative of order 1e-3 to spare.
        np.testing.assert_allclose(inner, sign * (10.0 - 0.05 * steps), atol=2e-9, rtol=0)
        slopes = (sign * 10.0 - inner) / (sign * steps)
        assert (np.abs(slopes - 0.05) <= 1e-3 * steps + 1e-9).all()


def test_smooth_root_rises_with_a_finite_slope_through_zero() -> None:
    drop = np.linspace(-150.0, 150.0, 30_001)
    root = signed_root(drop, OrificeLaw.SMOOTH_ROOT)
    slopes = np.diff(root) / np.diff(drop)
    assert (slopes > 0).all()
    assert slopes.max() < 0.13  # 1.25/sqrt(100) at 0
    assert root[15_000] == 0.0


def test_signed_root_works_elementwise() -> None:
    pressures = np.array([4e6, 9e6, -1.0, 0.0, 1e6, 16e6])
    np.testing.assert_array_equal(
        signed_root(pressures, OrificeLaw.SIGNED_ROOT), np.sign(pressures) * np.sqrt(np.abs(pressures))
    )


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_contact_pushes_back_and_never_pulls(design, record, side) -> None:
    rec = record(design())
    free = rec.copy()
    free[0].stop = Stop.NONE
    depth = 10e-6
    speeds = np.array([-1.0, -0.1, 0.0, 0.1, 1.0])

    def contact_force(speed: float, beyond: float) -> float:
        y = np.array([20e6, 18e6, 18e6, 19e6, 19e6, speed, side * (rec[0].stop_position + beyond), 15e6, 10e6])
        return float(rec[0].mass * (rates(0.0, y, rec) - rates(0.0, y, free))[5])

    forces = np.array([contact_force(side * v, depth) for v in speeds])  # positive speeds press on
    assert (side * forces <= 0).all()
    assert (np.diff(side * forces) <= 0).all()
    assert side * forces[2] == pytest.approx(-kernels.STOP_STIFFNESS * depth)
    assert forces[0] == 0.0  # it comes off faster than the contact can follow
    assert contact_force(side * 0.1, -1e-9) == 0.0


def test_the_listing_freezes_the_spool_beyond_the_stop(design, record) -> None:
    rec = record(design(), "listing")
    stop = float(rec[0].stop_position)
    y = np.array([20e6, 18e6, 18e6, 19.1e6, 19e6, 0.2, 1.01 * stop, 15e6, 10e6])
    beyond = rates(0.0, y, rec)
    assert beyond[6] == 0.0
    assert beyond[5] != 0.0  # while the velocity goes on growing
    y[6] = 1.5 * stop
    np.testing.assert_array_equal(rates(0.0, y, rec), beyond)
