"""Where a run is: the process that does it says so in a small file, now and then."""

import json
import time
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from divideropt.analysis import best_attainment, hypervolume, nondominated
from divideropt.campaign.execute import Progress
from divideropt.models.base import FloatArray
from divideropt.problem import Problem, Told

WRITE_SECONDS = 0.5
"""How often a run says where it is, or less often, where that costs a share of its time that matters: """

WRITE_SHARE = 0.03
"""at most this."""


@dataclass(frozen=True)
class Standing:
    """Where a run is.

    Attributes:
        run: Its name.
        done: Evaluations answered.
        budget: Most evaluations it asks for.
        replayed: Those of them that came from the log.
        rate: Evaluations simulated a second; 0 before the first.
        best: Least max λ_i of its feasible designs; None where there is none, or no goals.
        hypervolume: Of its feasible designs, None without a reference point.
        ended: Why the run has ended; None before it has.
    """

    run: str
    done: int
    budget: int
    replayed: int
    rate: float
    best: float | None
    hypervolume: float | None
    ended: str | None

    @property
    def left(self) -> float | None:
        """How long its budget lasts at its rate [s]; None before that is known, and 0 once it has ended."""
        if self.ended is not None:
            return 0.0
        return (self.budget - self.done) / self.rate if self.rate > 0 else None


def time_left(standings: Sequence[Standing], budgets: Mapping[str, int]) -> float | None:
    """Estimate how long all runs take, should each spend its budget.

    Args:
        standings: Of the runs that have begun.
        budgets: Evaluations of every run, by name.

    Returns:
        All that is left at the rate at which the runs at work go on together, or what the slowest of them has left,
        if that is longer [s]; None before any has a rate.
    """
    working = [s for s in standings if s.ended is None]
    rate = sum(s.rate for s in working)
    begun = {s.run for s in standings}
    waiting = sum(budget for run, budget in budgets.items() if run not in begun)
    if rate <= 0.0:
        return 0.0 if not working and not waiting else None
    together = (waiting + sum(s.budget - s.done for s in working)) / rate
    return max([together, *(s.left for s in working if s.left is not None)])


def read_standings(folder: Path, runs: Iterable[str]) -> list[Standing]:
    """Read where runs are, from the files that they write; of one that has none, or half of one, nothing."""
    found = []
    for run in runs:
        try:
            text = (folder / f"{run}.json").read_text(encoding="utf-8")
            found.append(Standing(**json.loads(text)))
        except (OSError, ValueError, TypeError):
            continue
    return found


class Reporter:
    """Keeps a run's standing and writes it to a file now and then."""

    def __init__(self, path: Path, run: str, budget: int, problem: Problem, reference: FloatArray | None) -> None:
        """Begin with nothing done."""
        self._path, self._run, self._budget = path, run, budget
        self._problem, self._reference = problem, reference
        self._done = self._replayed = 0
        self._best: float | None = None
        self._front = np.empty((0, len(problem.objectives)))
        self._fresh: list[Told] = []
        self._began = self._written = time.monotonic()
        self._took = 0.0

    def __call__(self, progress: Progress) -> None:
        """Hear of a batch."""
        n = len(progress.told.F)
        self._done += n
        if progress.replayed:
            self._replayed += n
            self._began = time.monotonic()
        self._fresh.append(progress.told)
        if time.monotonic() - self._written >= max(WRITE_SECONDS, self._took / WRITE_SHARE):
            self.write()
            self._took = time.monotonic() - self._written

    def write(self, ended: str | None = None) -> None:
        """Write the standing, and why the run has ended if it has; a disk that refuses does not matter here."""
        self._written = time.monotonic()
        text = json.dumps(asdict(self._standing(ended)))
        temporary = self._path.with_suffix(".new")
        try:
            temporary.write_text(text, encoding="utf-8")
            temporary.replace(self._path)
        except OSError:
            return

    def _standing(self, ended: str | None) -> Standing:
        if self._fresh:
            told = Told(*(np.concatenate(parts) for parts in zip(*((t.F, t.G) for t in self._fresh), strict=True)))
            self._fresh = []
            best = best_attainment(told, self._problem)
            if best is not None and (self._best is None or best[1] < self._best):
                self._best = best[1]
            front = np.concatenate([self._front, told.F[told.feasible]])
            self._front = front[nondominated(front)]
        elapsed = time.monotonic() - self._began
        fresh = self._done - self._replayed
        volume = None if self._reference is None else hypervolume(self._front, self._reference)
        rate = fresh / elapsed if elapsed > 0 else 0.0
        return Standing(self._run, self._done, self._budget, self._replayed, rate, self._best, volume, ended)
