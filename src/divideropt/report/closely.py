"""The designs that a report shows closely: with step responses, and with dimension sheets."""

from collections.abc import Sequence

import numpy as np

from divideropt.analysis import spread
from divideropt.report.front import Design

MOST_CLOSELY = 200
"""Designs; each costs a simulation, those of its sheet, and some 4 kB of the page."""

BEST_CLOSELY = 20
"""How many of those are the best by goal attainment."""


def shown_closely(front: Sequence[Design], best: Sequence[Design]) -> list[Design]:
    """Choose the best of each strategy, the best by attainment, the extremes of each objective, then an even spread.

    Args:
        front: The combined front, best first.
        best: The best of each strategy, on the front or not.
    """
    objectives = np.array([design.objectives for design in front])
    first = list(range(min(BEST_CLOSELY, len(front)))) if front and front[0].attainment is not None else []
    if front:
        first += [int(row) for row in objectives.argmin(axis=0)]
        best = [*best, *(front[row] for row in spread(objectives, first, MOST_CLOSELY))]
    return list({design.design_id: design for design in best}.values())[:MOST_CLOSELY]
