"""Equilibria of the valve: states at which every rate vanishes, and how stable they are.

A damped Newton method on the analytic Jacobian does the work. Where it fails, the valve is let go until it is nearly
at rest, a pseudo-transient with the true masses and volumes; where that fails, SciPy's hybrid method is asked; and
where that fails too, the equilibrium is bracketed: with the spool held at a position the pressures are the solution
of a network of monotone resistances, and what remains is the root of one force over the stroke.
`benchmarks/equilibria.py` counts how often each is needed.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.models.divider.formulations import Stop
from divideropt.models.divider.kernels import jacobian, rates
from divideropt.models.divider.record import Design
from divideropt.models.divider.rest_kernels import (
    BALANCES,
    FREE,
    STATE_SIZES,
    centred_state,
    hold,
    margin,
    polish,
    residual_scales,
)
from divideropt.models.divider.rest_kernels import reach as farthest
from divideropt.models.divider.run_kernels import RELAXATION_STEPS, let_go
from divideropt.models.divider.states import N_STATES, STATES
from divideropt.ode.rosenbrock import Workspace

BRACKETS = 64
"""Intervals of the stroke searched for a sign change of the force where Newton fails."""

_XDOT, _X = STATES.index("xdot"), STATES.index("x")


@dataclass(frozen=True)
class Equilibrium:
    """A state of rest.

    Attributes:
        state: Shape (9,).
        residual: Largest scaled residual.
        method: What led to it: `newton`, `transient`, `hybrid`, `bracket`, or `rigid stop`.
    """

    state: FloatArray
    residual: float
    method: str


def find_equilibrium(design: Design, start: FloatArray) -> Equilibrium | None:
    """Find the equilibrium near a state.

    Args:
        design: `COEFFICIENTS`, shape (1,).
        start: Where to begin, shape (9,), such as the end of a response.

    Returns:
        The equilibrium within the stroke or on the stop, or None if there is none.
    """
    if _field(design, "stop") == Stop.FROZEN and rests_on_stop(design, start):
        return rest_on_rigid_stop(design, start)
    for method, search in _SEARCHES.items():
        found = search(design, start)
        if found is not None:
            return replace(found, method=method)
    return None


def rest_on_rigid_stop(design: Design, start: FloatArray) -> Equilibrium | None:
    """Find a rest pressed on a stop that freezes the spool: the pressures balance, the force points outwards.

    Args:
        design: `COEFFICIENTS`, shape (1,).
        start: Which end of the stroke to try first, shape (9,).

    Returns:
        The rest, or None if there is none or the stop is not rigid.
    """
    stop = float(design[0].stop_position)
    if design[0].stop != Stop.FROZEN:
        return None
    for x in sorted((-stop, stop), key=lambda place: abs(place - start[_X])):
        held = _held(design, initial_guess(design), x)
        if held is not None and rates(0.0, held.state, design)[_XDOT] * x >= 0:
            return replace(held, method="rigid stop")
    return None


def force_profile(
    design: Design, count: int, between: tuple[float, float] | None = None
) -> tuple[FloatArray, FloatArray]:
    """Hold the spool at places over the stroke, and return them [m] and the force on it [N].

    Args:
        design: `COEFFICIENTS`, shape (1,).
        count: Number of places.
        between: First and last place [m]; as far as an equilibrium is sought, if not given.

    Returns:
        Both of shape (count,); the force is NaN where the pressures cannot be solved for.
    """
    places, _, accelerations = _profile(design, count, between)
    return places, accelerations * design[0].mass


def rests_on_stop(design: Design, state: FloatArray) -> bool:
    """Whether the spool is on its stop, or beyond it; never where the formulation has none."""
    return _field(design, "stop") != Stop.NONE and bool(abs(state[_X]) >= _field(design, "stop_position"))


def initial_guess(design: Design) -> FloatArray:
    """Guess a state with the spool centred and the source flow halved, shape (9,)."""
    return np.asarray(centred_state(design))


def stability_margin(design: Design, state: FloatArray) -> float:
    """Return minus the largest real part of the Jacobian's eigenvalues [1/s], without Coulomb friction."""
    return float(margin(design, state))


def without_friction(design: Design, extra_force: float = 0.0) -> Design:
    """Return the design with Coulomb friction taken off and a constant force [N] put on the spool."""
    free = design.copy()
    free[0].coulomb_friction = 0.0
    free[0].extra_force = extra_force
    return free


def _polished(design: Design, start: FloatArray) -> Equilibrium | None:
    """Go to the root by Newton, if it is within reach."""
    y = start.copy()
    size = float(polish(design, y))
    return None if np.isnan(size) else Equilibrium(y, size, "newton")


