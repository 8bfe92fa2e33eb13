"""What pymoo's methods bring on `divider.yaml`, at equal evaluations: which of them a campaign offers, and why.

For each method, over its seeds: the hypervolume of all its evaluations together at the campaign's reference point,
and how far above the best known optimum of 91 directions it stays, on average over them and at worst; medians.
Each is also run twice with one seed in one process: "unseeded" is how many generators without a seed it made, "same"
whether the two runs asked for the same designs to the bit. Names in capitals are pymoo's as they come, others ours.
"""

import argparse
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any
from unittest.mock import patch

import numpy as np
from pymoo.algorithms.moo.age import AGEMOEA
from pymoo.algorithms.moo.age2 import AGEMOEA2
from pymoo.algorithms.moo.ctaea import CTAEA
from pymoo.algorithms.moo.nsga3 import NSGA3 as PymooNSGA3  # noqa: N811
from pymoo.algorithms.moo.sms import SMSEMOA as PymooSMSEMOA  # noqa: N811
from pymoo.algorithms.moo.spea2 import SPEA2
from pymoo.algorithms.moo.unsga3 import UNSGA3
from pymoo.core.algorithm import Algorithm
from pymoo.util.ref_dirs import get_reference_directions
from scipy.optimize import minimize

from divideropt.analysis import gaps, hypervolume, nondominated, reached
from divideropt.campaign.load import default_campaign
from divideropt.campaign.plan import build_problem, reference_of
from divideropt.models.base import FloatArray
from divideropt.problem import Problem, Told, one_thread
from divideropt.strategies import NSGA2, NSGA3, SMSEMOA
from divideropt.strategies.ask_tell import drive

POPULATION, GENERATIONS = 100, 125
LONG = 1200
"""Generations of the long run, 120,000 evaluations."""

DIRECTIONS = np.maximum(get_reference_directions("das-dennis", 3, n_partitions=12), 1e-3)
ORIGIN, EXTENT = np.array([0.0, 0.0, 16.5e6]), np.array([2.0, 2e-6, 8.5e6])
"""Directions w start at the origin, in these extents: 2 %, 2 mL, 8.5 MPa."""

POLISHES = 20
"""Nelder-Mead searches, each begun at the last one's end, to a direction's best known optimum, at most."""

Ask = Callable[[FloatArray], Told]
Method = Callable[[Problem, Ask, int], None]


def pymoos(make: Callable[[], Algorithm]) -> Method:
    """Drive pymoo's algorithm as it comes, objectives in scales of their quantities."""

    def run(problem: Problem, ask: Ask, seed: int) -> None:
        scales = np.array([o.quantity.scale for o in problem.objectives])

        def score(designs: FloatArray) -> tuple[FloatArray, FloatArray]:
            told = ask(designs)
            return told.F / scales, told.G

        shape = (len(scales), problem.constraint_count)
        drive(make(), problem.space, shape, score, GENERATIONS, seed)

    return run


NICHES = get_reference_directions("das-dennis", 3, n_partitions=12)

METHODS: dict[str, Method] = {
    "nsga2": NSGA2(POPULATION, GENERATIONS).run,
    "nsga3": NSGA3(POPULATION, GENERATIONS).run,
    "sms_emoa": SMSEMOA(POPULATION, GENERATIONS).run,
    "NSGA3": pymoos(lambda: PymooNSGA3(NICHES, pop_size=POPULATION)),
    "UNSGA3": pymoos(lambda: UNSGA3(NICHES, pop_size=POPULATION)),
    "AGEMOEA": pymoos(lambda: AGEMOEA(pop_size=POPULATION)),
    "AGEMOEA2": pymoos(lambda: AGEMOEA2(pop_size=POPULATION)),
    "SMSEMOA": pymoos(lambda: PymooSMSEMOA(pop_size=POPULATION)),
    "SPEA2": pymoos(lambda: SPEA2(pop_size=POPULATION)),
    "CTAEA": pymoos(lambda: CTAEA(NICHES)),
}
"""Two are not here, since they cannot keep the contract: pymoo's MOEAD takes no constraints, and the course of its
RVEA hangs on the budget."""


