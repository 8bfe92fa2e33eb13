"""Several objectives made one: goal attainment (3.24) and the power sum of C.5."""

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType

import numpy as np

from divideropt.models.base import FloatArray
from divideropt.problem.criteria import Objective


def goal_attainment(F: FloatArray, objectives: Sequence[Objective]) -> FloatArray:
    """Return max λ_i, λ_i = (F_i - F*_i)/F*_i · w_i, (3.24).

    Args:
        F: Objective values, shape (n, k).
        objectives: The objectives, each with a goal.

    Returns:
        Shape (n,); negative where every goal is met.
    """
    goals, weights = _goals_and_weights(objectives)
    return np.asarray(np.max((F - goals) / goals * weights, axis=1))


def power_sum(F: FloatArray, objectives: Sequence[Objective]) -> FloatArray:
    """Return Σ (F_i/F*_i)^(1 + (1 + w_i)/2), C.5.

    Args:
        F: Objective values, shape (n, k).
        objectives: The objectives, each with a goal.

    Returns:
        Shape (n,).
    """
    goals, weights = _goals_and_weights(objectives)
    return np.asarray(np.sum((F / goals) ** (1 + (1 + weights) / 2), axis=1))


Aggregate = Callable[[FloatArray, Sequence[Objective]], FloatArray]

AGGREGATES: Mapping[str, Aggregate] = MappingProxyType({"goal_attainment": goal_attainment, "power_sum": power_sum})
"""The aggregates by the name a campaign gives."""


def _goals_and_weights(objectives: Sequence[Objective]) -> tuple[FloatArray, FloatArray]:
    missing = [o.quantity.name for o in objectives if o.goal is None]
    if missing:
        raise ValueError(f"an aggregate needs a goal for every objective; {', '.join(missing)} has none")
    return np.array([o.goal for o in objectives], dtype=float), np.array([o.weight for o in objectives])
