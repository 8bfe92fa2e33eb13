"""Where in the box the designs of a sample failed, and how."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from divideropt.models.base import FloatArray
from divideropt.problem import DesignSpace, Evaluations

PARTS = 10
"""Equal parts of a variable's range in which failures are counted."""


@dataclass(frozen=True)
class Failures:
    """How many designs of a sample failed, and where. A design whose outcome is not ok has failed.

    Attributes:
        designs: How many there are.
        outcomes: How many failed how, by outcome, the most frequent first; without `ok`.
        counts: Designs in each part of each variable's range, from its lower bound on, shape (d, PARTS).
        failed: Those of them that failed, likewise.
    """

    designs: int
    outcomes: Mapping[str, int]
    counts: NDArray[np.int64]
    failed: NDArray[np.int64]

    @property
    def total(self) -> int:
        """How many failed."""
        return sum(self.outcomes.values())

    @property
    def share(self) -> float:
        """Part of the designs that failed; 0 of none."""
        return self.total / self.designs if self.designs else 0.0

    @property
    def shares(self) -> FloatArray:
        """Part that failed of the designs in each part of a range, NaN where there is none, shape (d, PARTS)."""
        with np.errstate(invalid="ignore"):
            return np.asarray(self.failed / self.counts)


def failures_of(evaluations: Evaluations, space: DesignSpace) -> Failures:
    """Count the failed designs, by outcome and by place; the upper bound belongs to the last part of a range."""
    ok = working(evaluations)
    shares = (evaluations.designs - space.lower) / (space.upper - space.lower)
    parts = np.clip((shares * PARTS).astype(np.int64), 0, PARTS - 1)
    outcomes = Counter(str(verdict.outcome) for verdict in evaluations.verdicts if not verdict.ok)
    return Failures(len(ok), dict(outcomes.most_common()), _counts(parts), _counts(parts[~ok]))


def all_failures(samples: Sequence[Failures]) -> Failures:
    """Count those of several samples of one box together, at least one."""
    outcomes: Counter[str] = Counter()
    for sample in samples:
        outcomes.update(sample.outcomes)
    return Failures(
        sum(sample.designs for sample in samples),
        dict(outcomes.most_common()),
        np.asarray(sum(sample.counts for sample in samples)),
        np.asarray(sum(sample.failed for sample in samples)),
    )


def working(evaluations: Evaluations) -> NDArray[np.bool_]:
    """Whether each design's outcome is ok, shape (n,)."""
    return np.fromiter((verdict.ok for verdict in evaluations.verdicts), dtype=bool, count=len(evaluations))


def _counts(parts: NDArray[np.int64]) -> NDArray[np.int64]:
    return np.array([np.bincount(column, minlength=PARTS) for column in parts.T])
