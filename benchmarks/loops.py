"""Compiled loops that do one thing many times, so that no call from Python is in what is timed."""

import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.models.divider.elimination_kernels import factorise_shifted, solve_shifted
from divideropt.models.divider.kernels import motion
from divideropt.models.divider.record import Design
from divideropt.models.divider.run_kernels import run
from divideropt.models.divider.states import N_STATES
from divideropt.ode import SolverSettings
from divideropt.ode.base import Trajectory
from divideropt.ode.compiled import compiled
from divideropt.ode.rosenbrock import Workspace

UNNOTICED = 1e-30
"""What a result weighs in the next call's input: nothing, but the compiler cannot leave a call out."""

CALLS = 20_000

_SHIFT = 1e5
"""1/(γh) [1/s] of a step of 50 µs."""


def timed(call: Callable[[], Any], repeats: int = 1) -> float:
    """Least time of a call [s]."""
    best = np.inf
    for _ in range(repeats):
        begin = time.perf_counter()
        call()
        best = min(best, time.perf_counter() - begin)
    return float(best)


class Integration:
    """The model's own integration of one design, from its start over its last phase."""

    def __init__(
        self,
        design: Design,
        span: tuple[float, float],
        start: FloatArray,
        settings: SolverSettings,
        work: Workspace,
        loop: Callable[..., Any] | None = None,
    ) -> None:
        """Prepare it in a workspace that designs share, as in a batch; `loop` is `integrate_often` or the like."""
        self._work, self._start, self._loop = work, start, loop or integrate_often
        w = self._work
        self._arguments = (
            design, *span, settings.max_steps, w.s, w.k, w.state, w.u, w.U, settings.rtol, np.array(settings.atol),
            math.inf, w.edges, w.values,
        )  # fmt: skip

    def trajectory(self) -> Trajectory:
        """Integrate once."""
        return self._work.trajectory(self._loop(1, self._start, self._arguments), self._start)

    def cost(self, times: int) -> float:
        """Time one integration [s], the mean of so many after a first one: a batch has everything at hand, too."""
        self._loop(1, self._start, self._arguments)
        return timed(lambda: self._loop(times, self._start, self._arguments)) / times


def kernel_costs(design: Design, y: FloatArray) -> dict[str, float]:
    """Time the pieces of a step, each [s]."""
    out, b = np.empty(N_STATES), np.zeros((1, N_STATES))
    jac, lu = np.zeros((N_STATES, N_STATES)), np.zeros((N_STATES, N_STATES))
    pieces: dict[str, Callable[[], Any]] = {
        "rates": lambda: _rates_often(CALLS, y.copy(), design, out),
        "rates and Jacobian": lambda: _jacobian_often(CALLS, y.copy(), design, out, jac),
        "factorisation": lambda: _factorise_often(CALLS, jac, _SHIFT, lu),
        "solution": lambda: _solve_often(CALLS, lu, out, b),
    }
    for piece in pieces.values():  # each fills what the next one reads
        piece()
    return {name: timed(piece, 9) / CALLS for name, piece in pieces.items()}


@compiled
def integrate_often(times, start, arguments):  # type: ignore[no-untyped-def]
    design, first, last, limit, s, k, y, u, increments, rtol, atol, bound, edges, values = arguments
    ending = 0
    for _ in range(times):
        for i in range(y.size):
            y[i] = start[i]
        ending = run(design, first, last, limit, s, k, y, u, increments, rtol, atol, bound, edges, values)
    return ending


@compiled
def _rates_often(times, y, design, out):  # type: ignore[no-untyped-def]
    for _ in range(times):
        motion(0.0, y, design[0], out, None)
        for i in range(y.size):
            y[i] += UNNOTICED * out[i]


@compiled
def _jacobian_often(times, y, design, out, jac):  # type: ignore[no-untyped-def]
    for _ in range(times):
        motion(0.0, y, design[0], out, jac)
        for i in range(y.size):
            y[i] += UNNOTICED * out[i]


@compiled
def _factorise_often(times, jac, shift, lu):  # type: ignore[no-untyped-def]
    for _ in range(times):
        factorise_shifted(jac, shift, lu)
        shift += UNNOTICED * lu[0, 0]


@compiled
def _solve_often(times, lu, given, b):  # type: ignore[no-untyped-def]
    for _ in range(times):
        for i in range(given.size):
            b[0, i] = given[i] + UNNOTICED * b[0, i]
        solve_shifted(lu, b, 0)
