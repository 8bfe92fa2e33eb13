"""A response of the valve, compiled: the loop over the steps of `divideropt.ode.rosenbrock`."""

import numpy as np

from divideropt.models.divider.elimination_kernels import factorise_shifted, solve_shifted
from divideropt.models.divider.kernels import motion
from divideropt.models.divider.states import N_STATES, STATES
from divideropt.ode.compiled import compiled
from divideropt.ode.rodas5p import GAMMA, STAGES
from divideropt.ode.rosenbrock import (
    NEXT,
    RETRY,
    STEP,
    TIME,
    TIME_DIFFERENCE,
    begin,
    conclude,
    stage_right_side,
    stage_state,
    stage_time,
)

RELAXATION_TIME = 2.0
"""How long a valve is let go [s]: twenty times what it needs to settle."""

RELAXATION_RTOL = 1e-4
RELAXATION_STEPS = 1500
"""Tolerance and budget of steps then; Newton does the rest."""

_VELOCITY, _POSITION = STATES.index("xdot"), STATES.index("x")
_RELAXATION_ATOL = np.full(N_STATES, RELAXATION_RTOL * 1e3)


@compiled
def run(design, first, last, limit, s, k, y, u, U, rtol, atol, bound, edges, values):  # type: ignore[no-untyped-def]
    """Integrate by `divideropt.ode.rosenbrock`: the loop over its steps.

    Args:
        design: `COEFFICIENTS`, shape (1,).
        first: First time [s].
        last: Last time [s].
        limit: Budget of steps.
        s: With the next four, the arrays of a `Workspace`; `y` holds the start.
        k: See `s`.
        y: See `s`.
        u: See `s`.
        U: See `s`.
        rtol: Relative tolerance.
        atol: Absolute tolerance a state, shape (9,).
        bound: Where the spool's position ends the run [m]; infinity if nowhere.
        edges: Receives the times, shape (limit + 1,).
        values: Receives the states at the nodes of each step, shape (limit, 9, NODES_PER_STEP).

    Returns:
        How it ended, as `conclude`.
    """
    d = design[0]
    near, far = d.port_offset - d.port_radius, d.port_offset + d.port_radius  # where a port opens or is fully open
    kinks = np.array([near, far, -near, -far])
    f0, f, slope = np.empty(N_STATES), np.empty(N_STATES), np.zeros(N_STATES)
    jac, lu = np.zeros((N_STATES, N_STATES)), np.zeros((N_STATES, N_STATES))
    edges[0] = first
    motion(first, y, d, f0, jac)
    begin(s, k, first, last, limit, y, f0, rtol, atol)
    while True:
        if d.moving != 0:
            _time_slope(s[TIME], TIME_DIFFERENCE * (last - first), y, d, f, slope)
        after = RETRY
        while after == RETRY:
            factorise_shifted(jac, 1.0 / (GAMMA * s[STEP]), lu)
            for stage in range(STAGES):
                if stage > 0:
                    stage_state(stage, y, U, u)
                    motion(stage_time(stage, s), u, d, f, None)
                stage_right_side(stage, s[STEP], f0 if stage == 0 else f, slope, U)
                solve_shifted(lu, U, stage)
            after = conclude(s, k, y, u, U, rtol, atol, _POSITION, bound, kinks, edges, values)
        if after != NEXT:
            return after
        motion(s[TIME], y, d, f0, jac)


@compiled
def let_go(design, y, s, k, u, U, edges, values):  # type: ignore[no-untyped-def]
    """Let a valve move from a state, at rest, until it has had time to settle.

    Args:
        design: `COEFFICIENTS`, shape (1,), under inputs that stay.
        y: The state, shape (9,); receives the last.
        s: As for `run`, with the others.
        k: As for `run`.
        u: As for `run`.
        U: As for `run`.
        edges: Work, shape (RELAXATION_STEPS + 1,).
        values: Work, shape (RELAXATION_STEPS, 9, NODES_PER_STEP).
    """
    y[_VELOCITY] = 0.0
    run(
        design, 0.0, RELAXATION_TIME, RELAXATION_STEPS, s, k, y, u, U,
        RELAXATION_RTOL, _RELAXATION_ATOL, np.inf, edges, values,
    )  # fmt: skip


@compiled
def _time_slope(t, step, y, d, f, slope):  # type: ignore[no-untyped-def]
    """Fill ∂f/∂t by a central difference; `f` is work."""
    motion(t + step, y, d, slope, None)
    motion(t - step, y, d, f, None)
    for i in range(N_STATES):
        slope[i] = (slope[i] - f[i]) / (2.0 * step)
