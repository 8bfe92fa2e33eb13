"""Directions in the space of objectives: the weights w of goal-attainment problems."""

from collections.abc import Iterator
from math import comb

import numpy as np
import scipy

from divideropt.models.base import FloatArray

SMALLEST_WEIGHT = 1e-3
"""Floor of a direction's components: a zero would ignore its objective altogether."""

EDGE_SHARE = 0.25
"""Share of the drawn directions that ask nothing of one objective: there lie the rim of a front and its extremes."""

CORNER_POWER = 1.5
"""Drawn components are raised to this power: fronts end in corners, where small weights differ by factors."""


def reference_directions(objectives: int, most: int) -> FloatArray:
    """Spread directions evenly over the unit simplex, each next to the one before (Das and Dennis 1998).

    Args:
        objectives: Number of objectives.
        most: Most directions.

    Returns:
        The largest Das–Dennis set of at most `most`, along a boustrophedon path, shape (n, objectives).
    """
    parts = 1
    while objectives > 1 and comb(parts + objectives, objectives - 1) <= most:
        parts += 1
    lattice = np.array(list(_lattice(objectives, parts)), dtype=float) / parts
    return np.asarray(np.maximum(lattice, SMALLEST_WEIGHT))


class DirectionSequence:
    """Draws directions that fill the unit simplex evenly however many are drawn: a scrambled Sobol sequence."""

    def __init__(self, objectives: int, random: np.random.Generator) -> None:
        """Begin a sequence.

        Args:
            objectives: Number of objectives.
            random: Scrambles the sequence, and picks the objectives of which an edge asks nothing.
        """
        self._objectives, self._random = objectives, random
        self._sequence = scipy.stats.qmc.Sobol(objectives - 1, rng=random) if objectives > 1 else None

    def draw(self, count: int) -> FloatArray:
        """Return the next directions, shape (count, objectives); the count is a power of two."""
        if self._sequence is None:
            return np.ones((count, 1))
        directions = _on_simplex(self._sequence.random(count)) ** CORNER_POWER
        edges = np.flatnonzero(self._random.random(count) < EDGE_SHARE)
        directions[edges, self._random.integers(self._objectives, size=len(edges))] = 0.0
        directions /= directions.sum(axis=1, keepdims=True)
        return np.asarray(np.maximum(directions, SMALLEST_WEIGHT))


def _on_simplex(points: FloatArray) -> FloatArray:
    """Map the unit cube, shape (n, k - 1), to the simplex, shape (n, k), equal volumes to equal areas."""
    left = np.ones(len(points))
    parts = []
    for i, column in enumerate(points.T):
        share = 1.0 - (1.0 - column) ** (1.0 / (points.shape[1] - i))
        parts.append(left * share)
        left = left - parts[-1]
    return np.column_stack([*parts, left])


def _lattice(dimension: int, total: int) -> Iterator[tuple[int, ...]]:
    if dimension == 1:
        yield (total,)
        return
    for first in range(total + 1):
        rest = list(_lattice(dimension - 1, total - first))
        yield from ((first, *others) for others in (rest if first % 2 == 0 else reversed(rest)))
