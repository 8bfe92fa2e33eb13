"""The designs of a front that the figures draw, and those that the table lists."""

from collections.abc import Sequence

import numpy as np

from divideropt.analysis import spread
from divideropt.report.front import Design

MOST_DRAWN = 10_000
"""Designs of the front that the figures draw: beyond, the page grows by its ids, and brushes get slow."""

MOST_ROWS = 1000
"""Designs of the front in the page's table."""


def rows_drawn(front: Sequence[Design]) -> tuple[int, ...]:
    """Choose what is drawn: all rows, or else those of the table, the extremes, and an even spread of the rest.

    Args:
        front: In the table's order.

    Returns:
        Rows, ascending, `MOST_DRAWN` of them at the most.
    """
    if len(front) <= MOST_DRAWN:
        return tuple(range(len(front)))
    objectives = np.array([design.objectives for design in front])
    first = [*range(MOST_ROWS), *(int(row) for row in objectives.argmin(axis=0))]
    return tuple(sorted(spread(objectives, first, MOST_DRAWN)))
