"""The designs of a report's front that are worth a look first, and why."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from divideropt.analysis import choose, region
from divideropt.models.base import FloatArray
from divideropt.problem import Objective
from divideropt.report.front import Design

VOUCHED = "best within validity"
"""Why a design is worth a look that the model vouches for, where it does not for all."""


@dataclass(frozen=True)
class Candidate:
    """A design: why it is worth a look, and its pseudo-weights, one an objective."""

    design: Design
    reasons: tuple[str, ...]
    weights: tuple[float, ...]


@dataclass(frozen=True)
class Choosing:
    """What there is to choose from.

    Attributes:
        candidates: The designs worth a look: knees, then what the goals say, then what validity says.
        considered: How many designs there are within the reference point, as far as there is one.
        knees: How many knees there are among the candidates.
        goals: Whether an objective has a goal.
        wished: Whether every objective has one.
        meeting: How many designs meet every goal.
        lacks: What the nearest to the goals lacks of each, in the objectives' units; 0 where met or not given.
    """

    candidates: tuple[Candidate, ...]
    considered: int
    knees: int
    goals: bool
    wished: bool
    meeting: int
    lacks: tuple[float, ...]


def choosing_of(
    front: Sequence[Design], objectives: Sequence[Objective], reference: FloatArray | None
) -> Choosing | None:
    """Look through a front.

    Args:
        front: Its designs, the best by goal attainment first.
        objectives: With goals or not.
        reference: The reference point, shape (k,), or None.

    Returns:
        What was found; None where there is no front, or one objective only, which leaves no choice.
    """
    if not front or len(objectives) < 2:
        return None
    values = np.array([design.objectives for design in front])
    rows = np.flatnonzero(region(values, reference))
    found = choose(values[rows], objectives)
    reasons = dict(found.reasons)
    vouched = _vouched([front[row] for row in rows.tolist()])
    if vouched is not None:
        reasons[vouched] = (*reasons.get(vouched, ()), VOUCHED)
    candidates = tuple(
        Candidate(front[rows[row]], why, tuple(found.weights[row].tolist())) for row, why in reasons.items()
    )
    goals = found.goals
    return Choosing(
        candidates,
        len(rows),
        len(found.knees),
        goals.nearest is not None,
        found.wished is not None,
        len(goals.meeting),
        tuple(goals.lacks.tolist()),
    )


def _vouched(designs: Sequence[Design]) -> int | None:
    """The place of the best by goal attainment that the model vouches for; None where it does for all or for none."""
    if all(design.valid is not False for design in designs):
        return None
    known = [i for i, design in enumerate(designs) if design.valid and design.attainment is not None]
    return known[0] if known else None