def _hybrid(design: Design, start: FloatArray) -> Equilibrium | None:
    """Let SciPy's modification of Powell's hybrid method come near the root, then go to it by Newton."""
    y = start.copy()
    y[_XDOT] = 0.0
    scale = residual_scales(design, y)[BALANCES]

    def residual(unknowns: FloatArray) -> FloatArray:
        y[FREE] = unknowns * STATE_SIZES[FREE]
        return np.asarray(rates(0.0, y, design)[BALANCES] / scale)

    def slopes(unknowns: FloatArray) -> FloatArray:
        y[FREE] = unknowns * STATE_SIZES[FREE]
        return np.asarray(jacobian(0.0, y, design)[np.ix_(BALANCES, FREE)] / scale[:, None] * STATE_SIZES[FREE])

    from scipy.optimize import root  # noqa: PLC0415 (late: few designs need it)

    solution = root(residual, y[FREE] / STATE_SIZES[FREE], jac=slopes, method="hybr")
    if not np.isfinite(solution.x).all():
        return None
    y[FREE] = solution.x * STATE_SIZES[FREE]
    return _polished(design, y)


def _let_go(design: Design, start: FloatArray) -> Equilibrium | None:
    """Let the valve move until it is nearly at rest, then go to the root by Newton."""
    y, work = start.copy(), Workspace(N_STATES, RELAXATION_STEPS)
    let_go(design, y, work.s, work.k, work.u, work.U, work.edges, work.values)
    return _polished(design, y)


def _bracketed(design: Design, start: FloatArray) -> Equilibrium | None:
    """Search the stroke for a sign change of the force, nearest to the start first."""
    places, held, forces = _profile(design, BRACKETS + 1, None)
    crossing = np.flatnonzero(np.sign(forces[:-1]) * np.sign(forces[1:]) <= 0)
    for i in sorted(crossing, key=lambda k: abs(places[k] - start[_X])):
        guess = held[i]
        if guess is None:
            continue
        state = _root_between(design, guess, places[i], places[i + 1])
        found = None if state is None else _polished(design, state)
        if found is not None:
            return found
    return None


def _profile(
    design: Design, count: int, between: tuple[float, float] | None
) -> tuple[FloatArray, list[FloatArray | None], FloatArray]:
    """Places over the stroke, the states with the spool held there, and the force on it per mass."""
    reach = float(farthest(design))
    places = np.linspace(*(between or (-reach, reach)), count)
    held = _held_states(design, places)
    return places, held, np.array([np.nan if y is None else rates(0.0, y, design)[_XDOT] for y in held])


def _root_between(design: Design, guess: FloatArray, left: float, right: float) -> FloatArray | None:
    """Find where the force on the held spool vanishes; None where the pressures cannot be solved on the way."""
    from scipy.optimize import brentq  # noqa: PLC0415

    try:
        x = brentq(lambda x: _force_at(design, guess, x), left, right, xtol=1e-12)
    except ValueError:  # NaN, or a sign that is not there when asked again
        return None
    return _hold(design, guess, float(x))


def _held_states(design: Design, places: FloatArray) -> list[FloatArray | None]:
    """Solve the pressures with the spool held at each place, each from its neighbour's."""
    states: list[FloatArray | None] = []
    guess = initial_guess(design)
    for x in places:
        state = _hold(design, guess, float(x))
        if state is None:
            state = _hold(design, initial_guess(design), float(x))
        guess = guess if state is None else state
        states.append(state)
    return states


def _hold(design: Design, guess: FloatArray, x: float) -> FloatArray | None:
    """Solve for the pressures with the spool held at `x`; return the state."""
    held = _held(design, guess, x)
    return None if held is None else held.state


def _held(design: Design, guess: FloatArray, x: float) -> Equilibrium | None:
    y = guess.copy()
    y[_X] = x
    size = float(hold(design, y))
    return None if np.isnan(size) else Equilibrium(y, size, "newton")


def _force_at(design: Design, guess: FloatArray, x: float) -> float:
    state = _hold(design, guess, x)
    return float("nan") if state is None else float(rates(0.0, state, design)[_XDOT])


def _field(design: Design, name: str) -> float:
    """One number of a record; by an attribute it would take ten times as long."""
    return float(design[name][0])


_SEARCHES: Mapping[str, Callable[[Design, FloatArray], Equilibrium | None]] = {
    "newton": _polished,
    "transient": _let_go,
    "hybrid": _hybrid,
    "bracket": _bracketed,
}
"""How an equilibrium is sought, in this order."""
