import math
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from divideropt.ode import SolverSettings, SolverStatus, integrate
from divideropt.ode import rosenbrock as method
from divideropt.ode.rosenbrock import integrate_by_rosenbrock


def settings(rtol: float, scale=(1.0,), max_steps: int = 100_000) -> SolverSettings:
    return SolverSettings("rosenbrock", rtol, tuple(rtol * s for s in scale), max_steps)


def fixed_step_error(steps: int, theta: float = 1.0) -> float:
    """Error at a place of the last of so many equal steps, on y' = -2 t y², y(0) = 1, of which y = 1/(1 + t²)."""
    h, t, y = 1.0 / steps, 0.0, np.array([1.0])
    work = method.Workspace(1, 1)
    for _ in range(steps):
        work.state[:] = y
        work.s[:] = t, h, t + h, h
        work.k[:] = 0, 1, 0, 0
        matrix, slope = np.array([[-4 * t * y[0]]]), -2 * y * y
        method._stages(lambda t, y: -2 * t * y * y, matrix, -2 * t * y * y, slope, work)
        after = conclude_on_x(work, np.empty(0), watch=-1, rtol=1e9)
        assert after == method.FINISHED
        values, t, y = work.values[0].copy(), t + h, work.state.copy()
    node = int(np.argmin(np.abs(method.NODES - theta)))
    place = t - h + method.NODES[node] * h
    return abs(float(values[0, node]) - 1 / (1 + place * place))


def conclude_on_x(work, kinks, watch, rtol) -> int:
    atol = np.ones(work.state.size)
    return method.conclude(
        work.s, work.k, work.state, work.u, work.U, rtol, atol, watch, np.inf, kinks, work.edges, work.values
    )  # fmt: skip


@pytest.mark.parametrize(("theta", "order"), [(1.0, 5), (0.5, 4)])
def test_order(theta, order) -> None:
    errors = [fixed_step_error(steps, theta) for steps in (8, 16, 32)]
    rates = [math.log2(a / b) for a, b in pairwise(errors)]
    assert min(rates) > order - 0.5  # the interpolation's error within one step is a power better than over many


def test_linear_stability() -> None:
    # Stiffly accurate: on y' = λy with λh → -∞ one step ends at 0 (Steinebach 2023: L-stable).
    for stiffness in (1e4, 1e8, 1e12):
        run = integrate_by_rosenbrock(
            lambda t, y, k=stiffness: -k * y,
            lambda t, y, k=stiffness: np.array([[-k]]),
            (0.0, 1.0),
            np.ones(1),
            settings(1e-4),
        )
        assert run.status is SolverStatus.FINISHED
        assert abs(run.final[0]) < 1e-6
        assert len(run.edges) < 60


def van_der_pol(t, y):
    return np.array([y[1], ((1 - y[0] ** 2) * y[1] - y[0]) / 1e-6])


def van_der_pol_jacobian(t, y):
    return np.array([[0.0, 1.0], [(-2 * y[0] * y[1] - 1) / 1e-6, (1 - y[0] ** 2) / 1e-6]])


def robertson(t, y):
    slow, fast, made = 0.04 * y[0], 1e4 * y[1] * y[2], 3e7 * y[1] ** 2
    return np.array([-slow + fast, slow - fast - made, made])


def robertson_jacobian(t, y):
    return np.array(
        [
            [-0.04, 1e4 * y[2], 1e4 * y[1]],
            [0.04, -1e4 * y[2] - 6e7 * y[1], -1e4 * y[1]],
            [0.0, 6e7 * y[1], 0.0],
        ]
    )


def hires(t, y):
    return np.array(
        [
            -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2] + 0.0007,
            1.71 * y[0] - 8.75 * y[1],
            -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4],
            8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3],
            -1.745 * y[4] + 0.43 * y[5] + 0.43 * y[6],
            -280 * y[5] * y[7] + 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6],
            280 * y[5] * y[7] - 1.81 * y[6],
            -280 * y[5] * y[7] + 1.81 * y[6],
        ]
    )


def hires_jacobian(t, y):
    jac = np.zeros((8, 8))
    jac[0, :3] = -1.71, 0.43, 8.32
    jac[1, :2] = 1.71, -8.75
    jac[2, 2:5] = -10.03, 0.43, 0.035
    jac[3, 1:4] = 8.32, 1.71, -1.12
    jac[4, 4:7] = -1.745, 0.43, 0.43
    jac[5, 3:8] = 0.69, 1.71, -280 * y[7] - 0.43, 0.69, -280 * y[5]
    jac[6, 5:8] = 280 * y[7], -1.81, 280 * y[5]
    jac[7, 5:8] = -280 * y[7], 1.81, -280 * y[5]
    return jac


PROBLEMS = {
    # Mazzia and Magherini, Test Set for Initial Value Problem Solvers (2008): reference solutions at the end.
    "van der Pol": (
        van_der_pol,
        van_der_pol_jacobian,
        2.0,
        [2.0, 0.0],
        [1.0, 1.0],
        [1.706167732170483, -0.8928097010247975],
    ),
    "HIRES": (
        hires,
        hires_jacobian,
        321.8122,
        [1.0, 0, 0, 0, 0, 0, 0, 0.0057],
        [1e-4] * 8,
        [
            0.7371312573325668e-3,
            0.1442485726316185e-3,
            0.5888729740967575e-4,
            0.1175651343283149e-2,
            0.2386356198831331e-2,
            0.6238968252742796e-2,
            0.2849998395185769e-2,
            0.2850001604814231e-2,
        ],
    ),
    # Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.10; at t = 40 as LSODE prints it.
    "Robertson": (
        robertson,
        robertson_jacobian,
        40.0,
        [1.0, 0.0, 0.0],
        [1.0, 1e-5, 1.0],
        [0.7158270687, 0.9185534764e-5, 0.2841637457],
    ),
}


