"""Which bounds the designs of a sample break, and how often."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from divideropt.problem import Told


@dataclass(frozen=True)
class Breaches:
    """How often each bound is broken, by designs whose simulation ended well: of the others nobody knows.

    Attributes:
        designs: How many ended well.
        counts: How many of them break each bound, in the order of the constraints, the lower bound of each before
            its upper, shape (b,).
        alone: How many of them break that one only: without it they would be feasible.
    """

    designs: int
    counts: NDArray[np.int64]
    alone: NDArray[np.int64]


def breaches_of(told: Told) -> Breaches:
    """Count the bounds that a batch breaks."""
    broken = told.G[told.G[:, 0] <= 0.0, 1:] > 0.0
    alone = broken[broken.sum(axis=1) == 1]
    return Breaches(len(broken), broken.sum(axis=0), alone.sum(axis=0))


def all_breaches(samples: Sequence[Breaches]) -> Breaches:
    """Count those of several samples of one problem together, at least one."""
    return Breaches(
        sum(sample.designs for sample in samples),
        np.asarray(sum(sample.counts for sample in samples)),
        np.asarray(sum(sample.alone for sample in samples)),
    )
