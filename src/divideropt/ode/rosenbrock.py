"""Rodas5P, a Rosenbrock method of order 5 for stiff systems, compiled, by reverse communication.

The method is that of Steinebach, "Construction of Rosenbrock-Wanner method Rodas5P and numerical benchmarks within
the Julia Differential Equations package", BIT Numerical Mathematics 63:27 (2023), in the form of Hairer and Wanner,
Solving Ordinary Differential Equations II, section IV.7: one factorisation of I/(γh) - J a step, eight stages, an
error estimate of order 4 in the last of them, and an interpolation of order 4.

numba finds no cached version of a function that takes another compiled function as an argument. So the method never
calls the right-hand side: `advance` does what it can and says what it wants next, and a loop of a few lines, which
stands in the file of the right-hand side, supplies it.
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

STAGES = 8

GAMMA = 0.21193756319429014

_A = np.zeros((STAGES, STAGES))
_A[1, :1] = 3.0
_A[2, :2] = 2.849394379747939, 0.45842242204463923
_A[3, :3] = -6.954028509809101, 2.489845061869568, -10.358996098473584
_A[4, :4] = 2.8029986275628964, 0.5072464736228206, -0.3988312541770524, -0.04721187230404641
_A[5:, :5] = -7.502846399306121, 2.561846144803919, -11.627539656261098, -0.18268767659942256, 0.030198172008377946
_A[6:, 5], _A[7, 6] = 1.0, 1.0

_C = np.zeros((STAGES, STAGES))
_C[1, :1] = -14.155112264123755
_C[2, :2] = -17.97296035885952, -2.859693295451294
_C[3, :3] = 147.12150275711716, -1.41221402718213, 71.68940251302358
_C[4, :4] = 165.43517024871676, -0.4592823456491126, 42.90938336958603, -5.961986721573306
_C[5, :5] = 24.854864614690072, -3.0009227002832186, 47.4931110020768, 5.5814197821558125, -0.6610691825249471
_C[6, :6] = (
    30.91273214028599, -3.1208243349937974, 77.79954646070892,
    34.28646028294783, -19.097331116725623, -28.087943162872662,
)  # fmt: skip
_C[7, :7] = (
    37.80277123390563, -3.2571969029072276, 112.26918849496327, 66.9347231244047,
    -40.06618937091002, -54.66780262877968, -9.48861652309627,
)  # fmt: skip

_PLACES = np.array(
    [0.0, 0.6358126895828704, 0.4095798393397535, 0.9769306725060716, 0.4288403609558664, 1.0, 1.0, 1.0]
)
"""c: where in the step a stage is evaluated."""

_SLOPES = np.array(
    [GAMMA, -0.42387512638858027, -0.3384627126235924, 1.8046452872882734, 2.325825639765069, 0.0, 0.0, 0.0]
)
"""d: weight of ∂f/∂t in each stage."""

_H = np.array(
    [
        [25.948786856663858, -2.5579724845846235, 10.433815404888879, -2.3679251022684204,
         0.524948541321073, 1.1241088310450404, 0.4272876194431874, -0.17202221070155493],
        [-9.91568850695171, -0.9689944594115154, 3.0438037242978453, -24.495224566215796,
         20.176138334709044, 15.98066361424651, -6.789040303419874, -6.710236069923372],
        [11.419903575922262, 2.8879645146136994, 72.92137995996029, 80.12511834622643,
         -52.072871366152654, -59.78993625266729, -0.15582684282751913, 4.883087185713722],
    ]
)  # fmt: skip
"""Of the interpolation y(θ) = (1-θ) y0 + θ (y1 + (1-θ) (K0 + θ (K1 + θ K2))), K = H U."""

SAFETY = 0.9
LEAST_CHANGE, MOST_CHANGE = 0.2, 6.0
"""A step's size changes by no less and no more than this."""

ORDER = 5

SMALLEST_STEP = 1e-15
"""A step below this part of the span is lost in rounding."""

FIRST_STEP = 1e-2
"""The first step, in shares of the time in which the state would change by its own size."""

TIME_DIFFERENCE = 1e-6
"""Of a difference in time, in shares of the span."""

RATES, SLOPES, FINISHED, BUDGET, FAILED, WATCHED = range(6)
"""What `advance` wants next, or how the integration has ended."""

TIME, STEP, END, STAGE_TIME, SPAN = range(5)
"""Places in the floats of a run."""

STAGE, TAKEN, LIMIT, LAST_REJECTED = range(4)
"""Places in its integers."""


