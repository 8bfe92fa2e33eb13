"""Figures that say how good a set of designs is."""

from collections.abc import Sequence

import moocore
import numpy as np

from divideropt.analysis.fronts import nondominated
from divideropt.models.base import FloatArray
from divideropt.problem import AGGREGATES, Objective, Problem, Told


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


def hypervolume_contributions(F: FloatArray, reference: FloatArray) -> FloatArray:
    """Return what of the hypervolume each point alone dominates.

    Args:
        F: As for `hypervolume`.
        reference: As for `hypervolume`.

    Returns:
        Shape (n,): by how much the hypervolume of the non-dominated falls without the point; 0 for each of equals,
        and for a dominated point.
    """
    if len(F) == 0:
        return np.zeros(0)
    scaled = F / reference
    if F.shape[1] == 1:  # moocore's needs two
        scaled = np.column_stack([scaled, np.zeros(len(F))])
    return np.asarray(moocore.hv_contributions(scaled, ref=np.ones(scaled.shape[1])))


def igd_plus(F: FloatArray, front: FloatArray) -> float:
    """Return IGD+ (Ishibuchi et al. 2015): how far, on average, a point of a front is from what a set dominates.

    Args:
        F: Objective values, shape (n, k), to be minimised, in scales that may be added, as `Scale`
            makes them.
        front: What they are measured against, shape (m, k), m at least 1.

    Returns:
        0 where the set is at least as good everywhere; infinite for an empty set.
    """
    return float(moocore.igd_plus(F, ref=front)) if len(F) else np.inf


def additive_epsilon(F: FloatArray, front: FloatArray) -> float:
    """Return the least ε by which a set, moved down in every objective, would dominate a front (Zitzler et al. 2003).

    Args:
        F: As for `igd_plus`.
        front: As for `igd_plus`.

    Returns:
        At most 0 where the set is at least as good everywhere; infinite for an empty set.
    """
    return float(moocore.epsilon_additive(F, ref=front)) if len(F) else np.inf


def multiplicative_epsilon(F: FloatArray, front: FloatArray) -> float:
    """Return the least factor by which a set, divided by it, would dominate a front; units do not matter.

    Args:
        F: Objective values, shape (n, k), to be minimised, all above 0.
        front: As for `igd_plus`, all above 0.

    Returns:
        At most 1 where the set is at least as good everywhere; infinite for an empty set.

    Raises:
        ValueError: A value is not above 0.
    """
    return float(moocore.epsilon_mult(F, ref=front)) if len(F) else np.inf


def hypervolume_history(told: Told, reference: FloatArray, marks: Sequence[int]) -> list[float]:
    """Return the hypervolume of the feasible designs among the first m evaluations, for each mark m."""
    front = np.empty((0, told.F.shape[1]))
    values, seen, feasible = [], 0, told.feasible
    for mark in marks:
        fresh = told.F[seen:mark][feasible[seen:mark]]
        front = np.concatenate([front, fresh])
        front = front[nondominated(front)]
        values.append(hypervolume(front, reference))
        seen = mark
    return values


def attainment_history(told: Told, objectives: Sequence[Objective], marks: Sequence[int]) -> list[float]:
    """Return the least max λ_i of (3.24) of the feasible designs among the first m evaluations, for each mark m.

    Args:
        told: All of a run; what is between two marks is looked at once, so that a long run costs no memory.
        objectives: Each with a goal.
        marks: Not falling.

    Returns:
        A value a mark, infinite before the first feasible design.
    """
    values, best, seen, feasible = [], np.inf, 0, told.feasible
    for mark in marks:
        fresh = told.F[seen:mark][feasible[seen:mark]]
        best = min(best, float(AGGREGATES["goal_attainment"](fresh, objectives).min(initial=np.inf)))
        values.append(best)
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
