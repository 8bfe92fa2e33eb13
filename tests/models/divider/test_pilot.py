import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial.chebyshev import Chebyshev

from divideropt.models.divider import FORMULATIONS
from divideropt.models.divider.pilot import PilotSide, pilot_sides

# A box around C.6's, with what else enters the stage. Groove lengths φ0/√c from 1e-3 to 1e3: nearly straight
# profiles, and profiles that are nothing but boundary layers.
DESIGNS = st.fixed_dictionaries(
    {
        "spool_radius": st.floats(3e-3, 30e-3),
        "groove_width": st.floats(0.2e-3, 4e-3),
        "radial_clearance": st.floats(0.3e-6, 40e-6),
        "land_distance": st.floats(1e-3, 20e-3),
        "groove_angle": st.floats(0.1, 2 * math.pi),
    }
)
VISCOSITY = st.floats(1e-3, 0.5)
POSITION = st.floats(0.02, 0.98)

DENSITY = 900.0

CONSERVATIVE, LISTING = FORMULATIONS["conservative"], FORMULATIONS["listing"]


def imbalance(side: PilotSide) -> tuple[np.ndarray, float]:
    """2 Qc_i + Qlb - 2 Qb - 2 Qa_o - Qla, a coefficient a pressure, and the size of what is summed."""
    terms = [
        2 * side.inlet,
        side.end_leakage,
        -2 * side.tap,
        -2 * side.outlet,
        -side.chamber_leakage,
    ]
    return np.sum(terms, axis=0), float(np.sum(np.abs(terms)))


@given(DESIGNS, VISCOSITY, POSITION)
def test_what_enters_a_side_leaves_it(design, changes, viscosity, position) -> None:
    for side in pilot_sides(design(**changes, kinematic_viscosity=viscosity / DENSITY), position, CONSERVATIVE):
        gap, size = imbalance(side)
        assert np.isfinite(size)
        assert np.abs(gap).max() <= 1e-15 * size


@given(DESIGNS, VISCOSITY, POSITION)
def test_supply_and_chambers_exchange_what_they_lose(design, changes, viscosity, position) -> None:
    # The identity again, as the equations of motion see it: the source's, the flow chamber's and the end
    # chamber's gains sum to nothing, so Qs = QL1 + QL2 + end-seal leakage once all rates vanish.
    for side in pilot_sides(design(**changes, kinematic_viscosity=viscosity / DENSITY), position, CONSERVATIVE):
        net = side.net()
        assert np.abs(net.sum(axis=0)).max() <= 2e-15 * np.abs(net).sum()


@given(DESIGNS, VISCOSITY, POSITION)
def test_equal_pressures_move_nothing(design, changes, viscosity, position) -> None:
    for side in pilot_sides(design(**changes, kinematic_viscosity=viscosity / DENSITY), position, CONSERVATIVE):
        for row in vars(side).values():
            assert abs(row.sum()) <= 1e-15 * np.abs(row).sum()


@given(DESIGNS, VISCOSITY, POSITION)
def test_the_sides_are_mirror_images(design, changes, viscosity, position) -> None:
    p = design(**changes, kinematic_viscosity=viscosity / DENSITY)
    side_1, side_2 = pilot_sides(p, position, CONSERVATIVE)
    other_1, other_2 = pilot_sides(p, 1 - position, CONSERVATIVE)
    for one, other in ((side_1, other_2), (side_2, other_1)):
        for name, row in vars(one).items():
            np.testing.assert_allclose(
                row, vars(other)[name], rtol=1e-10, atol=1e-13 * np.abs(row).max(), err_msg=name
            )


@given(DESIGNS, VISCOSITY, POSITION)
def test_flows_run_down_the_pressures(design, changes, viscosity, position) -> None:
    # Supply above end chamber above flow chamber: into the groove, on along it, out.
    pressures = np.array([3.0, 1.0, 2.0])
    for side in pilot_sides(design(**changes, kinematic_viscosity=viscosity / DENSITY), position, CONSERVATIVE):
        assert side.inlet @ pressures > 0
        assert side.outlet @ pressures > 0
        assert side.chamber_leakage @ pressures > 0


