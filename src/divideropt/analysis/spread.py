"""Few instead of many: designs spread evenly along a front."""

from collections.abc import Sequence

import numpy as np
import pyarrow as pa

from divideropt.models.base import FloatArray
from divideropt.problem import AGGREGATES, Problem
from divideropt.store import TableSchema


def representatives(front: pa.Table, problem: Problem, schema: TableSchema, most: int) -> list[str]:
    """Choose designs that stand for a front: the best of each objective and by the goals, and an even spread.

    Args:
        front: Feasible non-dominated results.
        problem: What was optimised.
        schema: The store's columns.
        most: How many; all of a front that has no more.

    Returns:
        Their `design_id`, in the front's order; the same for the same front.
    """
    ids: list[str] = front["design_id"].to_pylist()
    if len(ids) <= most:
        return ids
    F = problem.tell(schema.evaluations(front)).F
    first = [*F.argmin(axis=0).tolist(), *F.argmax(axis=0).tolist()]
    if all(o.goal is not None for o in problem.objectives):
        first.insert(0, int(AGGREGATES["goal_attainment"](F, problem.objectives).argmin()))
    return [ids[row] for row in sorted(spread(F, first, most))]


def spread(points: FloatArray, first: Sequence[int], count: int) -> list[int]:
    """Choose points far from each other: after the first ones, always the one farthest from all chosen.

    Args:
        points: Shape (n, k).
        first: Rows that are chosen anyway.
        count: How many rows to choose in all.

    Returns:
        Distinct rows, those of `first` in front; the same for the same input.
    """
    chosen = list(dict.fromkeys(first))[:count]
    if len(points) <= count:
        return chosen + [i for i in range(len(points)) if i not in set(chosen)]
    width = np.ptp(points, axis=0)
    places = np.ascontiguousarray(((points - points.min(axis=0)) / np.where(width > 0.0, width, 1.0)).T)
    if not chosen:
        chosen = [0]
    gap = np.full(len(points), np.inf)
    for row in chosen:
        gap = np.minimum(gap, _distances(places, row))
    gap[chosen] = -1.0  # also where designs coincide, none is chosen twice
    while len(chosen) < count:
        row = int(np.argmax(gap))
        chosen.append(row)
        gap = np.minimum(gap, _distances(places, row))
        gap[row] = -1.0
    return chosen


def _distances(places: FloatArray, column: int) -> FloatArray:
    """Squared distances of points, shape (k, n), from one of them."""
    return np.asarray(sum((coordinate - coordinate[column]) ** 2 for coordinate in places))
