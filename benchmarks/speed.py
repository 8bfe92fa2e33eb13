"""What an evaluation costs: ratios to named peers, measured in one run, at the accuracy each reaches.

Run it with `python benchmarks/speed.py`. The reference alone takes four minutes: keep it with `--save FILE`, and give
it with `--reference FILE` the next time; the rest takes two. The peers integrate the same compiled equations from the
same settled start over the same second: `scipy.integrate.odeint` (LSODA, with the Jacobian), `solve_ivp` with LSODA,
the first in plain Python, and numbalsoda if it is installed. Whatever is compared is timed in turn, design by design.
"""

import argparse
import time
from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from designs import OBJECTIVES, ROUNDING, Box, exact_objectives, objectives_of, sobol_points
from loops import kernel_costs, timed
from peers import Case, Peer, by_odeint, by_solve_ivp, in_python, numbalsoda_peer, uncompiled
from sharing import share
from threadpoolctl import threadpool_limits

from divideropt.models.base import FloatArray
from divideropt.models.divider import Divider
from divideropt.ode.rodas5p import STAGES

LADDER = (1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 3e-7, 1e-7, 3e-8, 1e-8)
"""Relative tolerances that a peer is tried at, from the loosest."""

ODEINT, SOLVE_IVP = "scipy odeint (LSODA)", "scipy solve_ivp (LSODA)"
PYTHON, NUMBALSODA = "scipy odeint (LSODA), plain Python", "numbalsoda (LSODA)"

SOME = 40
"""Designs that plain Python integrates, and whose steps are taken apart."""

INNER = 5
"""Our integrations in one timing."""

ALIKE = 20
"""Times the same design in one batch."""

REPEATS = 3
"""Timings of a batch, of which the least counts."""

BATCHES = ((100, 200), (1_000, 20), (10_000, 4))
"""Sizes of the batches that are shared, and rounds."""

DYNAMIC = OBJECTIVES.index("dynamic_error")
PARTS = ("peers", "worst", "kernels", "sharing")


@dataclass(frozen=True)
class Figure:
    """A figure, and what is asked of it; `most` is what the machine gives at all."""

    what: str
    value: float
    wanted: float
    at_least: bool = True
    most: float = np.inf

    def __str__(self) -> str:
        """Say whether it holds."""
        holds = self.value >= self.wanted if self.at_least else self.value <= self.wanted
        asked = f"{'at least' if self.at_least else 'at most'} {self.wanted:g}"
        busy = f", but the machine gave no more than {self.most:.3g}" if self.most < self.wanted else ""
        return f"{self.what}: {self.value:.3g}, {asked}: {'holds' if holds else 'falls short' + busy}"


def main(count: int, known: Path | None, keep: Path | None, parts: Sequence[str]) -> None:
    """Print the tables, and at the end the figures."""
    figures: list[Figure] = []
    with threadpool_limits(1):
        box = sobol_points(count)
        model, designs = box.model, box.designs[box.feasible]
        print(f"{len(designs)} feasible designs among {count} Sobol points of the box of divider.yaml")
        exact = exact_objectives(model, designs, known, keep)
        ours = deviations(objectives_of(model, model.evaluate(designs)[0]), exact)
        figures += accuracy(ours)
        if "peers" in parts:
            figures += peers(model, designs, exact, ours)
        if "worst" in parts:
            figures += worst(box)
        if "kernels" in parts:
            kernels(model, designs)
        if "sharing" in parts:
            figures += sharing(model, designs)
    print("\nwhat is asked:")
    print(*figures, sep="\n")


def deviations(objectives: FloatArray, exact: FloatArray) -> FloatArray:
    """Return the relative deviations, infinite where there is no value, shape (n, 3)."""
    off = np.abs(objectives / exact - 1.0)
    return np.where(np.isnan(off), np.inf, off)


