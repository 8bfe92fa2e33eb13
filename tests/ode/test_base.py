import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.polynomial import Polynomial

from divideropt.ode import SolverStatus, Trajectory
from divideropt.ode.base import NODE_WEIGHTS, NODES, NODES_PER_STEP, lagrange_weights

DEGREE = NODES_PER_STEP - 1
coefficients = arrays(np.float64, (2, DEGREE + 1), elements=st.floats(-10, 10))


def polynomial_trajectory(edges: list[float], states: np.ndarray) -> Trajectory:
    """A trajectory whose states are polynomials in time, one a row."""
    places = np.array(edges[:-1])[:, None] + np.diff(edges)[:, None] * NODES
    values = np.stack([Polynomial(row)(places) for row in states], axis=1)
    return Trajectory(np.array(edges), values, SolverStatus.FINISHED)


def test_nodes_are_those_of_lobatto() -> None:
    assert len(NODES) == NODES_PER_STEP
    assert NODES[0] == 0.0
    assert NODES[-1] == 1.0
    assert (np.diff(NODES) > 0).all()
    np.testing.assert_allclose(NODES + NODES[::-1], 1.0, atol=1e-15)
    # Abramowitz and Stegun, table 25.6, n = 8, on [-1, 1].
    np.testing.assert_allclose(2 * NODES[4:] - 1, [0.209299217902, 0.591700181433, 0.871740148510, 1], atol=1e-12)
    tabulated = [0.412458794659, 0.341122692484, 0.210704227144, 0.035714285714]
    np.testing.assert_allclose(2 * NODE_WEIGHTS[4:], tabulated, atol=1e-12)


@pytest.mark.parametrize("degree", range(2 * NODES_PER_STEP - 2))
def test_quadrature_is_exact_up_to_degree_13(degree: int) -> None:
    assert NODES**degree @ NODE_WEIGHTS == pytest.approx(1 / (degree + 1), rel=1e-14)


def test_quadrature_is_not_exact_at_degree_14() -> None:
    # So the test above would notice a rule of lower order.
    assert abs(NODES**14 @ NODE_WEIGHTS - 1 / 15) > 1e-10


def test_weights_at_the_nodes_pick_the_node() -> None:
    np.testing.assert_array_equal(lagrange_weights(NODES), np.eye(NODES_PER_STEP))


@given(st.floats(1e-290, 1) | st.just(0.0))
def test_weights_sum_to_one(theta: float) -> None:
    assert lagrange_weights(np.array([theta])).sum() == pytest.approx(1.0, abs=1e-14)


@given(st.floats(1e-290, 1e-15))
def test_weights_hold_next_to_a_node(gap: float) -> None:
    weights = lagrange_weights(np.array([gap, 1 - gap]))
    np.testing.assert_allclose(weights, np.eye(NODES_PER_STEP)[[0, -1]], atol=1e-13)


@given(coefficients, arrays(np.float64, 20, elements=st.floats(-1, 3)))
def test_interpolation_is_exact_for_degree_7(rows: np.ndarray, times: np.ndarray) -> None:
    trajectory = polynomial_trajectory([-1.0, -0.5, 1.0, 3.0], rows)
    exact = np.stack([Polynomial(row)(times) for row in rows], axis=1)
    size = np.stack([Polynomial(np.abs(row))(np.abs(times) + 2.0) for row in rows], axis=1)
    assert (np.abs(trajectory.at(times) - exact) <= 1e-13 * (1e-3 + size)).all()


def test_interpolation_is_not_exact_for_degree_8() -> None:
    trajectory = polynomial_trajectory([0.0, 1.0], np.eye(9)[[8]])
    assert abs(trajectory.at(np.array([0.5]))[0, 0] - 0.5**8) > 1e-6


def test_at_an_edge_the_earlier_step_answers() -> None:
    values = np.stack([np.full((1, NODES_PER_STEP), step) for step in (1.0, 2.0, 3.0)])
    trajectory = Trajectory(np.array([0.0, 1.0, 2.0, 4.0]), values, SolverStatus.FINISHED)
    times = np.array([0.0, 1.0, np.nextafter(1.0, 2.0), 2.0, 3.0, 4.0])
    np.testing.assert_allclose(trajectory.at(times)[:, 0], [1, 1, 2, 2, 3, 3], rtol=1e-14)


def test_times_need_no_order() -> None:
    trajectory = polynomial_trajectory([0.0, 1.0, 2.0], np.array([[0.0, 1.0], [2.0, -1.0]]))
    np.testing.assert_allclose(trajectory.at(np.array([1.75, 0.25])), [[1.75, 0.25], [0.25, 1.75]], atol=1e-14)


def test_final_is_the_state_at_the_last_edge() -> None:
    trajectory = polynomial_trajectory([0.0, 1.0, 2.0], np.array([[0.0, 1.0], [0.0, -3.0]]))
    np.testing.assert_array_equal(trajectory.final, [2.0, -6.0])
    np.testing.assert_array_equal(trajectory.final, trajectory.at(np.array([2.0]))[0])


def test_then_appends_and_ends_as_the_later_one() -> None:
    rows = np.array([[1.0, 2.0, 3.0]])
    first = polynomial_trajectory([0.0, 0.5, 1.0], rows)
    second = polynomial_trajectory([1.0, 3.0], rows)
    second = Trajectory(second.edges, second.values, SolverStatus.STEP_BUDGET, "why")
    joined = first.then(second)
    np.testing.assert_array_equal(joined.edges, [0.0, 0.5, 1.0, 3.0])
    assert joined.values.shape == (3, 1, NODES_PER_STEP)
    assert joined.status is SolverStatus.STEP_BUDGET
    assert joined.message == "why"
    times = np.linspace(0, 3, 31)
    np.testing.assert_allclose(joined.at(times)[:, 0], Polynomial(rows[0])(times), rtol=1e-13)


def test_then_keeps_a_jump_where_the_later_one_begins_elsewhere() -> None:
    first = polynomial_trajectory([0.0, 1.0], np.array([[1.0]]))
    second = polynomial_trajectory([1.0, 2.0], np.array([[5.0]]))
    joined = first.then(second)
    around = joined.at(np.array([1.0, np.nextafter(1.0, 2.0)]))[:, 0]
    np.testing.assert_allclose(around, [1.0, 5.0], rtol=1e-14)