@dataclass(frozen=True)
class Trial:
    """The front of a run's evaluations, designs and objectives; and what it took [s]."""

    designs: FloatArray
    objectives: FloatArray
    seconds: float


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=5, help="of each method")
    parser.add_argument("methods", nargs="*", metavar="METHOD", help=f"of {', '.join(METHODS)}; all where none")
    given = parser.parse_args()
    names = given.methods or list(METHODS)
    campaign = default_campaign()
    problem, reference = build_problem(campaign), reference_of(campaign)
    assert reference is not None
    with one_thread(), np.errstate(all="ignore"):
        problem.simulate(problem.space.lower[None])  # compiles
        trials = {name: [trial(METHODS[name], problem, 1 + i) for i in range(given.seeds)] for name in names}
        trials["nsga2 × 9.6"] = [trial(NSGA2(POPULATION, LONG).run, problem, 1)]
        together = [t for several in trials.values() for t in several]
        best = optima(
            problem, np.concatenate([t.designs for t in together]), np.concatenate([t.objectives for t in together])
        )
        heads = ("hypervolume", "least", "mean gap", "worst gap", "time [s]")
        print(f"{'method':>12} {'seeds':>5} " + " ".join(f"{head:>11}" for head in heads) + "  unseeded  same")
        for name, several in trials.items():
            volumes = [hypervolume(t.objectives, reference) for t in several]
            above = [gaps(reached(t.objectives, DIRECTIONS, ORIGIN, EXTENT), best) for t in several]
            row = f"{np.median(volumes):11.6f} {min(volumes):11.6f} {np.median([a.mean() for a in above]):11.2%} "
            row += f"{np.median([a.max() for a in above]):11.2%} {np.median([t.seconds for t in several]):11.1f}"
            verdicts = contract(METHODS[name], problem) if name in METHODS else ("", "")
            print(f"{name:>12} {len(several):5d} {row}  {verdicts[0]:>8}  {verdicts[1]:>4}", flush=True)


def trial(method: Method, problem: Problem, seed: int) -> Trial:
    """Run a method, and keep what was feasible and not dominated by others of the run."""
    designs, objectives = [], []

    def ask(batch: FloatArray) -> Told:
        told = problem.tell(problem.simulate(batch))
        designs.append(batch[told.feasible])
        objectives.append(told.F[told.feasible])
        return told

    began = time.perf_counter()
    method(problem, ask, seed)
    took = time.perf_counter() - began
    told = np.concatenate(objectives)
    front = nondominated(told)
    return Trial(np.concatenate(designs)[front], told[front], took)


def optima(problem: Problem, designs: FloatArray, objectives: FloatArray) -> FloatArray:
    """Return each direction's best known value: the best of all points, polished by Nelder and Mead's method."""
    z = (objectives - ORIGIN) / EXTENT
    return np.array([_polished(problem, designs[(z / w).max(axis=1).argmin()], w) for w in DIRECTIONS])


def _polished(problem: Problem, design: FloatArray, w: FloatArray) -> float:
    lower, width = problem.space.lower, problem.space.upper - problem.space.lower
    start = (design - lower) / width

    def value(x: FloatArray) -> float:
        told = problem.tell(problem.simulate((lower + x * width)[None]))
        return float((((told.F[0] - ORIGIN) / EXTENT) / w).max()) if told.feasible[0] else 1e9

    best = value(start)
    for _ in range(POLISHES):
        simplex = np.clip(start + np.vstack([np.zeros(len(start)), 0.02 * np.eye(len(start))]), 0, 1)
        simplex[1:][start > 0.98] = start - 0.02 * np.eye(len(start))[start > 0.98]
        options: Any = {"initial_simplex": simplex, "maxfev": 1000, "xatol": 1e-7, "fatol": 1e-9, "adaptive": True}
        found = minimize(value, start, method="Nelder-Mead", bounds=[(0, 1)] * len(start), options=options)
        start, before, best = found.x, best, min(best, float(found.fun))
        if before - best < 1e-5 * best:
            break
    return best


def contract(method: Method, problem: Problem) -> tuple[str, str]:
    """Say how often a run makes an unseeded generator, and whether two of one seed are the same to the bit."""
    asked: list[list[bytes]] = []
    drawn = 0
    for _ in range(2):
        batches: list[bytes] = []

        def ask(batch: FloatArray, batches: list[bytes] = batches) -> Told:
            batches.append(batch.tobytes())
            return problem.tell(problem.simulate(batch))

        with counting_unseeded() as made:
            method(problem, ask, 1)
        asked.append(batches)
        drawn = made[0]
    return str(drawn), "yes" if asked[0] == asked[1] else "no"


@contextmanager
def counting_unseeded() -> Iterator[list[int]]:
    """Count the generators made without a seed."""
    made, real = [0], np.random.default_rng

    def default_rng(seed: Any = None) -> np.random.Generator:
        made[0] += seed is None
        return real(seed)

    with patch.object(np.random, "default_rng", default_rng):
        yield made


if __name__ == "__main__":
    main()
