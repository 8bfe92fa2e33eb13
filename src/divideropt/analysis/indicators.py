"""Figures that say how good a set of designs is."""

from collections.abc import Sequence

import moocore
import numpy as np

from divideropt.analysis.fronts import nondominated
from divideropt.models.base import FloatArray
from divideropt.problem import AGGREGATES, Problem, Told


def hypervolume(F: FloatArray, reference: FloatArray) -> float:
    """Return the part of the box between the origin and the reference point that a set dominates.

    Args:
        F: Objective values, shape (n, k), to be minimised, none negative.
        reference: The reference point, shape (k,), positive.

    Returns:
        Between 0 and 1.
    """
    if len(F) == 0:
        return 0.0
    return float(moocore.hypervolume(F / reference, ref=np.ones(len(reference))))


def hypervolume_history(told: Told, reference: FloatArray, marks: Sequence[int]) -> list[float]:
    """Return the hypervolume of the feasible designs among the first m evaluations, for each mark m."""
    front = np.empty((0, told.F.shape[1]))
    values, seen = [], 0
    for mark in marks:
        fresh = told.F[seen:mark][told.feasible[seen:mark]]
        front = np.concatenate([front, fresh])
        front = front[nondominated(front)]
        values.append(hypervolume(front, reference))
        seen = mark
    return values


def best_attainment(told: Told, problem: Problem) -> tuple[int, float] | None:
    """Find the feasible design with the least max λ_i of (3.24).

    Args:
        told: Any number of designs.
        problem: Whose objectives have goals or not.

    Returns:
        Its row and its value, or None where no design is feasible or an objective has no goal.
    """
    rows = np.flatnonzero(told.feasible)
    if len(rows) == 0 or any(o.goal is None for o in problem.objectives):
        return None
    values = AGGREGATES["goal_attainment"](told.F[rows], problem.objectives)
    best = int(np.argmin(values))
    return int(rows[best]), float(values[best])
