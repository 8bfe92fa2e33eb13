"""What is solved for on the equations of motion, compiled: a rest by Newton's method, a response by Rodas5P."""

import math

import numpy as np

from divideropt.models.divider.kernels import N_STATES, STATES, motion
from divideropt.ode.compiled import compiled
from divideropt.ode.linear import factorise, solve
from divideropt.ode.rosenbrock import RATES, SLOPES, STAGE_TIME, TIME, TIME_DIFFERENCE, advance, begin

_VELOCITY, _POSITION = STATES.index("xdot"), STATES.index("x")


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
def newton(design, y, unknowns, balances, scale, reach, tolerance, loosest, iterations, halvings):  # type: ignore[no-untyped-def]
    """Solve some balances for some states by damped Newton steps.

    Args:
        design: `COEFFICIENTS`, shape (1,).
        y: The start, shape (9,); receives the solution. The spool's velocity stays as it is.
        unknowns: Indices of the states to be found, shape (m,).
        balances: Indices of the rates that must vanish, shape (m,).
        scale: What divides those, shape (m,).
        reach: Largest distance of the spool from the centre [m].
        tolerance: Scaled residual at which it stops.
        loosest: Scaled residual that will do where no step improves it.
        iterations: Budget of steps.
        halvings: How often a step is halved before it is taken as lost.

    Returns:
        The largest scaled residual, or NaN where it is not small.
    """
    m = unknowns.size
    d = design[0]
    out, jac, spare = np.empty(N_STATES), np.zeros((N_STATES, N_STATES)), np.zeros((N_STATES, N_STATES))
    a, pivots, step, trial = np.empty((m, m)), np.empty(m, np.int64), np.empty(m), np.empty(N_STATES)
    motion(0.0, y, d, out, jac)
    size = _largest(out, balances, scale)
    for _ in range(iterations):
        if not size < math.inf:
            return math.nan
        if size <= tolerance:
            return size
        for i in range(m):
            for j in range(m):
                a[i, j] = jac[balances[i], unknowns[j]] / scale[i]
            step[i] = -out[balances[i]] / scale[i]
        if not factorise(a, pivots):
            return math.nan
        solve(a, pivots, step)
        improved = False
        share = 1.0
        for _ in range(halvings):
            _step_to(y, step, share, unknowns, reach, trial)
            motion(0.0, trial, d, out, spare)
            new = _largest(out, balances, scale)
            if new < size:
                improved = True
                break
            share *= 0.5
        if not improved:
            return size if size <= loosest else math.nan
        for i in range(N_STATES):
            y[i] = trial[i]
        size = new
        _clear(jac)
        motion(0.0, y, d, out, jac)
    return math.nan


@compiled
def _step_to(y, step, share, unknowns, reach, trial):  # type: ignore[no-untyped-def]
    """Fill the state a share of a step away; pressures stay positive, the spool within reach."""
    for i in range(N_STATES):
        trial[i] = y[i]
    for i in range(unknowns.size):
        trial[unknowns[i]] += share * step[i]
    for i in range(N_STATES):
        if i not in (_VELOCITY, _POSITION):
            trial[i] = max(trial[i], 0.0)
    trial[_POSITION] = min(max(trial[_POSITION], -reach), reach)


@compiled
def _largest(out, balances, scale):  # type: ignore[no-untyped-def]
    """Return the largest scaled residual; NaN where one is."""
    size = 0.0
    for i in range(balances.size):
        value = abs(out[balances[i]]) / scale[i]
        if math.isnan(value):
            return value
        size = max(size, value)
    return size


@compiled
def residual_scales(design, y, pressure):  # type: ignore[no-untyped-def]
    """Return what divides each rate, shape (9,): that of a pressure as if the source flow filled its volume.

    Args:
        design: `COEFFICIENTS`, shape (1,).
        y: State, shape (9,).
        pressure: On the end area it makes the force that divides a force [Pa].
    """
    d = design[0]
    flow = d.source_flow
    scale = np.ones(N_STATES)
    scale[0] = flow * d.source_gain
    scale[1] = scale[2] = flow * d.chamber_gain
    scale[3] = flow * d.bulk_modulus / (d.end_volume + d.end_area * y[_POSITION])
    scale[4] = flow * d.bulk_modulus / (d.end_volume - d.end_area * y[_POSITION])
    scale[_VELOCITY] = pressure * d.end_area / d.mass
    scale[7] = scale[8] = flow * d.load_gain
    return scale


@compiled
def run(design, first, last, limit, s, k, y, f0, f, jac, slope, lu, pivots, U, u, rtol, atol, bound, edges, values):  # type: ignore[no-untyped-def]
    """Integrate by `divideropt.ode.rosenbrock`: the loop that supplies its right-hand side.

    Args:
        design: `COEFFICIENTS`, shape (1,).
        first: First time [s].
        last: Last time [s].
        limit: Budget of steps.
        s: With those that follow up to `u`, the arrays of a `Workspace`; `y` holds the start.
        k: See `s`.
        y: See `s`.
        f0: See `s`.
        f: See `s`.
        jac: See `s`.
        slope: See `s`.
        lu: See `s`.
        pivots: See `s`.
        U: See `s`.
        u: See `s`.
        rtol: Relative tolerance.
        atol: Absolute tolerance a state, shape (9,).
        bound: Where the spool's position ends the run [m]; infinity if nowhere.
        edges: Receives the times, shape (limit + 1,).
        values: Receives the states at the nodes of each step, shape (limit, 9, NODES_PER_STEP).

    Returns:
        How it ended, as `advance`.
    """
    d = design[0]
    spare = np.zeros((N_STATES, N_STATES))
    edges[0] = first
    _clear(jac)
    motion(first, y, d, f0, jac)
    begin(s, k, first, last, limit, y, f0, rtol, atol)
    while True:
        if d.moving != 0:
            _time_slope(s[TIME], TIME_DIFFERENCE * (last - first), y, d, f, slope, spare)
        wanted = RATES
        while wanted == RATES:
            wanted = advance(
                s, k, y, f0, f, jac, slope, lu, pivots, U, u, rtol, atol, _POSITION, bound, edges, values
            )
            if wanted == RATES:
                motion(s[STAGE_TIME], u, d, f, spare)
        if wanted != SLOPES:
            return wanted
        _clear(jac)
        motion(s[TIME], y, d, f0, jac)


@compiled
def _clear(matrix):  # type: ignore[no-untyped-def]
    """Fill a matrix with zeros."""
    for i in range(N_STATES):
        for j in range(N_STATES):
            matrix[i, j] = 0.0


@compiled
def _time_slope(t, step, y, d, f, slope, spare):  # type: ignore[no-untyped-def]
    """Fill ∂f/∂t by a central difference; `f` and `spare` are work."""
    motion(t + step, y, d, slope, spare)
    motion(t - step, y, d, f, spare)
    for i in range(N_STATES):
        slope[i] = (slope[i] - f[i]) / (2.0 * step)
