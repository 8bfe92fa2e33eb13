"""A Rosenbrock method for stiff systems, compiled, in pieces: stages, and what is concluded from them.

numba finds no cached version of a function that takes another compiled function as an argument. So the method calls
neither a right-hand side nor a linear algebra: whoever has these writes the loop of a step, which is short, from the
pieces here. One such loop stands beside the valve's equations, with an elimination made for them; the one below takes
any Python functions.
"""

import math

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
    lagrange_weights,
)
from divideropt.ode.compiled import compiled
from divideropt.ode.linear import factorise, solve
from divideropt.ode.rodas5p import GAMMA, ORDER, PLACES, SLOPES, STAGES, A, C, H

SAFETY = 0.9
LEAST_CHANGE, MOST_CHANGE = 0.2, 6.0
"""A step's size changes by no less and no more than this."""

SMALLEST_STEP = 1e-15
"""A step below this part of the span is lost in rounding."""

FIRST_STEP = 1e-2
"""The first step, in shares of the time in which the state would change by its own size."""

TIME_DIFFERENCE = 1e-6
"""Of a difference in time, in shares of the span."""

RETRY, NEXT, FINISHED, BUDGET, FAILED, WATCHED = range(6)
"""What follows a step: the same with another size, the next one, or how the integration has ended."""

TIME, STEP, END, SPAN = range(4)
"""Places in the floats of a run."""

TAKEN, LIMIT, LAST_REJECTED, SHORTENED = range(4)
"""Places in its integers."""

AT_AN_END = 1e-3
"""A kink that is no further than this part of a step from one of its ends needs no shorter step."""

HALVINGS = 30
"""Of the step within which a kink is sought."""

_NO_KINKS = np.empty(0)
_AT_NODES = np.array([1.0 - NODES, NODES, *(NODES * (1.0 - NODES) * NODES**i for i in range(len(H)))])
"""What a step's ends and the rows of K weigh at each node."""


@compiled
def begin(s, k, first, last, limit, y, f, rtol, atol):  # type: ignore[no-untyped-def]
    """Set up a run whose rates at the start are known.

    Args:
        s: Receives times and step, shape (4,).
        k: Receives counters, shape (4,), integers.
        first: First time.
        last: Last time.
        limit: Budget of accepted steps.
        y: State at the first time, shape (n,).
        f: Rates there, shape (n,).
        rtol: Relative tolerance.
        atol: Absolute tolerance a state, shape (n,).
    """
    size, speed = 0.0, 0.0
    for i in range(y.size):
        scale = atol[i] + rtol * abs(y[i])
        size += (y[i] / scale) ** 2
        speed += (f[i] / scale) ** 2
    span = last - first
    guess = FIRST_STEP * math.sqrt(size / speed) if speed > 0.0 and size > 0.0 else 1e-6 * span
    s[TIME], s[END], s[SPAN] = first, last, span
    s[STEP] = min(guess, span)
    k[TAKEN], k[LIMIT], k[LAST_REJECTED], k[SHORTENED] = 0, limit, 0, 0


@compiled
def stage_time(stage, s):  # type: ignore[no-untyped-def]
    """Return the time at which a stage's rates are wanted."""
    return s[TIME] + PLACES[stage] * s[STEP]


@compiled
def stage_state(stage, y, U, u):  # type: ignore[no-untyped-def]
    """Fill the state at which a stage's rates are wanted.

    Args:
        stage: From 0; in this order, since the last two states add to the one before.
        y: State at the beginning of the step, shape (n,).
        U: Increments of the stages before, shape (STAGES, n).
        u: Receives the state, shape (n,).
    """
    if stage >= STAGES - 2:
        for i in range(y.size):
            u[i] += U[stage - 1, i]
        return
    for i in range(y.size):
        u[i] = y[i]
    for j in range(stage):
        weight = A[stage, j]
        for i in range(y.size):
            u[i] += weight * U[j, i]


@compiled
def stage_right_side(stage, h, f, slope, U):  # type: ignore[no-untyped-def]
    """Fill the right side of a stage's linear system, whose matrix is I/(γh) - ∂f/∂y, into its row of `U`.

    Args:
        stage: From 0.
        h: The step's size.
        f: Rates at the stage, shape (n,).
        slope: ∂f/∂t at the beginning of the step, shape (n,).
        U: Increments, shape (STAGES, n).
    """
    weight = h * SLOPES[stage]
    for i in range(f.size):
        U[stage, i] = f[i] + weight * slope[i]
    for j in range(stage):
        weight = C[stage, j] / h
        for i in range(f.size):
            U[stage, i] += weight * U[j, i]