def accuracy(ours: FloatArray) -> list[Figure]:
    """Print how near the objectives come to Radau's at rtol 1e-10."""
    print("\ndeviation from Radau at rtol 1e-10, at the default tolerance:")
    for name, off in zip(OBJECTIVES, ours.T, strict=True):
        print(f"  {name:20} worst {off.max():.1e}   median {np.median(off):.1e}")
    return [Figure("worst deviation of an objective", float(ours.max()), 1e-4, at_least=False)]


def peers(model: Divider, designs: FloatArray, exact: FloatArray, ours: FloatArray) -> list[Figure]:
    """Print what each peer costs where it comes as near as we do."""
    cases = Case.all_of(model, designs)
    states = np.median([len(case.times) for case in cases])
    print(
        "\nan integration alone, from the same start over the same second; the peers give the states that the metrics"
    )
    print(f"need, {states:.0f} in the median, at the nodes of our steps; measuring them is untimed")
    ladder = Ladder(model, cases, exact, ours)
    numbalsoda = numbalsoda_peer()
    tolerance, ratio = ladder.climb(ODEINT, by_odeint)
    figures = [Figure(f"times as fast as {ODEINT}", ratio, 20.0)]
    ladder.climb(SOLVE_IVP, by_solve_ivp)
    figures.append(Figure(f"times as fast as {PYTHON}", plain_python(cases[:SOME], tolerance), 100.0))
    if numbalsoda is None:
        print(f"{NUMBALSODA}: not installed; pip install numbalsoda, which needs cmake, a C++ and a Fortran compiler")
    else:
        figures.append(Figure(f"times as fast as {NUMBALSODA}", ladder.climb(NUMBALSODA, numbalsoda)[1], 3.0))
    return figures


@dataclass(frozen=True)
class Ladder:
    """Designs over which a peer is tried at one tolerance after the other.

    Attributes:
        model: The valve.
        cases: Its responses to the designs.
        exact: Their objectives, shape (n, 3).
        ours: Our deviations from these, shape (n, 3).
    """

    model: Divider
    cases: Sequence[Case]
    exact: FloatArray
    ours: FloatArray

    def climb(self, name: str, peer: Peer) -> tuple[float, float]:
        """Print a peer's rungs, up to one beyond the loosest at which it is as near as we are.

        Returns:
            That tolerance, and the ratio of the median times there.
        """
        print(f"\n{name}: dynamic error's deviation, median times, ratio")
        chosen, ratio = np.nan, np.nan
        for rtol in LADDER:
            off, theirs, own = self.rung(peer, rtol)
            as_near = self.as_near(off)
            quotient = np.median(theirs) / np.median(own)
            mark = " <- as near as ours" if as_near and np.isnan(chosen) else ""
            print(
                f"  rtol {rtol:.0e}   worst {off[:, DYNAMIC].max():.1e}   median {np.median(off[:, DYNAMIC]):.1e}   "
                f"{1e6 * np.median(theirs):6.0f} µs to {1e6 * np.median(own):4.1f} µs   {quotient:5.1f}{mark}"
            )
            if not np.isnan(chosen):
                break
            if as_near:
                chosen, ratio = rtol, quotient
        return chosen, ratio

    def rung(self, peer: Peer, rtol: float) -> tuple[FloatArray, list[float], list[float]]:
        """Return a peer's deviations, shape (n, 3), its times and ours [s]."""
        quantities, theirs, own = [], [], []
        peer(self.cases[0], rtol)
        for case in self.cases:
            own.append(case.ours.cost(INNER))
            begin = time.perf_counter()
            states = peer(case, rtol)
            theirs.append(time.perf_counter() - begin)
            quantities.append(case.measured(states))
        return deviations(objectives_of(self.model, np.array(quantities)), self.exact), theirs, own

    def as_near(self, off: FloatArray) -> bool:
        """Whether deviations are no larger than ours, at the worst and in the median, of each objective."""
        at_worst = off.max(axis=0) <= np.maximum(self.ours.max(axis=0), ROUNDING)
        in_median = np.median(off, axis=0) <= np.maximum(np.median(self.ours, axis=0), ROUNDING)
        return bool(at_worst.all() and in_median.all())


