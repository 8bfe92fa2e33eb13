"""What an evaluation costs: ratios to named peers, measured in one run, at the accuracy each reaches.

Run it with `python benchmarks/speed.py`; it takes a minute. The peers integrate the same compiled equations from the
same start over the same second: `scipy.integrate.odeint` (LSODA, with the Jacobian), `solve_ivp(method="LSODA")`, and
the same in plain Python. Designs: the feasible ones among Sobol points of the box of divider.yaml. Single-threaded.
"""

import math
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
from scipy.integrate import odeint, solve_ivp
from scipy.stats import qmc
from threadpoolctl import threadpool_limits

from divideropt.campaign.load import default_campaign
from divideropt.campaign.plan import build_problem
from divideropt.models.base import FloatArray
from divideropt.models.divider import Divider, groove_kernels, kernels, solver_settings
from divideropt.models.divider.kernels import jacobian, motion, rates
from divideropt.models.divider.record import Design
from divideropt.models.divider.response import Response
from divideropt.models.divider.run_kernels import run
from divideropt.ode.rosenbrock import Workspace
from divideropt.problem import Problem

COUNT = 256
OBJECTIVES = ("steady_state_error", "dynamic_error", "source_pressure")
PYTHON_DESIGNS = 8
"""Designs that plain Python integrates: it takes a third of a second for one."""

REPEATS = 5


def main(count: int) -> None:
    """Print the tables."""
    problem = build_problem(default_campaign())
    assert isinstance(problem.model, Divider)
    with threadpool_limits(1):
        designs = feasible(problem, problem.model, count)
        print(f"{len(designs)} feasible designs of {count}")
        accuracy(problem.model, designs)
        right_hand_side(problem.model, designs[0])
        speed(problem.model, designs)


def feasible(problem: Problem, model: Divider, count: int) -> list[dict[str, float]]:
    """The feasible designs among the first Sobol points of the box, whole."""
    unit = qmc.Sobol(len(problem.space), rng=0).random_base2(math.ceil(math.log2(count)))[:count]
    points = qmc.scale(unit, problem.space.lower, problem.space.upper)
    told = problem.tell(problem.simulate(points))
    names = problem.space.names
    return [dict(problem.fixed) | dict(zip(names, p, strict=True)) for p in points[told.feasible].tolist()]


def accuracy(model: Divider, designs: Sequence[dict[str, float]]) -> None:
    """Compare the objectives with the reference solver's."""
    matrix = np.array([list(p.values()) for p in designs])
    places = [list(model.quantities).index(name) for name in OBJECTIVES]
    exact = model.reference().evaluate(matrix)[0][:, places]
    peer = replace(model, settings=solver_settings("LSODA", RTOL, max_steps=50_000))
    for label, chosen in (("ours", model), (f"LSODA at {RTOL:g}", peer)):
        off = np.abs(chosen.evaluate(matrix)[0][:, places] / exact - 1)
        for name, column in zip(OBJECTIVES, off.T, strict=True):
            middle = np.median(column)
            print(f"{label}, {name}: deviation from Radau at 1e-10, worst {column.max():.1e}, median {middle:.1e}")


def right_hand_side(model: Divider, p: dict[str, float]) -> None:
    """Time the right-hand side by itself."""
    phase = model.respond(p).phases[-1]
    assert phase.end is not None
    out, jac, y, d = np.empty(9), np.zeros((9, 9)), phase.end, phase.design[0]
    cost = timed(partial(motion, 0.0, y, d, out, jac), 20_000)
    print(f"rates and Jacobian in one pass: {1e9 * cost:.0f} ns a call from Python, numba's unboxing included")


