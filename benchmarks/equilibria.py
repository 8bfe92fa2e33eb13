"""Equilibria over the whole design box: how each was found, how exact it is, and whether simulations agree.

Run it with `python benchmarks/equilibria.py`; it takes some minutes. 10,000 Sobol designs of the box of C.6, times
spool positions φ/φ0 from 0.3 to 0.7, times load pressures from 1 to 20 MPa either side, on Appendix B.1, seed 0.
"""

import math
import sys
import time
from collections import Counter
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import qmc

from divideropt.campaign.load import default_campaign
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
from divideropt.models.divider.kernels import jacobian, rates
from divideropt.models.divider.record import Design
from divideropt.models.divider.scenario import Inputs
from divideropt.models.divider.states import N_STATES, STATES
from divideropt.ode import integrate

COUNT = 10_000
RETURNING = 200
NEAR_BOUNDARY = 200

CLOSER = 6
"""Times a change of sign is looked at more closely."""

KINK = 1e-6
"""A spool nearer than this [m] to a port's edge has no difference quotient to compare with."""

AUDITED = 200
"""Designs without an equilibrium whose force is looked at,"""

PLACES = 301
"""at so many places over the stroke."""

BOX = default_campaign().variables
"""Variables and bounds of C.6, SI."""

READINGS = {**FORMULATIONS, "with losses": replace(FORMULATIONS["conservative"], groove_loss=True)}
"""The formulations, and `conservative` with `groove_loss: entrance`."""

INPUTS = ((0.3, 0.7), (1e6, 20e6), (1e6, 20e6))
"""φ/φ0, and both load pressures [Pa]."""

SIZES = np.array([1e7, 1e7, 1e7, 1e7, 1e7, 0.1, 1e-3, 1e7, 1e7])
"""Of the states [Pa, m/s, m], to compare deviations."""

SLOWEST = 0.5
"""A growth or decay slower than this [1/s] is not told from none within the time simulated."""

FASTEST = 10.0
"""A design that grows or decays faster than this [1/s] is not near the boundary."""

LONG = 1.0
"""How long the designs near the boundary are simulated [s], the standard test's horizon, or"""

FOLDS = 4.0
"""as long as it takes for the disturbance to grow or die by so many powers of e, if that is shorter."""


@dataclass(frozen=True)
class Case:
    """One design under one set of inputs, and its equilibrium."""

    point: NDArray[np.float64]
    design: Design
    rest: Equilibrium | None


def main(count: int) -> None:
    """Print what was found."""
    cases = {name: equilibria(name, count) for name in READINGS}
    for name, found in cases.items():
        describe(name, found)
    for name, found in cases.items():
        print(f"{name}: Jacobian against central differences, worst relative error {worst_slope(found):.1e}")
    returned(cases["conservative"])
    boundary(cases["conservative"])


def points(count: int) -> NDArray[np.float64]:
    """Sobol points: the variables of C.6, φ/φ0, the load pressures, shape (count, 8)."""
    bounds = np.array([*BOX.values(), *INPUTS])
    unit = qmc.Sobol(len(bounds), rng=0).random_base2(math.ceil(math.log2(count)))[:count]
    return np.asarray(qmc.scale(unit, bounds[:, 0], bounds[:, 1]))


def solved(formulation: str, point: NDArray[np.float64]) -> Case:
    """Seek the equilibrium of one design from the centred spool."""
    *variables, position, first, second = point.tolist()
    changes = dict(zip(BOX, variables, strict=True))
    valve = Valve.of(parameter_set("thesis_base") | changes, READINGS[formulation])
    design = valve.under(Inputs(1e-3, position, (first, second)))
    guess = initial_guess(design)
    return Case(point, design, find_equilibrium(design, guess) or rest_on_rigid_stop(design, guess))


def equilibria(formulation: str, count: int) -> list[Case]:
    """Seek the equilibrium of every design."""
    begin = time.perf_counter()
    cases = [solved(formulation, point) for point in points(count)]
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
    changes = Counter(force_roots(design) for design in lost)
    if lost:
        print(f"{name}: where none was found (the first {len(lost)}), the force at {PLACES} places over the stroke "
              f"passes through zero so often: {dict(changes)}")  # fmt: skip


def mass_gap(design: Design, rest: Equilibrium) -> float:
    """QL1 + QL2 + end-seal leakage - Qs, over Qs."""
    d, y = design[0], rest.state
    loads = d.load_1 * math.sqrt(max(y[7], 0.0)) + d.load_2 * math.sqrt(max(y[8], 0.0))
    return abs(float(loads + d.seal_leakage * (y[3] + y[4]) - d.source_flow)) / float(d.source_flow)


