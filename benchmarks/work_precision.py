"""Which Rosenbrock method integrates this valve in the least time at a given accuracy, beside SciPy's stiff solvers.

Run it with `python benchmarks/work_precision.py`; it takes two minutes. Every method runs in the model's own compiled
loop with its coefficients exchanged, over every tenth feasible design among 2,000 Sobol points of the box of
divider.yaml; times are shares of the default's, each design's taken in turn. `--every 1` takes all of these designs,
which takes a quarter of an hour. With `--draw` Chromium draws the diagrams into docs/benchmarks.
"""

import argparse
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from types import ModuleType

import numpy as np
from designs import OBJECTIVES, exact_objectives, objectives_of, sobol_points
from diagram import Curve, draw
from exchange import loop_with
from loops import Integration
from peers import Case, Peer, by_odeint, by_solve_ivp
from tableaus import rodas4, rodas4p, rodas4p2, rodas5, rodas42
from tableaus.order import orders
from threadpoolctl import threadpool_limits

from divideropt.models.base import FloatArray
from divideropt.models.divider import Divider, solver_settings
from divideropt.ode import rodas5p

PICTURES = Path(__file__).parents[1] / "docs" / "benchmarks"

METHODS = {
    "Rodas5P": rodas5p,
    "Rodas5": rodas5,
    "Rodas4": rodas4,
    "Rodas42": rodas42,
    "Rodas4P": rodas4p,
    "Rodas4P2": rodas4p2,
}
PEERS: dict[str, Peer] = {
    "LSODA (odeint)": by_odeint,
    "Radau (solve_ivp)": partial(by_solve_ivp, method="Radau"),
    "BDF (solve_ivp)": partial(by_solve_ivp, method="BDF"),
}
PEERS_OUTSIDE = 2
"""Of the last so many peers only every second tolerance is tried: they take a hundred times as long."""

LADDER = (1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7, 3e-8, 1e-8)
"""Relative tolerances."""

WANTED = 1e-4
"""Worst deviation at which methods are compared."""

MEDIAN_WANTED = 1e-5
"""Median deviation at which they are compared besides."""

INNER = 5
"""Integrations in one timing."""

COUNT, EVERY = 2000, 10
DYNAMIC = OBJECTIVES.index("dynamic_error")
UNSURE = 0.35
"""By how much an order may be missed on a problem with finite steps."""


@dataclass
class Study:
    """What is found of one method, a tolerance each.

    Attributes:
        rtol: The tolerances.
        worst: Largest deviation of the dynamic error over the designs.
        median: Its median.
        share: Median over the designs of the time as a share of the default's.
    """

    rtol: list[float] = field(default_factory=list)
    worst: list[float] = field(default_factory=list)
    median: list[float] = field(default_factory=list)
    share: list[float] = field(default_factory=list)

    def add(self, rtol: float, off: FloatArray, share: float) -> None:
        """Take a tolerance's deviations, shape (n,), and share in."""
        self.rtol.append(rtol)
        self.worst.append(float(off.max()))
        self.median.append(float(np.median(off)))
        self.share.append(share)

    def share_at(self, deviations: Sequence[float], wanted: float) -> float:
        """Interpolate the share at a deviation, from where on tighter tolerances stay below it; NaN if never."""
        above = [i for i, off in enumerate(deviations) if off > wanted]
        last = above[-1] if above else -1
        if last == len(deviations) - 1 or last == -1:
            return float("nan")
        place = np.log(deviations[last] / wanted) / np.log(deviations[last] / deviations[last + 1])
        return float(self.share[last] * (self.share[last + 1] / self.share[last]) ** place)


def main(every: int, known: Path | None, drawn: bool) -> None:
    """Print the orders, the table and what follows; draw the diagrams."""
    for name, tableau in METHODS.items():
        check(name, tableau)
    with threadpool_limits(1):
        box = sobol_points(COUNT)
        designs = box.designs[box.feasible][::every]
        exact = exact_objectives(box.model, designs, known, None)[:, DYNAMIC]
        cases = Case.all_of(box.model, designs)
        usual = float(np.median([case.ours.cost(INNER) for case in cases]))
        print(f"\n{len(cases)} designs; times as shares of Rodas5P's at the default tolerance, {1e6 * usual:.0f} µs")
        studies = {name: rosenbrock(box.model, cases, exact, tableau) for name, tableau in METHODS.items()}
        for place, (name, peer) in enumerate(PEERS.items()):
            rungs = LADDER if place < len(PEERS) - PEERS_OUTSIDE else LADDER[::2]
            studies[name] = outside(box.model, cases, exact, peer, rungs)
    for name, study in studies.items():
        print(f"\n{name}: deviation of the dynamic error, time")
        for rtol, worst, median, share in zip(study.rtol, study.worst, study.median, study.share, strict=True):
            print(f"  rtol {rtol:.0e}   worst {worst:.1e}   median {median:.1e}   {share:6.2f}")
    conclude(studies)
    if drawn:
        for path in draw(list(curves(studies)), PICTURES, (WANTED, MEDIAN_WANTED)):
            print(path)


