"""Equilibria over the whole design box: how each was found, how exact it is, and whether simulations agree.

Run it with `python benchmarks/equilibria.py`; it takes some minutes. 10,000 Sobol designs of the box of C.6, times
spool positions φ/φ0 from 0.3 to 0.7, times load pressures from 1 to 20 MPa either side, on Appendix B.1, seed 0.
"""

import math
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from divideropt.models.divider import FORMULATIONS, parameter_set, solver_settings
from divideropt.models.divider.coefficients import Valve
from divideropt.models.divider.equilibrium import (
    Equilibrium,
    find_equilibrium,
    force_profile,
    initial_guess,
    rest_on_rigid_stop,
    rests_on_stop,
    stability_margin,
)
from divideropt.models.divider.kernels import N_STATES, jacobian, rates
from divideropt.models.divider.record import Design
from divideropt.models.divider.scenario import Inputs
from divideropt.ode import integrate

COUNT = 10_000
RETURNING = 200
NEAR_BOUNDARY = 200

AUDITED = 200
"""Designs without an equilibrium whose force is looked at,"""

PLACES = 301
"""at so many places over the stroke."""

BOX = {
    "spool_radius": (6e-3, 16e-3),
    "groove_width": (0.6e-3, 2e-3),
    "total_pressure_drop": (2e6, 10e6),
    "fixed_drop_ratio": (0.3, 0.99),
    "centred_opening": (0.1, 0.9),
}
"""Variables and bounds of C.6, SI."""

INPUTS = ((0.3, 0.7), (1e6, 20e6), (1e6, 20e6))
"""φ/φ0, and both load pressures [Pa]."""

SIZES = np.array([1e7, 1e7, 1e7, 1e7, 1e7, 0.1, 1e-3, 1e7, 1e7])
"""Of the states [Pa, m/s, m], to compare deviations."""

SLOWEST = 0.5
"""A growth or decay slower than this [1/s] is not told from none within the time simulated."""

LONG = 1.0
"""How long the designs near the boundary are simulated [s], the standard test's horizon, or"""

FOLDS = 4.0
"""as long as it takes for the disturbance to grow or die by so many powers of e, if that is shorter."""


@dataclass(frozen=True)
class Case:
    """One design under one set of inputs, and its equilibrium."""

    design: Design
    rest: Equilibrium | None


def main(count: int) -> None:
    """Print what was found."""
    cases = {name: equilibria(name, count) for name in FORMULATIONS}
    for name, found in cases.items():
        describe(name, found)
    for name, found in cases.items():
        print(f"{name}: Jacobian against central differences, worst relative error {worst_slope(found):.1e}")
    returned(cases["conservative"])
    boundary(cases["conservative"])


def records(formulation: str, count: int) -> Iterator[Design]:
    """What the kernel reads for each design."""
    bounds = np.array([*BOX.values(), *INPUTS])
    points = qmc.Sobol(len(bounds), rng=0).random_base2(math.ceil(math.log2(count)))[:count]
    for point in qmc.scale(points, bounds[:, 0], bounds[:, 1]).tolist():
        changes, (position, first, second) = dict(zip(BOX, point[:5], strict=True)), point[5:]
        valve = Valve.of(parameter_set("thesis_base") | changes, FORMULATIONS[formulation])
        yield valve.under(Inputs(1e-3, position, (first, second)))


def equilibria(formulation: str, count: int) -> list[Case]:
    """Seek the equilibrium of every design from the centred spool."""
    begin = time.perf_counter()
    cases = []
    for design in records(formulation, count):
        guess = initial_guess(design)
        cases.append(Case(design, find_equilibrium(design, guess) or rest_on_rigid_stop(design, guess)))
    print(f"{formulation}: {count} designs in {time.perf_counter() - begin:.0f} s")
    return cases


def describe(name: str, cases: list[Case]) -> None:
    """Print counts, residuals and the mass balance."""
    methods = Counter("none" if case.rest is None else case.rest.method for case in cases)
    found = [(case.design, case.rest) for case in cases if case.rest is not None]
    stopped = sum(rests_on_stop(design, rest.state) for design, rest in found)
    free = [(design, rest) for design, rest in found if not rests_on_stop(design, rest.state)]
    margins = np.array([stability_margin(design, rest.state) for design, rest in free])
    print(f"{name}: {dict(methods)}; {stopped} on the stop, {(margins > 0).sum()} free and stable, "
          f"{(margins <= 0).sum()} free and unstable")  # fmt: skip
    print(f"{name}: largest scaled residual {max(rest.residual for _, rest in found):.1e}; largest gap of the whole "
          f"valve's mass balance {max(mass_gap(*pair) for pair in found):.1e} of Qs")  # fmt: skip
    lost = [case.design for case in cases if case.rest is None][:AUDITED]
    changes = Counter(force_changes(design) for design in lost)
    if lost:
        print(f"{name}: where none was found (the first {len(lost)}), the force at {PLACES} places over the stroke "
              f"passes through zero so often: {dict(changes)}")  # fmt: skip


def mass_gap(design: Design, rest: Equilibrium) -> float:
    """QL1 + QL2 + end-seal leakage - Qs, over Qs."""
    d, y = design[0], rest.state
    loads = d.load_1 * math.sqrt(max(y[7], 0.0)) + d.load_2 * math.sqrt(max(y[8], 0.0))
    return abs(float(loads + d.seal_leakage * (y[3] + y[4]) - d.source_flow)) / float(d.source_flow)


