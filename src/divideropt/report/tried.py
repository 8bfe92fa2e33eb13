"""What was tried: evaluations of every run, as many as a page can show behind the front."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from divideropt.analysis import Summary
from divideropt.models.base import FloatArray
from divideropt.problem import FAILURE_VIOLATION

MOST_TRIED = 20_000
"""Evaluations that the page holds: each has its place in every projection."""


@dataclass(frozen=True)
class Tried:
    """Evaluations that ended in objectives, all or a sample.

    Attributes:
        objectives: Shape (n, k), in the quantities' units.
        feasible: Which keep every constraint, shape (n,).
        considered: Of how many evaluations these are: of those that did not fail.
        failed: How many failed, and have no place.
    """

    objectives: FloatArray
    feasible: NDArray[np.bool_]
    considered: int
    failed: int

    def __len__(self) -> int:
        """Number of evaluations held."""
        return len(self.feasible)


def read_tried(logs: Mapping[str, Summary], most: int = MOST_TRIED) -> Tried:
    """Sample the evaluations of all runs evenly: of each run its share, and from its begin to its end alike.

    Where there are more than `most`, evaluations at even steps through all logs, one after the other, are taken, the
    first and the last among them: the same of the same logs.

    Args:
        logs: Each run's log, summed up; at least one.
        most: How many to keep.
    """
    objectives = np.concatenate([log.told.F[log.shared :] for log in logs.values()])
    violation = np.concatenate([log.told.violation[log.shared :] for log in logs.values()])
    ended = np.flatnonzero(violation < FAILURE_VIOLATION)
    kept = ended
    if len(ended) > most:
        kept = ended[np.linspace(0, len(ended) - 1, most).round().astype(np.intp)]
    return Tried(objectives[kept], violation[kept] == 0.0, len(ended), len(objectives) - len(ended))
