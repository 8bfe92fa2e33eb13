"""Rests of the valve, compiled: Newton's method on the equations of motion, and how stable a rest is."""

import math

import numpy as np

from divideropt.models.divider.elimination_kernels import factorise_shifted, solve_shifted
from divideropt.models.divider.kernels import STOP_STIFFNESS, motion
from divideropt.models.divider.states import N_STATES, STATES
from divideropt.ode.compiled import compiled
from divideropt.ode.spectrum import largest_real_part

TOLERANCE = 1e-13
"""Residual at which Newton stops: flows over the source flow, forces over `FORCE_SCALE` times the end area."""

LOOSEST = 1e3
"""Where no step improves it any more, a residual of so many times that will do."""

ITERATIONS = 60
"""Budget of Newton iterations; from the end of a response two or three suffice."""

HALVINGS = 12
"""How often a Newton step is halved before it is taken as lost."""

FORCE_SCALE = 1e6
"""Pressure [Pa] that scales a force residual."""

HIGHEST_PRESSURE = 5e7
"""No end chamber presses the spool into its stop with more than this [Pa]."""

_VELOCITY, _POSITION = STATES.index("xdot"), STATES.index("x")
FREE = np.array([i for i in range(N_STATES) if i != _VELOCITY])
BALANCES = np.array([i for i in range(N_STATES) if i != _POSITION])
"""The states that a rest is solved for, and the rates that must vanish: the position's does as the spool stands."""

STATE_SIZES = np.array([1e7, 1e7, 1e7, 1e7, 1e7, 1e-2, 1e-3, 1e7, 1e7])
"""What the states are counted in where a matrix's rows and columns should be alike in size [Pa, m/s, m]."""


@compiled
def polish(design, y):  # type: ignore[no-untyped-def]
    """Go to the rest near a state by Newton's method.

    Args:
        design: `COEFFICIENTS`, shape (1,).
        y: The state, shape (9,); receives the rest.

    Returns:
        The largest scaled residual, or NaN where no rest within the stroke is within reach.
    """
    size = _newton(design[0], y, True)
    return size if abs(y[_POSITION]) <= reach(design) else math.nan


@compiled
def hold(design, y):  # type: ignore[no-untyped-def]
    """Solve for the pressures with the spool held where it is; arguments and return as `polish`."""
    return _newton(design[0], y, False)


@compiled
def reach(design):  # type: ignore[no-untyped-def]
    """Return how far a rest is sought [m]: the stop and what its spring gives, or where the ports end."""
    return _reach(design[0])


@compiled
def residual_scales(design, y):  # type: ignore[no-untyped-def]
    """Return what divides each rate, shape (9,): that of a pressure as if the source flow filled its volume."""
    return _residual_scales(design[0], y)


@compiled
def margin(design, y):  # type: ignore[no-untyped-def]
    """Return minus the largest real part of the Jacobian's eigenvalues [1/s], without Coulomb friction.

    Args:
        design: `COEFFICIENTS`, shape (1,).
        y: State, shape (9,).
    """
    d = design[0]
    out, jac = np.empty(N_STATES), np.zeros((N_STATES, N_STATES))
    friction = d.coulomb_friction
    d.coulomb_friction = 0.0
    motion(0.0, y, d, out, jac)
    d.coulomb_friction = friction
    for i in range(N_STATES):
        for j in range(N_STATES):
            jac[i, j] *= STATE_SIZES[j] / STATE_SIZES[i]
    return -largest_real_part(jac)


@compiled
def centred_state(design):  # type: ignore[no-untyped-def]
    """Guess a state with the spool centred and the source flow halved, shape (9,)."""
    d = design[0]
    half = d.source_flow / 2.0
    y = np.zeros(N_STATES)
    y[7], y[8] = (half / d.load_1) ** 2, (half / d.load_2) ** 2
    port = (half / (d.variable * 0.5 * math.pi * d.port_radius * d.port_radius * d.arc_holes)) ** 2
    y[1], y[2] = y[7] + port, y[8] + port
    y[0] = max(y[1] + (half / d.fixed_1) ** 2, y[2] + (half / d.fixed_2) ** 2)
    y[3], y[4] = (y[0] + y[1]) / 2.0, (y[0] + y[2]) / 2.0
    return y


