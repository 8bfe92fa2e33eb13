"""Every help to choose a design that can be had of a front, in one."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from divideropt.analysis.decision import Goals, achievement, bulge, knee_points, meeting_goals, pseudo_weights
from divideropt.analysis.scale import Scale
from divideropt.models.base import FloatArray
from divideropt.problem import Objective

MOST_KNEES = 5
"""Knees that are offered, the deepest first: more are no choice."""


@dataclass(frozen=True)
class Choice:
    """Designs of a front that are worth a look, by their rows.

    Attributes:
        knees: Its knees, the deepest first, at most `MOST_KNEES`.
        depths: How deep each is, as `bulge` measures.
        goals: Which designs meet the goals, or which comes nearest and what it lacks.
        wished: The design of least `achievement` for the goals, in shares of the front's extents; None unless every
            objective has a goal.
        weights: Pseudo-weights of every design, shape (n, k).
    """

    knees: tuple[int, ...]
    depths: tuple[float, ...]
    goals: Goals
    wished: int | None
    weights: FloatArray

    @property
    def reasons(self) -> Mapping[int, tuple[str, ...]]:
        """Why each design is worth a look, by its row, in words."""
        found: dict[int, tuple[str, ...]] = {}

        def add(row: int | None, why: str) -> None:
            if row is not None:
                found[row] = (*found.get(row, ()), why)

        for place, row in enumerate(self.knees, 1):
            add(row, "knee" if len(self.knees) == 1 else f"knee {place}")
        add(self.goals.nearest, "farthest within the goals" if len(self.goals.meeting) else "nearest to the goals")
        add(self.wished, "best by achievement")
        return found


def choose(F: FloatArray, objectives: Sequence[Objective]) -> Choice:
    """Look through a front.

    Args:
        F: Its points, shape (n, k), to be minimised, n at least 1; those of the `region` that counts.
        objectives: With goals or not.

    Returns:
        What was found.
    """
    knees = knee_points(F)[:MOST_KNEES]
    goals = np.array([np.nan if o.goal is None else o.goal for o in objectives])
    wished = None if np.isnan(goals).any() else int(achievement(F, goals, Scale.of(F).divisor).argmin())
    depths = tuple(bulge(F)[knees].tolist())
    return Choice(tuple(knees), depths, meeting_goals(F, goals), wished, pseudo_weights(F))
