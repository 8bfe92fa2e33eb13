import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from divideropt.models.divider import QUANTITIES
from divideropt.problem import AGGREGATES, Objective

# Goals and weights of C.5, in the order of the thesis: steady-state error, source pressure, dynamic error.
THESIS = (
    Objective(QUANTITIES["steady_state_error"], goal=0.5, weight=3),
    Objective(QUANTITIES["source_pressure"], goal=18e6, weight=1),
    Objective(QUANTITIES["dynamic_error"], goal=0.5e-6, weight=3),
)
VALUES = st.tuples(st.floats(0, 100), st.floats(1e6, 1e8), st.floats(0, 1e-4))


def test_goal_attainment_by_hand() -> None:
    # (3.24): λ = ((1.0 - 0.5)/0.5·3, (20 - 18)/18·1, (0.75 - 0.5)/0.5·3) = (3, 0.111, 1.5), and met goals below.
    F = np.array([[1.0, 20e6, 0.75e-6], [0.4, 17.1e6, 0.45e-6], [0.5, 27e6, 0.1e-6], [0.5, 18e6, 0.5e-6]])
    found = AGGREGATES["goal_attainment"](F, THESIS)
    np.testing.assert_allclose(found, [3.0, -0.05, 0.5, 0.0], rtol=1e-12, atol=1e-15)


def test_power_sum_by_hand() -> None:
    # C.5: exponents 1 + (1 + w)/2 are 3, 2 and 3.
    F = np.array([[1.0, 36e6, 0.25e-6], [0.5, 18e6, 0.5e-6], [0.0, 18e6, 0.0]])
    found = AGGREGATES["power_sum"](F, THESIS)
    np.testing.assert_allclose(found, [8 + 4 + 0.125, 3.0, 1.0], rtol=1e-12)


def test_both_aggregates_of_the_authors_designs(reference) -> None:
    # His own objective values in, his own fitness out; he maximised, and gave -1e4 to more than 30 MPa.
    rows = reference("listing_objectives")
    rows = rows[(rows["istate"] == 2) & (rows["ssPs"] <= 30e6)]
    F = np.column_stack([rows["sserr"].abs(), rows["ssPs"], rows["dynerr"].abs()])
    assert len(F) > 100
    np.testing.assert_allclose(-AGGREGATES["goal_attainment"](F, THESIS), rows["valFit"], rtol=1e-10)
    np.testing.assert_allclose(-AGGREGATES["power_sum"](F, THESIS), rows["valFitPS"], rtol=1e-10)
    for i, name in enumerate(["lam1", "lam2", "lam3"]):
        one = AGGREGATES["goal_attainment"](F[:, [i]], THESIS[i : i + 1])
        np.testing.assert_allclose(one, rows[name], rtol=1e-9, atol=1e-10)


@pytest.mark.parametrize("name", AGGREGATES)
@given(VALUES, st.floats(0, 0.5), st.integers(0, 2))
def test_a_worse_objective_never_helps(name, values, worse, which) -> None:
    F = np.array([values, values])
    F[1, which] *= 1 + worse
    better, other = AGGREGATES[name](F, THESIS)
    assert other >= better


@pytest.mark.parametrize("name", AGGREGATES)
def test_a_row_a_design(name) -> None:
    F = np.array([[1.0, 20e6, 1e-6]] * 4)
    assert AGGREGATES[name](F, THESIS).shape == (4,)
    assert AGGREGATES[name](F[:1], THESIS).shape == (1,)


@pytest.mark.parametrize("name", AGGREGATES)
def test_a_goal_is_needed_of_every_objective(name) -> None:
    objectives = (THESIS[0], Objective(QUANTITIES["leakage"]), Objective(QUANTITIES["settling_time"]))
    with pytest.raises(ValueError, match="leakage, settling_time has none"):
        AGGREGATES[name](np.ones((1, 3)), objectives)