def force_roots(design: Design) -> int:
    """How often the force on a held spool passes through zero over the stroke; a jump over zero is no root."""
    places, forces = force_profile(design, PLACES)
    signs = np.sign(forces[:-1]) * np.sign(forces[1:])
    return sum(passes_zero(design, *places[i : i + 2]) for i in np.flatnonzero(signs <= 0))


def passes_zero(design: Design, left: float, right: float) -> bool:
    """Whether the force vanishes between two places where its signs differ: look closer, ten times each time."""
    first = math.nan
    for _ in range(CLOSER):
        places, forces = force_profile(design, 11, (left, right))
        change = np.flatnonzero(np.sign(forces[:-1]) * np.sign(forces[1:]) <= 0)
        if len(change) == 0:
            return False
        i = int(change[0])
        left, right = places[i : i + 2]
        size = float(np.abs(forces[i : i + 2]).max())
        first = size if math.isnan(first) else first
    return size < 1e-2 * first or size == 0.0


def worst_slope(cases: list[Case]) -> float:
    """Largest error of the analytic Jacobian at the equilibria, in shares of the largest term of its row."""
    steps = np.array([100.0, 100.0, 100.0, 100.0, 100.0, 1e-4, 1e-8, 100.0, 100.0])
    worst = 0.0
    for case in cases:
        if case.rest is None or rests_on_stop(case.design, case.rest.state):
            continue
        y = case.rest.state
        if edge_distance(case.design, y) < KINK:
            continue
        exact = jacobian(0.0, y, case.design) * SIZES
        rows = np.abs(exact).max(axis=1)
        for j, step in enumerate(steps):
            shift = np.zeros(N_STATES)
            shift[j] = step
            near = rates(0.0, y + shift, case.design) - rates(0.0, y - shift, case.design)
            far = rates(0.0, y + 2 * shift, case.design) - rates(0.0, y - 2 * shift, case.design)
            numerical = (8 * near - far) / (12 * step) * SIZES[j]
            worst = max(worst, float((np.abs(numerical - exact[:, j]) / rows).max()))
    return worst


def edge_distance(design: Design, y: NDArray[np.float64]) -> float:
    """How far the spool is from where a port's area, or the stop's force, has no derivative [m]."""
    d = design[0]
    edges = [abs(abs(d.port_offset + side * y[STATES.index("x")]) - d.port_radius) for side in (-1, 1)]
    return float(min(*edges, abs(d.stop_position - abs(y[STATES.index("x")]))))


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
    """Compare eigenvalues with simulations for designs on either side of the boundary of stability."""
    rng = np.random.default_rng(1)
    safe, lost = stable(cases), stable(cases, -1.0)
    near: list[tuple[Case, float]] = []
    tried = 0
    while len(near) < NEAR_BOUNDARY and lost and tried < 20 * NEAR_BOUNDARY:
        inside, outside = safe[rng.integers(len(safe))][0], lost[rng.integers(len(lost))][0]
        near += either_side(inside.point, outside.point)
        tried += 1
    contradictions, errors, unstable = 0, [], 0
    for case, margin in near[:NEAR_BOUNDARY]:
        rate = measured_rate(case, min(LONG, FOLDS / abs(margin)))
        contradictions += rate * margin > 0  # a positive margin is a decay
        errors.append(abs(rate + margin) / abs(margin))
        unstable += margin < 0
    margins = [abs(margin) for _, margin in near[:NEAR_BOUNDARY]]
    print(f"conservative: {len(errors)} designs near the boundary (on lines between stable and unstable ones; "
          f"|margin| {min(margins):.2f} to {max(margins):.2f} 1/s, {unstable} unstable), simulated up to {LONG:g} s: "
          f"{contradictions} contradictions; growth rates differ from the eigenvalues' by at most {max(errors):.1e} "
          f"of themselves")  # fmt: skip


def either_side(inside: NDArray[np.float64], outside: NDArray[np.float64]) -> list[tuple[Case, float]]:
    """Bisect the line between a stable and an unstable design; return one near the boundary on either side."""

    def at(share: float) -> tuple[Case, float]:
        case = solved("conservative", inside + share * (outside - inside))
        free = case.rest is not None and not rests_on_stop(case.design, case.rest.state)
        return case, stability_margin(case.design, case.rest.state) if free and case.rest else math.nan

    low, high = 0.0, 1.0
    for _ in range(30):
        middle = (low + high) / 2
        margin = at(middle)[1]
        if math.isnan(margin):
            return []
        low, high = (middle, high) if margin > 0 else (low, middle)
    found = []
    for place, way in ((low, -1.0), (high, 1.0)):
        step = 1e-6
        case, margin = at(place)
        while abs(margin) < SLOWEST and 0.0 < place + way * step < 1.0:
            case, margin = at(place + way * step)
            step *= 2
        if SLOWEST <= abs(margin) <= FASTEST and margin * way < 0:
            found.append((case, margin))
    return found if len(found) == 2 else []


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
