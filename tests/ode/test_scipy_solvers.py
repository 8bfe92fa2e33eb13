import math
import warnings

import numpy as np
import pytest

from divideropt.ode import METHODS, SolverSettings, SolverStatus, integrate

# A linear problem, y' = A y, with eigenvalues -1 and -1e6 and neither vector along an axis.
FAST = 1e6
VECTORS = np.array([[2.0, 1.0], [1.0, -1.0]])
MATRIX = VECTORS @ np.diag([-1.0, -FAST]) @ np.linalg.inv(VECTORS)
START = np.array([3.0, 0.0])  # one of each vector

EULER = (np.array([1.0]), lambda t, y: -y, lambda t, y: np.array([[-1.0]]))


def linear_solution(times: np.ndarray) -> np.ndarray:
    modes = np.stack([np.exp(-times), np.exp(-FAST * times)])
    return (VECTORS @ modes).T


def settings(method: str, rtol: float = 1e-8, states: int = 1, max_steps: int = 10_000) -> SolverSettings:
    return SolverSettings(method, rtol, (rtol * 1e-3,) * states, max_steps)


def decay(method: str, span: tuple[float, float] = (0.0, 1.0), **more):
    start, rates, jacobian = EULER
    event = more.pop("event", None)
    return integrate(rates, jacobian, span, start, settings(method, **more), event)


@pytest.mark.parametrize(
    ("method", "most_steps"),
    # What each needs today, and a tenth more: solvers are held to a cost as well as to an error.
    [("LSODA", 190), ("BDF", 256), ("Radau", 232)],
)
def test_solves_a_stiff_linear_problem(method: str, most_steps: int) -> None:
    trajectory = integrate(
        lambda t, y: MATRIX @ y, lambda t, y: MATRIX, (0.0, 2.0), START, settings(method, 1e-8, states=2)
    )
    assert trajectory.status is SolverStatus.FINISHED
    assert trajectory.edges[0] == 0.0
    assert trajectory.edges[-1] == 2.0
    assert (np.diff(trajectory.edges) > 0).all()
    times = np.concatenate([[0.0], np.geomspace(1e-9, 2.0, 400)])
    error = np.abs(trajectory.at(times) - linear_solution(times))
    assert error.max() < 2e-7
    assert error[-1].max() < 1e-7
    assert len(trajectory.values) <= most_steps


@pytest.mark.parametrize("method", METHODS)
def test_a_tighter_tolerance_makes_a_smaller_error(method: str) -> None:
    errors = []
    for rtol in (1e-4, 1e-7, 1e-10):
        final = decay(method, rtol=rtol).final[0]
        errors.append(abs(final - math.exp(-1.0)))
    assert errors[2] < errors[1] < errors[0]
    assert errors[2] < 1e-8


@pytest.mark.parametrize("method", METHODS)
def test_steps_join_up(method: str) -> None:
    trajectory = decay(method)
    np.testing.assert_allclose(trajectory.values[1:, :, 0], trajectory.values[:-1, :, -1], rtol=1e-7)
    np.testing.assert_allclose(trajectory.values[0, :, 0], [1.0], rtol=1e-7)


@pytest.mark.parametrize("method", METHODS)
def test_stops_where_the_budget_of_steps_ends(method: str) -> None:
    trajectory = decay(method, max_steps=7)
    assert trajectory.status is SolverStatus.STEP_BUDGET
    assert trajectory.message == "7 steps did not suffice"
    assert len(trajectory.values) == 7
    assert 0.0 < trajectory.edges[-1] < 1.0
    assert trajectory.final[0] == pytest.approx(math.exp(-trajectory.edges[-1]), rel=1e-6)


@pytest.mark.parametrize("method", METHODS)
def test_a_budget_that_just_suffices_finishes(method: str) -> None:
    needed = len(decay(method).values)
    assert decay(method, max_steps=needed).status is SolverStatus.FINISHED
    assert decay(method, max_steps=needed - 1).status is SolverStatus.STEP_BUDGET