def check(name: str, tableau: ModuleType) -> None:
    """Hold a tableau to its order, and print what is seen of it."""
    step, estimate, interpolation = orders(tableau)
    print(f"{name:9} order seen {step:.2f}, of its estimate {estimate:.2f}, of its interpolation {interpolation:.2f}")
    if step < tableau.ORDER - UNSURE or estimate < tableau.ORDER - 1 - UNSURE:
        raise SystemExit(f"{name} misses its order {tableau.ORDER}: a coefficient of {tableau.__name__} is wrong")


def rosenbrock(model: Divider, cases: Sequence[Case], exact: FloatArray, tableau: ModuleType) -> Study:
    """Run the model's loop with another tableau."""
    loop, workspace = loop_with(tableau)
    study, work = Study(), workspace(model.settings.max_steps)
    for rtol in LADDER:
        settings = replace(solver_settings(rtol=rtol), max_steps=model.settings.max_steps)
        runs = [Integration(c.design, (c.edges[0], c.edges[-1]), c.start, settings, work, loop) for c in cases]
        quantities = np.array([c.quantities(run.trajectory()) for c, run in zip(cases, runs, strict=True)])
        shares = [run.cost(INNER) / c.ours.cost(INNER) for c, run in zip(cases, runs, strict=True)]
        study.add(rtol, deviations(model, quantities, exact), float(np.median(shares)))
    return study


def outside(model: Divider, cases: Sequence[Case], exact: FloatArray, peer: Peer, rungs: Sequence[float]) -> Study:
    """Run a peer."""
    study = Study()
    for rtol in rungs:
        quantities, shares = [], []
        peer(cases[0], rtol)
        for case in cases:
            usual, begin = case.ours.cost(INNER), time.perf_counter()
            states = peer(case, rtol)
            shares.append((time.perf_counter() - begin) / usual)
            quantities.append(case.measured(states))
        study.add(rtol, deviations(model, np.array(quantities), exact), float(np.median(shares)))
    return study


def deviations(model: Divider, quantities: FloatArray, exact: FloatArray) -> FloatArray:
    """Return the dynamic errors' relative deviations, infinite where there is none, shape (n,)."""
    off = np.abs(objectives_of(model, quantities)[:, DYNAMIC] / exact - 1.0)
    return np.where(np.isnan(off), np.inf, off)


def conclude(studies: dict[str, Study]) -> None:
    """Print the methods in the order of the time they need at the deviations wanted."""
    for what, wanted in (("worst", WANTED), ("median", MEDIAN_WANTED)):
        needed = {name: study.share_at(getattr(study, what), wanted) for name, study in studies.items()}
        ranked = sorted((name for name in needed if not np.isnan(needed[name])), key=lambda name: needed[name])
        print(f"\ntime at a {what} deviation of {wanted:.0e}, interpolated between the tolerances:")
        for name in ranked:
            print(f"  {name:18} {needed[name]:6.2f}   {needed[name] / needed['Rodas5P']:6.2f} times Rodas5P's")
        for name in set(needed) - set(ranked):
            print(f"  {name:18} has no tolerance on either side of it")
        print(f"  {ranked[0]} needs the least time there")


def curves(studies: dict[str, Study]) -> Iterator[Curve]:
    """Give every study as it is drawn."""
    for name, study in studies.items():
        yield Curve(name, np.array(study.worst), np.array(study.median), np.array(study.share), name in METHODS)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--every", type=int, default=EVERY, help="which of the feasible designs")
    parser.add_argument("--reference", type=Path, help="take the exact objectives from this file, see speed.py")
    parser.add_argument("--draw", action="store_true", help="draw the diagrams")
    given = parser.parse_args()
    main(given.every, given.reference, given.draw)