def chebyshev_profile(c: float, begin: tuple[float, float], end: tuple[float, float], mean: float) -> Chebyshev:
    """Solve c P'' = P - Pm between (angle, pressure) and (angle, pressure) by collocation."""
    n = 64
    points = np.cos(np.pi * np.arange(n + 1) / n)
    basis = [Chebyshev.basis(k) for k in range(n + 1)]
    stretch = 2 / (end[0] - begin[0])
    matrix = np.stack([c * stretch**2 * b.deriv(2)(points) - b(points) for b in basis], axis=1)
    right = np.full(n + 1, -mean)
    for row, place, pressure in ((0, 1.0, end[1]), (n, -1.0, begin[1])):
        matrix[row] = [b(place) for b in basis]
        right[row] = pressure
    return Chebyshev(np.linalg.solve(matrix, right), domain=[begin[0], end[0]])


@given(
    st.fixed_dictionaries(
        {  # boundary layers no thinner than 64 polynomials resolve
            "spool_radius": st.floats(6e-3, 16e-3),
            "groove_width": st.floats(0.6e-3, 2e-3),
            "radial_clearance": st.floats(1e-6, 20e-6),
        }
    ),
    st.floats(0.1, 0.9),
    st.tuples(st.floats(5e6, 4e7), st.floats(1e6, 3e7), st.floats(1e6, 3e7)),
)
def test_flows_are_those_of_a_numerical_profile(design, changes, position, pressures) -> None:
    """model.md section 2: groove flow -b⁴/(185 μ r) P', leakage rδ³/(6μh) times the integrals of Pb-P, P-Pa."""
    p, viscosity = design(**changes), 0.027
    r, b, delta, h = (p[k] for k in ("spool_radius", "groove_width", "radial_clearance", "land_distance"))
    c = 6 * b**4 * h / (185 * r**2 * delta**3)
    ps, pa, pb = pressures
    angle, tap = p["groove_angle"], position * p["groove_angle"]
    near = chebyshev_profile(c, (0.0, ps), (tap, pb), (pa + pb) / 2)
    far = chebyshev_profile(c, (tap, pb), (angle, pa), (pa + pb) / 2)
    groove, land = -(b**4) / (185 * viscosity * r), r * delta**3 / (6 * viscosity * h)
    integral = sum(part.integ(lbnd=part.domain[0])(part.domain[1]) for part in (near, far))
    arriving, leaving = groove * near.deriv()(tap), groove * far.deriv()(tap)
    expected = {
        "inlet": groove * near.deriv()(0.0),
        "arriving": arriving,
        "tap": arriving - leaving,
        "outlet": groove * far.deriv()(angle),
        "end_leakage": land * (pb * angle - integral),
        "chamber_leakage": land * (integral - pa * angle),
    }
    side = pilot_sides(p, position, CONSERVATIVE)[0]
    for name, value in expected.items():
        row = getattr(side, name)
        size = float(np.abs(row) @ np.abs(pressures))
        assert row @ np.array(pressures) == pytest.approx(value, abs=1e-9 * size), name


def test_a_wide_clearance_neither_overflows_nor_cancels(design) -> None:
    # φ0/√c = 2000: cosh and sinh would overflow; the groove is then all boundary layer, coth = 1, 1/sinh = 0.
    p = design(radial_clearance=300e-6, groove_width=0.2e-3, spool_radius=30e-3)
    side, _ = pilot_sides(p, 0.5, CONSERVATIVE)
    conductance = p["groove_width"] ** 2 / 0.027 * math.sqrt(300e-6**3 / (6 * 185 * p["land_distance"]))
    np.testing.assert_allclose(side.inlet, conductance * np.array([1.0, -0.5, -0.5]), rtol=1e-13)
    np.testing.assert_allclose(side.outlet, conductance * np.array([0.0, -0.5, 0.5]), rtol=1e-13)


@pytest.mark.parametrize("side", [0, 1])
def test_the_listing_breaks_the_identity(design, side) -> None:
    gap, size = imbalance(pilot_sides(design(), 0.5, LISTING)[side])
    assert np.abs(gap).max() > 1e-7 * size  # rounding makes 1e-15 of it, see above


def test_the_listing_mirrors_all_but_a_leakage(design) -> None:
    # C.3 has a minus before side 2's bracket in Qlbg2, where the mirror image has a plus.
    side_1, side_2 = pilot_sides(design(), 0.5, LISTING)
    for name in ("inlet", "arriving", "tap", "outlet", "chamber_leakage"):
        np.testing.assert_allclose(getattr(side_1, name), getattr(side_2, name), rtol=1e-13, err_msg=name)
    across = (side_1.end_leakage + side_1.chamber_leakage) / 2
    np.testing.assert_allclose(side_1.end_leakage + side_2.end_leakage, 2 * across, rtol=1e-12, atol=1e-30)
    assert np.abs(side_1.end_leakage - side_2.end_leakage).max() > 0.1 * np.abs(side_1.end_leakage).max()
