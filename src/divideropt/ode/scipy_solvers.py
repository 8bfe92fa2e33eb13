"""SciPy's stiff solvers behind the call of `divideropt.ode.base`."""

import warnings
from typing import TYPE_CHECKING, Any

import numpy as np

from divideropt.ode.base import (
    NODES,
    Event,
    FloatArray,
    Rates,
    SolverSettings,
    SolverStatus,
    Trajectory,
    crossing,
)

if TYPE_CHECKING:
    from scipy.integrate import OdeSolver

SCIPY_METHODS = ("LSODA", "BDF", "Radau")
"""The methods of `scipy.integrate.solve_ivp` for stiff systems, by its names."""


def integrate_by_scipy(
    rates: Rates,
    jacobian: Rates,
    span: tuple[float, float],
    start: FloatArray,
    settings: SolverSettings,
    event: Event | None = None,
) -> Trajectory:
    """Integrate by one of SciPy's methods; see `divideropt.ode.integrate`."""
    from scipy import integrate  # noqa: PLC0415 (late: most commands never need it)

    solver: Any = getattr(integrate, settings.method)(
        rates,
        span[0],
        start,
        span[1],
        rtol=settings.rtol,
        atol=np.array(settings.atol),
        jac=jacobian,
    )
    with warnings.catch_warnings(action="ignore"):  # LSODA warns of what its status says
        return _advance(solver, span, start, settings.max_steps, event)


def _advance(
    solver: "OdeSolver", span: tuple[float, float], start: FloatArray, max_steps: int, event: Event | None
) -> Trajectory:
    """Step to the end, the event, or the end of the budget."""
    edges, values = [span[0]], []
    status, message = SolverStatus.STEP_BUDGET, f"{max_steps} steps did not suffice"
    for _ in range(max_steps):
        failure = _step(solver)
        if failure is not None:
            status, message = SolverStatus.FAILED, failure
            break
        left, width = edges[-1], solver.t - edges[-1]
        dense = solver.dense_output()
        values.append(dense(left + width * NODES))
        edges.append(solver.t)
        if event is not None and event(solver.y) > 0.0:
            width *= crossing(event, values[-1])
            values[-1], edges[-1] = dense(left + width * NODES), left + width
            status, message = SolverStatus.EVENT, ""
            break
        if solver.status == "finished":
            status, message = SolverStatus.FINISHED, ""
            break
    if not values:
        edges.append(span[1])
        values.append(np.repeat(start[:, None], len(NODES), axis=1))
    return Trajectory(np.array(edges), np.array(values), status, message)


def _step(solver: "OdeSolver") -> str | None:
    """Take a step; return why there was none, in words, or None."""
    try:
        failure = solver.step()
    except ValueError as error:  # SciPy refuses to factorise a Jacobian that is not finite
        return str(error)
    if solver.status == "failed":
        return failure or "no step was small enough"
    if not np.isfinite(solver.y).all():  # LSODA would go on
        return "the state is no longer a number"
    return None