def plain_python(cases: Sequence[Case], rtol: float) -> float:
    """Print what the equations' Python source costs in odeint; return the ratio of the median times."""
    with uncompiled():
        costs = [(case.ours.cost(INNER), timed(partial(in_python, case, rtol))) for case in cases]
    own, theirs = np.median(costs, axis=0).tolist()
    print(f"\n{PYTHON}: rtol {rtol:.0e}, the same steps and states as compiled; {len(cases)} designs:\n"
          f"  {1e6 * theirs:.0f} µs to {1e6 * own:.1f} µs   {theirs / own:.0f}")  # fmt: skip
    return float(theirs / own)


def worst(box: Box) -> list[Figure]:
    """Print what a whole evaluation costs: the batch, and each design of the box in a batch of its own kind."""
    model, feasible = box.model, box.designs[box.feasible]
    batch = timed(lambda: model.evaluate(feasible), REPEATS) / len(feasible)
    alike = (np.tile(row, (ALIKE, 1)) for row in box.designs)
    costs = np.array([timed(partial(model.evaluate, batch), REPEATS) for batch in alike]) / ALIKE
    ratio = float(costs.max() / np.median(costs))
    print("\nwhole evaluations, with rests, margins, metrics and verdicts, on one thread:")
    print(f"  all feasible designs in one batch: {1e6 * batch:.1f} µs a design, {1 / batch:.0f} a second")
    for what, part in (("the feasible", costs[box.feasible]), ("all", costs)):
        print(f"  {what} {len(part)} designs, {ALIKE} alike in a batch: median {1e6 * np.median(part):.1f} µs "
              f"a design, worst {1e6 * part.max():.0f} µs")  # fmt: skip
    return [Figure("worst design of the box, in medians", ratio, 50.0, at_least=False)]


def kernels(model: Divider, designs: FloatArray) -> None:
    """Print what the pieces of a step cost, in the median over some designs, and what of a step they make."""
    cases = Case.all_of(model, designs[:SOME])
    pieces = [kernel_costs(case.design, case.start) for case in cases]
    cost = {name: float(np.median([piece[name] for piece in pieces])) for name in pieces[0]}
    step = float(np.median([case.ours.cost(INNER) / (len(case.edges) - 1) for case in cases]))
    made_of = (
        cost["rates and Jacobian"] + (STAGES - 1) * cost["rates"] + cost["factorisation"] + STAGES * cost["solution"]
    )
    print("\nthe pieces of a step, from compiled loops, medians:")
    print(*(f"  {name}: {1e9 * value:.0f} ns" for name, value in cost.items()), sep="\n")
    print(f"  a step: {1e9 * step:.0f} ns, rejected ones shared out; one Jacobian, {STAGES - 1} rates, one "
          f"factorisation and {STAGES} solutions: {1e9 * made_of:.0f} ns")  # fmt: skip


def sharing(model: Divider, designs: FloatArray) -> list[Figure]:
    """Print what two threads give, and two processes as the most that this machine can."""
    print("\nbatches on two threads, and in two processes as the most that this machine's cores give:")
    found = share(model, designs, BATCHES)
    for s in found:
        print(f"  {s.count:6} designs: one thread {1e3 * s.one:.2f} ms; two threads are {s.one / s.threads:.2f} "
              f"times as fast, two processes {s.one / s.processes:.2f};\n"
              f"    both threads' processor time: {s.threads_work / s.one_works:.2f} times one's")  # fmt: skip
    return [Figure(f"two threads to one, {s.count} designs", s.one / s.threads, 1.8, most=s.one / s.processes)
            for s in found]  # fmt: skip


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=2000, help="Sobol points")
    parser.add_argument("--reference", type=Path, help="take the exact objectives from this file")
    parser.add_argument("--save", type=Path, help="keep the exact objectives in this file")
    parser.add_argument(
        "--parts", nargs="+", choices=PARTS, default=PARTS, help="what is measured beside the accuracy"
    )
    given = parser.parse_args()
    main(given.count, given.reference, given.save, given.parts)