@pytest.mark.parametrize("method", METHODS)
def test_locates_an_event_within_a_step(method: str) -> None:
    trajectory = decay(method, event=lambda y: 0.5 - y[0])
    assert trajectory.status is SolverStatus.EVENT
    assert trajectory.edges[-1] == pytest.approx(math.log(2.0), abs=1e-7)
    assert trajectory.final[0] == pytest.approx(0.5, abs=1e-13)
    before = np.linspace(0.0, trajectory.edges[-1], 200)
    np.testing.assert_allclose(trajectory.at(before)[:, 0], np.exp(-before), rtol=3e-7)


@pytest.mark.parametrize("method", METHODS)
def test_an_event_that_does_not_come_changes_nothing(method: str) -> None:
    free, watched = decay(method), decay(method, event=lambda y: 0.1 - y[0])
    assert watched.status is SolverStatus.FINISHED
    np.testing.assert_array_equal(free.edges, watched.edges)
    np.testing.assert_array_equal(free.values, watched.values)


@pytest.mark.parametrize("method", METHODS)
def test_an_event_in_force_from_the_start_ends_the_first_step(method: str) -> None:
    trajectory = decay(method, event=lambda y: 1.0)
    assert trajectory.status is SolverStatus.EVENT
    assert len(trajectory.values) == 1


@pytest.mark.parametrize("method", METHODS)
def test_goes_on_after_an_event(method: str) -> None:
    _, rates, jacobian = EULER
    first = decay(method, event=lambda y: 0.5 - y[0])
    second = integrate(rates, jacobian, (float(first.edges[-1]), 1.0), first.final, settings(method))
    whole = first.then(second)
    times = np.linspace(0.0, 1.0, 300)
    assert whole.status is SolverStatus.FINISHED
    np.testing.assert_allclose(whole.at(times)[:, 0], np.exp(-times), rtol=3e-7)


@pytest.mark.parametrize("method", METHODS)
def test_a_solution_that_ends_is_not_finished(method: str) -> None:
    # y' = y², y(0) = 1 is 1/(1 - t): there is nothing at t = 2.
    trajectory = integrate(
        lambda t, y: y * y,
        lambda t, y: np.array([[2 * y[0]]]),
        (0.0, 2.0),
        np.array([1.0]),
        settings(method, max_steps=300),
    )
    assert trajectory.status in {SolverStatus.STEP_BUDGET, SolverStatus.FAILED}
    assert trajectory.message
    assert 0.9 < trajectory.edges[-1] < 1.0 + 1e-6
    assert (np.diff(trajectory.edges) > 0).all()


@pytest.mark.parametrize("method", ["BDF", "Radau"])
def test_rates_that_are_not_numbers_fail_as_a_value(method: str) -> None:
    trajectory = integrate(
        lambda t, y: -y if t < 0.5 else y * np.nan, EULER[2], (0.0, 1.0), EULER[0], settings(method)
    )
    assert trajectory.status is SolverStatus.FAILED
    assert trajectory.message
    assert trajectory.edges[-1] == pytest.approx(0.5, abs=1e-9)
    assert np.isfinite(trajectory.values).all()


@pytest.mark.parametrize("method", ["LSODA", "BDF", "Radau"])
@pytest.mark.parametrize("begin", [0.0, 0.5])
def test_rates_and_jacobian_that_are_not_numbers_fail_as_a_value(method: str, begin: float) -> None:
    trajectory = integrate(
        lambda t, y: -y if t < begin else y * np.nan,
        lambda t, y: np.array([[-1.0 if t < begin else np.nan]]),
        (0.0, 1.0),
        EULER[0],
        settings(method),
    )
    assert trajectory.status is SolverStatus.FAILED
    assert trajectory.message


@pytest.mark.parametrize("method", METHODS)
def test_a_failure_makes_no_noise(method: str) -> None:
    # y' jumps over its own solution: no step is small enough.
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        trajectory = integrate(
            lambda t, y: -np.sign(y - 0.5),
            lambda t, y: np.array([[0.0]]),
            (0.0, 1.0),
            EULER[0],
            settings(method, max_steps=2000),
        )
    assert trajectory.status in {SolverStatus.STEP_BUDGET, SolverStatus.FAILED}
    assert (np.diff(trajectory.edges) > 0).all()