@compiled
def _newton(d, y, free):  # type: ignore[no-untyped-def]
    """Let all balances vanish by damped Newton steps; the spool stands still, free to be anywhere or held."""
    y[_VELOCITY] = 0.0
    scale, reach = _residual_scales(d, y), _reach(d)
    out, jac, factors = np.empty(N_STATES), np.zeros((N_STATES, N_STATES)), np.zeros((N_STATES, N_STATES))
    step, trial = np.empty((1, N_STATES)), np.empty(N_STATES)
    motion(0.0, y, d, out, jac)
    size = _largest(out, scale, free)
    for _ in range(ITERATIONS):
        if not size < math.inf:
            return math.nan
        if size <= TOLERANCE:
            return size
        _newton_step(jac, out, free, factors, step)
        improved = False
        share = 1.0
        for _ in range(HALVINGS):
            _step_to(y, step, share, reach, trial)
            motion(0.0, trial, d, out, None)
            new = _largest(out, scale, free)
            if new < size:
                improved = True
                break
            share *= 0.5
        if not improved:
            return size if size <= LOOSEST * TOLERANCE else math.nan
        for i in range(N_STATES):
            y[i] = trial[i]
        size = new
        motion(0.0, y, d, out, jac)
    return math.nan


@compiled
def _newton_step(jac, out, free, factors, step):  # type: ignore[no-untyped-def]
    """Solve J step = -out for the pressures and, if free, the position; `jac` is spoilt.

    The elimination is that of the solver's steps, with nothing added to the diagonal. The velocity's column takes the
    position's place in the balance of forces: its row says that the two are one unknown, or, if the spool is held,
    that both are zero.
    """
    for i in range(N_STATES):
        jac[i, _VELOCITY] = 0.0
        step[0, i] = out[i]
    jac[_POSITION, _VELOCITY], jac[_POSITION, _POSITION] = 1.0, -1.0
    step[0, _POSITION] = 0.0
    if not free:
        for i in range(N_STATES):
            jac[_VELOCITY, i] = 0.0
        jac[_VELOCITY, _VELOCITY] = -1.0
        step[0, _VELOCITY] = 0.0
    factorise_shifted(jac, 0.0, factors)
    solve_shifted(factors, step, 0)


@compiled
def _step_to(y, step, share, reach, trial):  # type: ignore[no-untyped-def]
    """Fill the state a share of a step away; pressures stay positive, the spool within reach."""
    for i in range(N_STATES):
        trial[i] = max(y[i] + share * step[0, i], 0.0)
    trial[_VELOCITY] = 0.0
    trial[_POSITION] = min(max(y[_POSITION] + share * step[0, _POSITION], -reach), reach)


@compiled
def _largest(out, scale, free):  # type: ignore[no-untyped-def]
    """Return the largest scaled residual of the balances, the forces' too if the spool is free; NaN where one is."""
    size = 0.0
    for i in range(N_STATES):
        if i == _POSITION or (i == _VELOCITY and not free):
            continue
        value = abs(out[i]) / scale[i]
        if math.isnan(value):
            return value
        size = max(size, value)
    return size


@compiled
def _reach(d):  # type: ignore[no-untyped-def]
    if d.port_range == 2:  # beyond, the printed equations give no number
        return d.port_radius - abs(d.port_offset)
    if d.stop != 0:
        return d.stop_position
    return d.stop_position + HIGHEST_PRESSURE * d.end_area / STOP_STIFFNESS


@compiled
def _residual_scales(d, y):  # type: ignore[no-untyped-def]
    flow = d.source_flow
    scale = np.ones(N_STATES)
    scale[0] = flow * d.source_gain
    scale[1] = scale[2] = flow * d.chamber_gain
    scale[3] = flow * d.bulk_modulus / (d.end_volume + d.end_area * y[_POSITION])
    scale[4] = flow * d.bulk_modulus / (d.end_volume - d.end_area * y[_POSITION])
    scale[_VELOCITY] = FORCE_SCALE * d.end_area / d.mass
    scale[7] = scale[8] = flow * d.load_gain
    return scale