@compiled
def begin(s, k, first, last, limit, y, f, rtol, atol):  # type: ignore[no-untyped-def]
    """Set up a run whose rates at the start are known.

    Args:
        s: Receives times and step, shape (5,).
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
    k[STAGE], k[TAKEN], k[LIMIT], k[LAST_REJECTED] = 0, 0, limit, 0


@compiled
def advance(s, k, y, f0, f, jac, slope, lu, pivots, U, u, rtol, atol, watch, bound, edges, values):  # type: ignore[no-untyped-def]
    """Go on as far as possible without the right-hand side.

    Args:
        s: Times and step, shape (5,).
        k: Counters, shape (4,).
        y: State at the beginning of the step, shape (n,); moves on with each accepted step.
        f0: Rates there.
        f: Rates at the stage last asked for.
        jac: ∂f/∂y at the beginning of the step, shape (n, n).
        slope: ∂f/∂t there, shape (n,).
        lu: Work, shape (n, n).
        pivots: Work, shape (n,), integers.
        U: Work, shape (STAGES, n).
        u: Receives the state at which a stage's rates are wanted, shape (n,).
        rtol: Relative tolerance.
        atol: Absolute tolerance a state, shape (n,).
        watch: A state whose magnitude ends the run beyond `bound`, or -1.
        bound: That bound.
        edges: Receives the times of the steps, shape (limit + 1,); the first is the caller's.
        values: Receives the states at the nodes of each step, shape (limit, n, NODES_PER_STEP).

    Returns:
        RATES: put f(s[STAGE_TIME], u) into `f`. SLOPES: put rates and Jacobian at (s[TIME], y) into `f0` and `jac`.
        Else how it has ended.
    """
    n = y.size
    while True:
        stage, h = k[STAGE], s[STEP]
        if stage == 0:
            for i in range(n):
                for j in range(n):
                    lu[i, j] = -jac[i, j]
                lu[i, i] += 1.0 / (GAMMA * h)
            factorise(lu, pivots)
        for i in range(n):
            right = (f0[i] if stage == 0 else f[i]) + h * _SLOPES[stage] * slope[i]
            for j in range(stage):
                right += _C[stage, j] / h * U[j, i]
            U[stage, i] = right
        solve(lu, pivots, U[stage])
        if stage < STAGES - 1:
            stage += 1
            for i in range(n):
                place = y[i]
                for j in range(stage):
                    place += _A[stage, j] * U[j, i]
                u[i] = place
            k[STAGE] = stage
            s[STAGE_TIME] = s[TIME] + _PLACES[stage] * h
            return RATES

        error = 0.0
        for i in range(n):
            new = u[i] + U[STAGES - 1, i]
            scale = atol[i] + rtol * max(abs(y[i]), abs(new))
            error += (U[STAGES - 1, i] / scale) ** 2
        error = math.sqrt(error / n)
        k[STAGE] = 0
        if not error <= 1.0:  # NaN is not
            change = LEAST_CHANGE if not error < math.inf else max(SAFETY * error ** (-1.0 / ORDER), LEAST_CHANGE)
            s[STEP] = h * change
            k[LAST_REJECTED] = 1
            if s[STEP] < SMALLEST_STEP * s[SPAN]:
                return FAILED
            continue

        done = s[TIME] + h >= s[END]
        _keep(y, u, U, values[k[TAKEN]])
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
        if k[TAKEN] >= k[LIMIT]:
            return BUDGET
        return SLOPES


@compiled
def _keep(y, u, U, nodes):  # type: ignore[no-untyped-def]
    """Fill the states at the nodes of an accepted step, and move the state to its end."""
    for i in range(y.size):
        first, last = y[i], u[i] + U[STAGES - 1, i]
        k0, k1, k2 = 0.0, 0.0, 0.0
        for j in range(STAGES):
            k0 += _H[0, j] * U[j, i]
            k1 += _H[1, j] * U[j, i]
            k2 += _H[2, j] * U[j, i]
        for m in range(NODES.size):
            theta = NODES[m]
            rest = 1.0 - theta
            nodes[i, m] = rest * first + theta * (last + rest * (k0 + theta * (k1 + theta * k2)))
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
    y, f0, f, jac, slope = work.state, work.f0, work.f, work.jac, work.slope
    y[:] = start
    f0[:], jac[:] = rates(span[0], y), jacobian(span[0], y)
    slope[:] = time_slope(rates, span[0], y, span)
    atol = np.array(settings.atol)
    work.edges[0] = span[0]
    begin(work.s, work.k, *span, settings.max_steps, y, f0, settings.rtol, atol)
    while True:
        wanted = advance(
            work.s, work.k, y, f0, f, jac, slope, work.lu, work.pivots, work.U, work.u,
            settings.rtol, atol, -1, 0.0, work.edges, work.values,
        )  # fmt: skip
        if wanted == RATES:
            f[:] = rates(work.s[STAGE_TIME], work.u)
            continue
        if event is not None and wanted in (SLOPES, FINISHED) and event(y) > 0.0:
            wanted = WATCHED
        if wanted != SLOPES:
            return work.trajectory(wanted, start, event)
        f0[:], jac[:] = rates(work.s[TIME], y), jacobian(work.s[TIME], y)
        slope[:] = time_slope(rates, work.s[TIME], y, span)


def time_slope(rates: Rates, t: float, y: FloatArray, span: tuple[float, float]) -> FloatArray:
    """Return ∂f/∂t by a central difference, shape (n,)."""
    step = TIME_DIFFERENCE * (span[1] - span[0])
    return np.asarray((rates(t + step, y) - rates(t - step, y)) / (2 * step))


class Workspace:
    """The arrays of one run."""

    def __init__(self, n: int, limit: int) -> None:
        """Allocate for n states and a budget of steps; memory that is not reached is not touched."""
        self.s, self.k = np.zeros(5), np.zeros(4, dtype=np.int64)
        self.state, self.f0, self.f, self.slope, self.u = (np.zeros(n) for _ in range(5))
        self.jac, self.lu = np.zeros((n, n)), np.zeros((n, n))
        self.pivots, self.U = np.zeros(n, dtype=np.int64), np.zeros((STAGES, n))
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