@compiled
def conclude(s, k, y, u, U, rtol, atol, watch, bound, kinks, edges, values):  # type: ignore[no-untyped-def]
    """Accept a step whose stages are known, or reject it, and choose the next one's size.

    Args:
        s: Times and step, shape (4,).
        k: Counters, shape (4,).
        y: State at the beginning of the step, shape (n,); moves on if the step is accepted.
        u: State of the last stage, shape (n,).
        U: Increments, shape (STAGES, n).
        rtol: Relative tolerance.
        atol: Absolute tolerance a state, shape (n,).
        watch: A state whose magnitude ends the run beyond `bound`, or -1.
        bound: That bound.
        kinks: Values of that state at which the rates are not smooth, shape (m,); an error estimate is blind to them,
            so a step over one is done again, to end there.
        edges: Receives the times of the steps, shape (limit + 1,); the first is the caller's.
        values: Receives the states at the nodes of each step, shape (limit, n, NODES_PER_STEP).

    Returns:
        What follows: RETRY, NEXT, or how it has ended.
    """
    h = s[STEP]
    error = 0.0
    for i in range(y.size):
        off = U[STAGES - 1, i]
        scale = atol[i] + rtol * max(abs(y[i]), abs(u[i] + off))
        error += (off / scale) ** 2
    error = math.sqrt(error / y.size)
    if not error <= 1.0:  # NaN is not
        change = LEAST_CHANGE if not error < math.inf else max(SAFETY * error ** (-1.0 / ORDER), LEAST_CHANGE)
        s[STEP] = h * change
        k[LAST_REJECTED] = 1
        return FAILED if s[STEP] < SMALLEST_STEP * s[SPAN] else RETRY

    if watch >= 0 and k[SHORTENED] == 0:
        share = _first_kink(y, u, U, watch, kinks)
        if share < 1.0:
            s[STEP] = share * h
            k[SHORTENED] = 1
            return RETRY
    k[SHORTENED] = 0

    done = s[TIME] + h >= s[END]
    _keep(y, u, U, values, k[TAKEN])
    s[TIME] = s[END] if done else s[TIME] + h
    k[TAKEN] += 1
    edges[k[TAKEN]] = s[TIME]
    most = 1.0 if k[LAST_REJECTED] else MOST_CHANGE
    change = most if error == 0.0 else min(max(SAFETY * error ** (-1.0 / ORDER), LEAST_CHANGE), most)
    k[LAST_REJECTED] = 0
    left = s[END] - s[TIME]
    s[STEP] = left if change * h * 1.01 >= left else change * h
    if watch >= 0 and abs(y[watch]) > bound:
        return WATCHED
    if done:
        return FINISHED
    return BUDGET if k[TAKEN] >= k[LIMIT] else NEXT


@compiled
def _first_kink(y, u, U, watch, kinks):  # type: ignore[no-untyped-def]
    """Return the share of a step at which the watched state first comes to a kink; 1 if not before the end."""
    first, last = y[watch], u[watch] + U[STAGES - 1, watch]
    k0, k1, k2 = _terms(U, watch)
    nearest = 1.0
    for kink in kinks:
        if not (first - kink) * (last - kink) < 0.0:
            continue
        low, high = 0.0, 1.0
        for _ in range(HALVINGS):
            share = 0.5 * (low + high)
            value = (1.0 - share) * first + share * (last + (1.0 - share) * (k0 + share * (k1 + share * k2)))
            if (value - kink) * (first - kink) > 0.0:
                low = share
            else:
                high = share
        if AT_AN_END < high < 1.0 - AT_AN_END:
            nearest = min(nearest, high)
    return nearest


@compiled
def _terms(U, i):  # type: ignore[no-untyped-def]
    """Return K of one state."""
    k0, k1, k2 = 0.0, 0.0, 0.0
    for j in range(STAGES):
        k0 += H[0, j] * U[j, i]
        k1 += H[1, j] * U[j, i]
        k2 += H[2, j] * U[j, i]
    return k0, k1, k2


