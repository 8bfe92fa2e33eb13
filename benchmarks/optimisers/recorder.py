"""The archive of all that a player evaluates, the same for every player, and the end of its run."""

import time
from dataclasses import dataclass

import moocore
import numpy as np

from divideropt.models.base import FloatArray
from divideropt.problem import Problem, Told

CEILING = 200_000
"""Most evaluations of a run that goes on for its time."""

BLOCK = 256
"""Evaluations sifted at a time."""


class RunOverError(BaseException):
    """The run has had its evaluations and its time; no player may catch it."""


class Recorder:
    """Answers a player, and keeps what it asked, in the order in which it did.

    A run ends when it has had so many evaluations and so many seconds. A batch that would exceed the evaluations is
    answered as far as they go, and then the run ends. Seconds are those of the processor since it was made, of the
    player and of its evaluations: every player has one thread, and what else runs on the machine does not count.
    """

    def __init__(self, problem: Problem, evaluations: int, seconds: float = 0.0) -> None:
        """Record a run of at least so many evaluations and so many seconds, but never of more than `CEILING`."""
        self._problem = problem
        self._evaluations, self._seconds = evaluations, seconds
        self._ceiling = max(CEILING, evaluations)
        self._told: list[Told] = []
        self._stamps: list[FloatArray] = []
        self.count = 0
        self._begun = time.process_time()

    def elapsed(self) -> float:
        """Return the seconds since the start."""
        return time.process_time() - self._begun

    def __call__(self, designs: FloatArray) -> Told:
        """Evaluate designs, shape (n, d); ends the run where it is over."""
        room = self._ceiling if self.elapsed() < self._seconds else self._evaluations
        room = max(0, min(len(designs), room - self.count))
        if room:
            told = self._problem.tell(self._problem.simulate(designs[:room]))
            self.count += room
            self._told.append(told)
            self._stamps.append(np.full(room, self.elapsed()))
        if room < len(designs):
            raise RunOverError
        return told

    def archive(self, finished: bool = False) -> "Archive":
        """Return what was found, and whether the player has `finished` by itself."""
        ended, k = self.elapsed(), len(self._problem.objectives)
        F = np.concatenate([np.empty((0, k)), *(told.F for told in self._told)])
        feasible = np.concatenate([np.empty(0, dtype=bool), *(told.feasible for told in self._told)])
        seconds = np.concatenate([np.empty(0), *self._stamps])
        rows = np.flatnonzero(feasible)
        rows = rows[entering(F[rows])]
        return Archive(rows + 1, seconds[rows], F[rows], seconds, ended, finished)


@dataclass(frozen=True)
class Archive:
    """What a run found: the feasible designs that were not dominated by any before them. No measure needs more.

    Attributes:
        order: Which evaluation each was, from 1, shape (n,), rising.
        seconds: When each was answered [s of the processor], shape (n,).
        F: Objectives, shape (n, k).
        stamps: When each evaluation of the run was answered [s], shape (evaluations,).
        ended: When the run ended [s].
        finished: Whether the player ended it by itself; then what it found stands at any later mark.
    """

    order: np.ndarray[tuple[int], np.dtype[np.int64]]
    seconds: FloatArray
    F: FloatArray
    stamps: FloatArray
    ended: float
    finished: bool = False

    @property
    def evaluations(self) -> int:
        """How many the run had."""
        return len(self.stamps)

    def reaches(self, evaluations: int) -> bool:
        """Whether the run had so many evaluations, or needs no more."""
        return self.finished or evaluations <= self.evaluations

    def lasts(self, seconds: float) -> bool:
        """Whether the run took so long, or needs or may have no more."""
        return self.finished or seconds <= self.ended or self.evaluations >= CEILING

    def time_of(self, evaluations: int) -> float:
        """Return the seconds that the first so many evaluations took."""
        return float(self.stamps[min(evaluations, len(self.stamps)) - 1])

    def evaluations_by(self, second: float) -> int:
        """Return how many evaluations were answered by then."""
        return int(np.searchsorted(self.stamps, second, side="right"))

    def until(self, evaluations: int) -> FloatArray:
        """Return what entered in the first so many evaluations, shape (m, k)."""
        return self.F[: int(np.searchsorted(self.order, evaluations, side="right"))]

    def until_second(self, second: float) -> FloatArray:
        """Return what entered by then, shape (m, k)."""
        return self.F[: int(np.searchsorted(self.seconds, second, side="right"))]


def entering(F: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Mark the rows of F, shape (n, k), that no row before them weakly dominates."""
    marked = np.zeros(len(F), dtype=bool)
    front = np.empty((0, F.shape[1]))
    for begin in range(0, len(F), BLOCK):
        block = F[begin : begin + BLOCK]
        rows = np.flatnonzero(~_covered(block, front))
        block = block[rows]
        earlier = np.tri(len(block), k=-1, dtype=bool)
        new = ~(_weakly_dominates(block, block).T & earlier).any(axis=1)
        marked[begin + rows[new]] = True
        front = np.concatenate([front, block[new]])
        front = front[moocore.is_nondominated(front)] if len(front) else front
    return marked


def _covered(block: FloatArray, front: FloatArray) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    return np.asarray(_weakly_dominates(front, block).any(axis=0))


def _weakly_dominates(a: FloatArray, b: FloatArray) -> np.ndarray[tuple[int, int], np.dtype[np.bool_]]:
    """Compare rows of a, shape (n, k), with rows of b, shape (m, k); shape (n, m)."""
    result = np.ones((len(a), len(b)), dtype=bool)
    for left, right in zip(a.T, b.T, strict=True):
        result &= left[:, None] <= right
    return result
