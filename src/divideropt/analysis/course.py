"""How several runs of one strategy came on: their median and their spread, at equal numbers of evaluations."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from divideropt.models.base import FloatArray

ENOUGH_RUNS = 4
"""From so many runs on the spread is that between the quartiles; of fewer that between the least and the greatest."""


@dataclass(frozen=True)
class Course:
    """The course of several runs.

    Attributes:
        marks: Numbers of evaluations of each run, rising.
        lower: Lower quartile of the runs at each mark; of few runs the least.
        median: Their median.
        upper: Upper quartile; of few runs the greatest.
        runs: How many there are.
    """

    marks: tuple[int, ...]
    lower: tuple[float, ...]
    median: tuple[float, ...]
    upper: tuple[float, ...]
    runs: int

    @property
    def quartiles(self) -> bool:
        """Whether there are runs enough for quartiles."""
        return self.runs >= ENOUGH_RUNS


def course_of(marks: Sequence[int], histories: Sequence[Sequence[float]]) -> Course:
    """Put runs together.

    Args:
        marks: Numbers of evaluations.
        histories: What each run had reached at each mark, at least one run; infinite where that is nothing yet.

    Returns:
        Their course; infinite where so many had reached nothing.
    """
    values = np.sort(np.asarray(histories, dtype=float).reshape(len(histories), len(marks)), axis=0)
    edge = 0.25 if len(values) >= ENOUGH_RUNS else 0.0
    lower, median, upper = (tuple(quantile(values, share).tolist()) for share in (edge, 0.5, 1.0 - edge))
    return Course(tuple(marks), lower, median, upper, len(values))


def quantile(values: FloatArray, share: float) -> FloatArray:
    """Interpolate between sorted values, shape (n, m), to shape (m,); numpy makes NaN of two infinite ones."""
    place = share * (len(values) - 1)
    below, above = values[int(place)], values[int(np.ceil(place))]
    with np.errstate(invalid="ignore"):
        between = below + (above - below) * (place % 1)
    return np.asarray(np.where(below == above, below, between))