@compiled
def _keep(y, u, U, values, step):  # type: ignore[no-untyped-def]
    """Fill the states at the nodes of an accepted step, and move the state to its end."""
    end = NODES.size - 1
    for i in range(y.size):
        first, last = y[i], u[i] + U[STAGES - 1, i]
        k0, k1, k2 = _terms(U, i)
        for m in range(1, end):
            ends = first * _AT_NODES[0, m] + last * _AT_NODES[1, m]
            values[step, i, m] = ends + (k0 * _AT_NODES[2, m] + k1 * _AT_NODES[3, m] + k2 * _AT_NODES[4, m])
        values[step, i, 0], values[step, i, end] = first, last
        y[i] = last


def integrate_by_rosenbrock(
    rates: Rates,
    jacobian: Rates,
    span: tuple[float, float],
    start: FloatArray,
    settings: SolverSettings,
    event: Event | None = None,
) -> Trajectory:
    """Integrate a system whose right-hand side is any function; see `divideropt.ode.integrate`.

    One that is compiled beside a loop of its own is much faster.
    """
    work = Workspace(len(start), settings.max_steps)
    y, atol = work.state, np.array(settings.atol)
    y[:] = start
    work.edges[0] = span[0]
    f0, matrix, slope = rates(span[0], y), jacobian(span[0], y), _time_slope(rates, span[0], y, span)
    begin(work.s, work.k, *span, settings.max_steps, y, f0, settings.rtol, atol)
    while True:
        _stages(rates, matrix, f0, slope, work)
        after = conclude(
            work.s, work.k, y, work.u, work.U, settings.rtol, atol, -1, 0.0, _NO_KINKS, work.edges, work.values
        )  # fmt: skip
        if event is not None and after in (NEXT, FINISHED) and event(y) > 0.0:
            after = WATCHED
        if after == NEXT:
            t = work.s[TIME]
            f0, matrix, slope = rates(t, y), jacobian(t, y), _time_slope(rates, t, y, span)
        elif after != RETRY:
            return work.trajectory(after, start, event)


def _stages(rates: Rates, matrix: FloatArray, f0: FloatArray, slope: FloatArray, work: "Workspace") -> None:
    """Fill the increments of one step."""
    h = work.s[STEP]
    lu = np.eye(len(f0)) / (GAMMA * h) - matrix
    factorise(lu, work.pivots)
    work.u[:], f = work.state, f0
    for stage in range(STAGES):
        if stage > 0:
            stage_state(stage, work.state, work.U, work.u)
            f = rates(stage_time(stage, work.s), work.u)
        stage_right_side(stage, h, f, slope, work.U)
        solve(lu, work.pivots, work.U[stage])


def _time_slope(rates: Rates, t: float, y: FloatArray, span: tuple[float, float]) -> FloatArray:
    """Return ∂f/∂t by a central difference, shape (n,)."""
    step = TIME_DIFFERENCE * (span[1] - span[0])
    return np.asarray((rates(t + step, y) - rates(t - step, y)) / (2 * step))


class Workspace:
    """The arrays of one run."""

    def __init__(self, n: int, limit: int) -> None:
        """Allocate for n states and a budget of steps; memory that is not reached is not touched."""
        self.s, self.k = np.zeros(4), np.zeros(4, dtype=np.int64)
        self.state, self.u, self.U = np.zeros(n), np.zeros(n), np.zeros((STAGES, n))
        self.pivots = np.zeros(n, dtype=np.int64)
        self.edges, self.values = np.empty(limit + 1), np.empty((limit, n, len(NODES)))

    def trajectory(self, ending: int, start: FloatArray, event: Event | None = None) -> Trajectory:
        """Return what was integrated, and how it ended."""
        steps = int(self.k[TAKEN])
        edges, values = self.edges[: steps + 1].copy(), self.values[:steps].copy()
        status, message = _ENDINGS[ending]
        if steps == 0:
            edges = np.array([self.s[TIME], self.s[END]])
            values = np.repeat(start[:, None], len(NODES), axis=1)[None]
        elif ending == WATCHED and event is not None:
            share = crossing(event, values[-1])
            values[-1] = values[-1] @ lagrange_weights(share * NODES).T
            edges[-1] = edges[-2] + share * (edges[-1] - edges[-2])
        return Trajectory(edges, values, status, message.format(limit=int(self.k[LIMIT])))


_ENDINGS = {
    FINISHED: (SolverStatus.FINISHED, ""),
    BUDGET: (SolverStatus.STEP_BUDGET, "{limit} steps did not suffice"),
    FAILED: (SolverStatus.FAILED, "no step was small enough, or the state is no longer a number"),
    WATCHED: (SolverStatus.EVENT, ""),
}
