import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from divideropt.ode.base import NODES, NODES_PER_STEP
from divideropt.ode.polynomial import coefficients, value_at


@given(st.lists(st.floats(-1e7, 1e7), min_size=NODES_PER_STEP, max_size=NODES_PER_STEP), st.floats(0.0, 1.0))
def test_a_polynomial_is_found_again(given_coefficients, place) -> None:
    shifted = np.polynomial.Polynomial(given_coefficients, domain=[0.0, 1.0])
    c = np.empty(NODES_PER_STEP)
    coefficients(shifted(NODES), c)
    assert abs(value_at(place, c) - shifted(place)) <= 1e-12 * np.abs(given_coefficients).sum() + 1e-300


def test_the_nodes_values_are_met() -> None:
    values, c = np.random.default_rng(0).normal(size=NODES_PER_STEP), np.empty(NODES_PER_STEP)
    coefficients(values, c)
    np.testing.assert_allclose([value_at(place, c) for place in NODES], values, rtol=1e-12, atol=1e-12)