@pytest.mark.parametrize("name", PROBLEMS)
@pytest.mark.parametrize(("rtol", "error", "cost"), [(1e-4, 2e-3, 600), (1e-7, 2e-6, 2500)])
def test_stiff_problems_with_known_solutions(name, rtol, error, cost) -> None:
    rates, jacobian, end, start, scale, solution = PROBLEMS[name]
    run = integrate_by_rosenbrock(rates, jacobian, (0.0, end), np.array(start), settings(rtol, scale))
    assert run.status is SolverStatus.FINISHED
    assert len(run.edges) < cost  # held to a cost as well as to an error
    np.testing.assert_allclose(run.final, solution, rtol=error)


def test_dense_output_is_as_exact_as_the_steps() -> None:
    rates, jacobian, _, start, scale, _ = PROBLEMS["Robertson"]
    run = integrate_by_rosenbrock(rates, jacobian, (0.0, 40.0), np.array(start), settings(1e-5, scale))
    times = np.linspace(0.0, 40.0, 997)
    exact = solve_ivp(rates, (0.0, 40.0), start, "Radau", times, rtol=1e-11, atol=1e-16, jac=jacobian).y.T
    assert (np.abs(run.at(times) - exact) / (np.abs(exact) + np.array(scale)) < 1e-4).all()


def test_a_system_that_depends_on_time() -> None:
    # y' = -1000 (y - cos t): Prothero and Robinson's, whose exact solution begins on the slow curve.
    def rates(t, y):
        return -1000 * (y - math.cos(t)) - math.sin(t)

    run = integrate_by_rosenbrock(rates, lambda t, y: np.array([[-1000.0]]), (0.0, 10.0), np.ones(1), settings(1e-6))
    assert run.final[0] == pytest.approx(math.cos(10.0), abs=1e-5)
    assert len(run.edges) < 400


def test_a_budget_ends_a_run() -> None:
    rates, jacobian, end, start, scale, _ = PROBLEMS["van der Pol"]
    run = integrate_by_rosenbrock(rates, jacobian, (0.0, end), np.array(start), settings(1e-6, scale, max_steps=10))
    assert run.status is SolverStatus.STEP_BUDGET
    assert run.message == "10 steps did not suffice"
    assert len(run.edges) == 11
    assert run.edges[-1] < end


def test_a_state_that_is_no_number_ends_a_run() -> None:
    run = integrate_by_rosenbrock(
        lambda t, y: np.array([math.nan if t > 1.0 else 1.0]),
        lambda t, y: np.zeros((1, 1)),
        (0.0, 5.0),
        np.zeros(1),
        settings(1e-4),
    )
    assert run.status is SolverStatus.FAILED
    assert run.edges[-1] == pytest.approx(1.0, abs=1e-3)  # as far as it could be known
    assert run.final[0] == pytest.approx(run.edges[-1], rel=1e-12)


def test_an_event_ends_a_run_where_it_happens() -> None:
    run = integrate_by_rosenbrock(
        lambda t, y: np.ones(1), lambda t, y: np.zeros((1, 1)), (0.0, 5.0), np.zeros(1), settings(1e-4),
        lambda y: float(y[0] - math.pi),
    )  # fmt: skip
    assert run.status is SolverStatus.EVENT
    assert run.edges[-1] == pytest.approx(math.pi, rel=1e-12)
    assert run.final[0] == pytest.approx(math.pi, rel=1e-12)


def test_it_answers_the_call_of_the_others() -> None:
    rates, jacobian, end, start, scale, _ = PROBLEMS["HIRES"]
    chosen = settings(1e-6, scale)
    by_name = integrate(rates, jacobian, (0.0, end), np.array(start), chosen)
    direct = integrate_by_rosenbrock(rates, jacobian, (0.0, end), np.array(start), chosen)
    np.testing.assert_array_equal(by_name.values, direct.values)


def test_a_step_over_a_kink_is_done_again_to_end_there() -> None:
    # x' = 1 up to x = 0.3, and 2 beyond: a step over the kink has an error that its stages may all miss.
    kink, times = 0.3, []
    work = method.Workspace(1, 100)
    work.edges[0] = 0.0
    method.begin(work.s, work.k, 0.0, 1.0, 100, work.state, np.ones(1), 1e-4, np.ones(1))

    def rates(t, y):
        return np.where(y < kink, 1.0, 2.0)

    work.s[method.STEP] = 0.25
    while True:
        method._stages(rates, np.zeros((1, 1)), rates(0.0, work.state), np.zeros(1), work)
        after = conclude_on_x(work, np.array([kink]), watch=0, rtol=1e9)
        if after != method.RETRY:
            times.append(float(work.s[method.TIME]))
        if after not in (method.NEXT, method.RETRY):
            break
    assert min(abs(time - kink) for time in times) < 1e-3 * 0.25
    assert work.state[0] == pytest.approx(kink + 2 * (1 - kink), rel=1e-3)
