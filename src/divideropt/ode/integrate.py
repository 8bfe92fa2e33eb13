"""One call for every method."""

from collections.abc import Callable, Mapping
from types import MappingProxyType

from divideropt.ode.base import Event, FloatArray, Rates, SolverSettings, Trajectory
from divideropt.ode.scipy_solvers import SCIPY_METHODS, integrate_by_scipy

ROSENBROCK = "rosenbrock"

Method = Callable[[Rates, Rates, tuple[float, float], FloatArray, SolverSettings, Event | None], Trajectory]


def _by_rosenbrock(
    rates: Rates,
    jacobian: Rates,
    span: tuple[float, float],
    start: FloatArray,
    settings: SolverSettings,
    event: Event | None = None,
) -> Trajectory:
    from divideropt.ode.rosenbrock import integrate_by_rosenbrock  # noqa: PLC0415 (late: it needs the compiler)

    return integrate_by_rosenbrock(rates, jacobian, span, start, settings, event)


METHODS: Mapping[str, Method] = MappingProxyType(
    {ROSENBROCK: _by_rosenbrock, **dict.fromkeys(SCIPY_METHODS, integrate_by_scipy)}
)
"""What integrates, by the name a campaign gives."""


def integrate(
    rates: Rates,
    jacobian: Rates,
    span: tuple[float, float],
    start: FloatArray,
    settings: SolverSettings,
    event: Event | None = None,
) -> Trajectory:
    """Integrate from one event to the next.

    Args:
        rates: dy/dt as a function of (t, y), shape (n,).
        jacobian: Its derivatives by y, shape (n, n).
        span: First and last time.
        start: State at the first time, shape (n,).
        settings: Method, tolerances, budget.
        event: A function of the state; the trajectory ends within the first step at whose end it is positive, where
            it has become so.

    Returns:
        The trajectory, up to the event or to where the solver gave up. It holds at least one step: if the very first
        failed, the start's state over the whole span.
    """
    return METHODS[settings.method](rates, jacobian, span, start, settings, event)