def force_changes(design: Design) -> int:
    """How often the force on a held spool changes its sign over the stroke, where it passes through zero."""
    _, forces = force_profile(design, PLACES)
    left, right = forces[:-1], forces[1:]
    jump = np.abs(right - left) > 0.1 * np.nanmax(np.abs(forces))
    return int(np.count_nonzero((np.sign(left) * np.sign(right) <= 0) & ~jump & np.isfinite(left * right)))


def worst_slope(cases: list[Case]) -> float:
    """Largest error of the analytic Jacobian at the equilibria, in shares of the largest term of its row."""
    steps = np.array([100.0, 100.0, 100.0, 100.0, 100.0, 1e-4, 1e-8, 100.0, 100.0])
    worst = 0.0
    for case in cases:
        if case.rest is None or rests_on_stop(case.design, case.rest.state):
            continue
        y = case.rest.state
        exact = jacobian(0.0, y, case.design) * SIZES
        rows = np.abs(exact).max(axis=1)
        for j, step in enumerate(steps):
            shift = np.zeros(N_STATES)
            shift[j] = step
            near = rates(0.0, y + shift, case.design) - rates(0.0, y - shift, case.design)
            far = rates(0.0, y + 2 * shift, case.design) - rates(0.0, y - 2 * shift, case.design)
            numerical = (8 * near - far) / (12 * step) * SIZES[j]
            worst = max(worst, float(np.nanmax(np.abs(numerical - exact[:, j]) / rows)))
    return worst


def stable(cases: list[Case], sign: float = 1.0) -> list[tuple[Case, float]]:
    """Free equilibria whose margin has the sign, with it."""
    found = []
    for case in cases:
        if case.rest is not None and not rests_on_stop(case.design, case.rest.state):
            margin = stability_margin(case.design, case.rest.state)
            if sign * margin > 0:
                found.append((case, margin))
    return found


def simulate(case: Case, start: NDArray[np.float64], until: float, method: str, rtol: float) -> NDArray[np.float64]:
    """State at the end of a simulation without events."""
    run = integrate(
        lambda t, y: rates(t, y, case.design),
        lambda t, y: jacobian(t, y, case.design),
        (0.0, until),
        start,
        solver_settings(method, rtol, tuple(rtol * SIZES), max_steps=1_000_000),
    )
    return run.final


def returned(cases: list[Case]) -> None:
    """Start random stable equilibria 1e-6 away and see where a long Radau run ends."""
    rng = np.random.default_rng(0)
    chosen = stable(cases)
    gaps = []
    for i in rng.choice(len(chosen), min(RETURNING, len(chosen)), replace=False):
        case, margin = chosen[i]
        assert case.rest is not None
        away = 1e-6 * SIZES * rng.uniform(-1, 1, N_STATES)
        end = simulate(case, case.rest.state + away, max(8 / margin, LONG), "Radau", 1e-10)
        gaps.append(float((np.abs(end - case.rest.state) / SIZES).max()))
    print(f"conservative: {len(gaps)} random stable equilibria, started 1e-6 away, Radau over 8/margin, at least "
          f"{LONG:g} s: largest distance at the end {max(gaps):.1e}; "
          f"{sum(gap > 1e-8 for gap in gaps)} above 1e-8")  # fmt: skip


def boundary(cases: list[Case]) -> None:
    """Compare eigenvalues with simulations for the designs nearest to the boundary of stability."""
    near = sorted((abs(margin), i, case, margin) for sign in (1.0, -1.0)
                  for i, (case, margin) in enumerate(stable(cases, sign)) if abs(margin) >= SLOWEST)  # fmt: skip
    contradictions, errors, unstable = 0, [], 0
    for _, _, case, margin in near[:NEAR_BOUNDARY]:
        rate = measured_rate(case, min(LONG, FOLDS / abs(margin)))
        contradictions += rate * margin > 0  # a positive margin is a decay
        errors.append(abs(rate + margin))
        unstable += margin < 0
    print(f"conservative: {len(errors)} designs nearest to the boundary (|margin| {near[0][0]:.2f} to "
          f"{near[len(errors) - 1][0]:.2f} 1/s, {unstable} unstable), simulated up to {LONG:g} s: {contradictions} "
          f"contradictions; growth rates differ from the eigenvalues' by at most {max(errors):.1e} 1/s")  # fmt: skip


def measured_rate(case: Case, until: float) -> float:
    """Growth rate [1/s] of the least stable mode, as simulated from a small disturbance along it."""
    assert case.rest is not None
    matrix = jacobian(0.0, case.rest.state, case.design) / SIZES[:, None] * SIZES
    values, vectors = np.linalg.eig(matrix)
    worst = int(values.real.argmax())
    along = vectors[:, worst].real
    left = np.linalg.inv(vectors)[worst]
    away = 1e-6 * along / np.abs(along).max()
    end = simulate(case, case.rest.state + SIZES * away, until, "LSODA", 1e-10)
    before, after = abs(left @ away), abs(left @ ((end - case.rest.state) / SIZES))
    return math.log(after / before) / until


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else COUNT)