def speed(model: Divider, designs: Sequence[dict[str, float]]) -> None:
    """Time integrations and whole evaluations, medians over the designs."""
    cases = [(response, phase_start(response)) for response in map(model.respond, designs)]
    ours = [timed(partial(by_rosenbrock, model, r, y), REPEATS) for r, y in cases]
    whole = [timed(partial(model.evaluate, np.array([list(p.values())])), REPEATS) for p in designs]
    print(f"integration: median {1e6 * np.median(ours):.0f} µs, worst {max(ours) / np.median(ours):.1f} times that")
    print(f"evaluation, with equilibria, margins and metrics: median {1e6 * np.median(whole):.0f} µs, worst "
          f"{max(whole) / np.median(whole):.1f} times that; {1 / np.median(whole):.0f} a second")  # fmt: skip
    peers: dict[str, Callable[[Design, FloatArray], Any]] = {
        "scipy odeint (LSODA), same compiled functions": by_odeint,
        "scipy solve_ivp (LSODA), same compiled functions": by_solve_ivp,
    }
    for name, peer in peers.items():
        costs = [timed(partial(peer, r.phases[-1].design, y), REPEATS) for r, y in cases]
        print(f"{name}: median {1e6 * np.median(costs):.0f} µs, {np.median(np.array(costs) / ours):.1f} times ours")
    few = cases[:PYTHON_DESIGNS]
    with uncompiled():
        costs = [timed(partial(in_python, r.phases[-1].design, y), 1) for r, y in few]
    ratio = np.median(np.array(costs) / ours[: len(few)])
    print(f"scipy solve_ivp (LSODA), plain Python: median {1e3 * np.median(costs):.0f} ms, {ratio:.0f} times ours")


def phase_start(response: Response) -> FloatArray:
    """State from which the step is simulated."""
    start = response.phases[0].end
    assert start is not None
    return start


def by_rosenbrock(model: Divider, response: Response, start: FloatArray) -> None:
    """The integration as the model does it."""
    s, atol = model.settings, np.array(model.settings.atol)
    w = Workspace(9, s.max_steps)
    w.state[:] = start
    design = response.phases[-1].design
    run(design, 0.0, 1.0, s.max_steps, w.s, w.k, w.state, w.u, w.U, s.rtol, atol, np.inf, w.edges, w.values)


_ODEINT: Any = odeint
_SOLVE_IVP: Any = solve_ivp

RTOL = 1e-6
"""At which LSODA comes about as near to the dynamic error as the default does."""

SCALE = np.array([1e6] * 5 + [1e-2, 1e-4] + [1e6] * 2)


def by_odeint(design: Design, start: FloatArray) -> None:
    """SciPy's wrapper of LSODA in Fortran's own loop."""
    times = np.linspace(0.0, 1.0, 201)
    _ODEINT(rates, start, times, (design,), jacobian, tfirst=True, rtol=RTOL, atol=RTOL * SCALE, mxstep=100_000)


def by_solve_ivp(design: Design, start: FloatArray) -> None:
    """SciPy's LSODA in a Python loop."""
    _SOLVE_IVP(rates, (0.0, 1.0), start, "LSODA", args=(design,), jac=jacobian, rtol=RTOL, atol=RTOL * SCALE)


def in_python(design: Design, start: FloatArray) -> None:
    """The same, with the equations' Python source."""
    _SOLVE_IVP(
        kernels.rates.py_func,
        (0.0, 1.0),
        start,
        "LSODA",
        args=(design,),
        jac=kernels.jacobian.py_func,
        rtol=RTOL,
        atol=RTOL * SCALE,
    )


@contextmanager
def uncompiled() -> Iterator[None]:
    """Let the kernels' Python sources call each other's."""
    called = [
        (module, name, f)
        for module in (kernels, groove_kernels)
        for name, f in vars(module).items()
        if hasattr(f, "py_func") and name not in ("rates", "jacobian")
    ]
    for module, name, f in called:
        setattr(module, name, f.py_func)
    try:
        yield
    finally:
        for module, name, f in called:
            setattr(module, name, f)


def timed(call: Callable[[], Any], repeats: int) -> float:
    """Least time of a call [s]."""
    best = np.inf
    for _ in range(repeats):
        begin = time.perf_counter()
        call()
        best = min(best, time.perf_counter() - begin)
    return float(best)


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else COUNT)
