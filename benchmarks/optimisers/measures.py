"""How good an archive is at each mark: hypervolume, of its best points alone, IGD+, and λ over goal directions."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import moocore
import numpy as np
import pandas as pd

from divideropt.analysis import gaps, reached
from divideropt.models.base import FloatArray

from .cases import VALVE, Case
from .recorder import Archive

MARKS = (200, 1_000, 12_500)
"""Evaluations at which players are compared."""

BEST = 500
"""Points that a user may be given."""

DIRECTIONS = Path(__file__).with_name("divider_directions.csv")
"""The valve's 91 goal directions, w1, w2, w3, and each one's least max z_i/w_i, polished by every means: optimum."""

GOAL = np.array([0.0, 0.0, 16.5e6])
"""Where z is 0: % steady-state error, m³ dynamic error, Pa source pressure."""

GOAL_SPAN = np.array([2.0, 2e-6, 8.5e6])
"""z = (F - GOAL) / GOAL_SPAN."""

SMALLEST_WEIGHT = 1e-3
"""Floor of a direction's components."""

HV, HV_BEST, IGD, LAMBDA_MEAN, LAMBDA_WORST, COUNT = "hv", "hv500", "igd+", "λ mean", "λ worst", "evaluations"

TIME = "time"
"""The mark of equal wall time."""


@dataclass(frozen=True)
class Value:
    """One number of one archive.

    Attributes:
        measure: Which: `HV` and so on.
        mark: Evaluations, or `TIME`.
        value: The number: hypervolumes in shares of the known front's where there is one, else absolute.
    """

    measure: str
    mark: str
    value: float


def measured(case: Case, archive: Archive, seconds: float, marks: Sequence[int] = MARKS) -> Iterator[Value]:
    """Measure an archive at its marks and at equal time.

    Args:
        case: On what it was found.
        archive: What was found.
        seconds: Equal time [s], infinite for a player that is not compared at it.
        marks: Evaluations; those that the archive does not reach are left out.

    Yields:
        The numbers.
    """
    found = [(str(mark), archive.until(mark)) for mark in marks if archive.reaches(mark)]
    if np.isfinite(seconds) and archive.lasts(seconds):
        found.append((TIME, archive.until_second(seconds)))
        yield Value(COUNT, TIME, archive.evaluations_by(seconds))
    for mark, F in found:
        points = case.normalised(F)
        points = points[moocore.is_nondominated(points)] if len(points) else points
        yield Value(HV, mark, case.hypervolume(points) / (case.volume or 1.0))
        if mark != TIME and BEST < int(mark) <= MARKS[-1]:  # it takes seconds
            yield Value(
                HV_BEST, mark, case.hypervolume(best_subset(points, BEST, case.corner)) / (case.volume or 1.0)
            )
        if case.front is not None:
            yield Value(IGD, mark, igd_plus(points, case.front))
        if case.name == VALVE and DIRECTIONS.exists():
            excess = attainment_excess(F)
            yield Value(LAMBDA_MEAN, mark, float(excess.mean()))
            yield Value(LAMBDA_WORST, mark, float(excess.max()))


def history(
    case: Case, archive: Archive, evaluations: Sequence[int], seconds: Sequence[float]
) -> tuple[FloatArray, FloatArray]:
    """Return the hypervolume after so many evaluations, and after so many seconds; NaN beyond the run's end.

    Returns:
        Shapes (len(evaluations),) and (len(seconds),).
    """
    by_count = [
        case.hypervolume(case.normalised(archive.until(n))) if archive.reaches(n) else np.nan for n in evaluations
    ]
    by_time = [
        case.hypervolume(case.normalised(archive.until_second(s))) if archive.lasts(s) else np.nan for s in seconds
    ]
    return np.array(by_count), np.array(by_time)


def best_subset(points: FloatArray, size: int, corner: float) -> FloatArray:
    """Return the points that are left when the one of least hypervolume contribution is taken away, again and again.

    Args:
        points: Non-dominated, shape (n, k).
        size: How many are left, if there are more.
        corner: The reference point in each objective.

    Returns:
        Shape (min(n, size), k). Not quite the best subset, which nobody can compute in three objectives, but near.
    """
    reference = np.full(points.shape[1], corner)
    points = points[(points < corner).all(axis=1)]
    while len(points) > size:
        points = np.delete(points, moocore.hv_contributions(points, ref=reference).argmin(), axis=0)
    return points


def igd_plus(points: FloatArray, front: FloatArray) -> float:
    """Return the mean over the front's points of how far the nearest point lags (Ishibuchi et al. 2015)."""
    return float(moocore.igd_plus(points, ref=front)) if len(points) else np.inf


def attainment_excess(F: FloatArray) -> FloatArray:
    """Return, of each goal direction, how far the best point lies above its optimum, in shares of it.

    Args:
        F: The valve's objectives, feasible designs, shape (n, 3).

    Returns:
        min over points of max_i z_i/w_i, over the direction's optimum, less 1; infinite without points. Shape (91,).
    """
    weights, optimum = directions()
    return gaps(reached(F, weights, GOAL, GOAL_SPAN), optimum)


@cache
def directions() -> tuple[FloatArray, FloatArray]:
    """Read the goal directions, shape (n, 3), and their optima, shape (n,)."""
    table = pd.read_csv(DIRECTIONS)
    weights = table[["w1", "w2", "w3"]].to_numpy(dtype=np.float64)
    return np.maximum(weights, SMALLEST_WEIGHT), table["optimum"].to_numpy(dtype=np.float64)
