"""The valve's goal directions and the optimum of each: `python -m benchmarks.optimisers.polished`, some minutes.

Sets out from the archives of NSGA-II after 120,000 evaluations and of three memetic runs, and solves each direction's
goal-attainment problem by SLSQP from its three nearest designs that differ, round after round with other directions'
answers to set out from, until no direction gains more than 1e-5. Prints by how much the optima differ from those in
`divider_directions.csv`, and writes there whichever are better.
"""

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pandas as pd

from divideropt.models.base import FloatArray
from divideropt.problem import Problem, Told, one_thread
from divideropt.strategies import NSGA2, Evaluate, Memetic, Strategy, reference_directions
from divideropt.strategies.archive import Archive, Scale, reached
from divideropt.strategies.gembicki import Goal, attain

from .cases import VALVE, case_of

TABLE = Path(__file__).with_name("divider_directions.csv")

SCALE = Scale(np.array([0.0, 0.0, 16.5e6]), np.array([2.0, 2e-6, 8.5e6]))
"""0, 0, 16.5 MPa, and 2 %, 2 mL, 8.5 MPa: what the errors and the source pressure of a good valve are measured by."""

EXPLORERS: tuple[tuple[Strategy, int], ...] = (
    (NSGA2(population=100, generations=1200), 1),
    *((Memetic(), seed) for seed in (1, 2, 3)),
)

STARTS = 3
"""Designs from which a direction is solved, a round."""

APART = 0.03
"""Part of the box by which they differ in some variable."""

GAIN = 1e-5
"""A round in which no direction gains more is the last."""

GRANT = 400
"""Evaluations from one start."""


def main() -> int:
    """Find the optima and write them; returns the exit code."""
    problem = case_of(VALVE).problem
    directions = reference_directions(3, 91)
    archive = Archive(problem, lambda designs: problem.tell(problem.simulate(designs)))
    with one_thread():
        for strategy, seed in EXPLORERS:
            strategy.run(problem, archive.score, seed)
            archive.settle()
            print(f"{type(strategy).__name__} {seed}: mean optimum {_mean(archive, directions):.6g}", file=sys.stderr)
        gain = np.inf
        while gain > GAIN:
            before = reached(archive, SCALE, directions)
            for direction in directions:
                _polish(Goal(direction, SCALE, 0.0), archive, problem)
            gain = float((before / reached(archive, SCALE, directions) - 1.0).max())
            print(f"a round of SLSQP: gained {gain:.1e} at most", file=sys.stderr)
    table = pd.DataFrame(_rows(archive, directions, problem.space.names))
    if TABLE.exists():
        known = pd.read_csv(TABLE)
        differ = table["optimum"] / known["optimum"] - 1.0
        print(f"optima against those that stood there: {differ.min():.1e} to {differ.max():.1e}")
        table = table.where(differ < 0.0, known)
    table.to_csv(TABLE, index=False)
    return 0


def _mean(archive: Archive, directions: FloatArray) -> float:
    return float(reached(archive, SCALE, directions).mean())


def _polish(goal: Goal, archive: Archive, problem: Problem) -> None:
    """Solve one direction's problem from several designs."""
    width = problem.space.upper - problem.space.lower
    starts: list[FloatArray] = []
    for design in archive.X[np.argsort(goal.of(archive.F), kind="stable")]:
        if all((np.abs(design - other) > APART * width).any() for other in starts):
            starts.append(design)
        if len(starts) == STARTS:
            break
    for start in starts:
        try:
            attain(start, goal, problem.space, _granted(archive), "slsqp")
        except _SpentError:
            continue
        finally:
            archive.settle()


class _SpentError(Exception):
    """The evaluations from one start are spent."""


def _granted(archive: Archive) -> Evaluate:
    left = GRANT

    def score(designs: FloatArray) -> Told:
        nonlocal left
        left -= len(designs)
        if left < 0:
            raise _SpentError
        return archive.score(designs)

    return score


def _rows(archive: Archive, directions: FloatArray, names: tuple[str, ...]) -> Iterator[dict[str, float]]:
    for direction in directions:
        values = Goal(direction, SCALE, 0.0).of(archive.F)
        best = int(values.argmin())
        weights = {f"w{i}": float(w) for i, w in enumerate(direction, start=1)}
        design = dict(zip(names, archive.X[best].tolist(), strict=True))
        yield {**weights, "optimum": float(values[best]), **design}


if __name__ == "__main__":
    sys.exit(main())
