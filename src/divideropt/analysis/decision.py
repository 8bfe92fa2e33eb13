"""Choosing a design of a front: knees, pseudo-weights, a reference point, goals."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from divideropt.analysis.scale import Scale
from divideropt.models.base import FloatArray

KNEE_RADIUS = 0.2
"""Within it, in shares of the front's extents, designs are in one bulge of the front, and only one is its knee."""

LEAST_BULGE = 0.05
"""A front that bulges by less, as a share of what the deepest bulge possible has, has no knee there."""

AUGMENTATION = 1e-3
"""ρ: what the sum counts beside the maximum in `achievement`; it breaks ties for the design that wastes nothing."""


def bulge(F: FloatArray) -> FloatArray:
    """Say how far each point lies on the good side of the plane between a front's extremes.

    The front is scaled between its ideal and its nadir point, 0 to 1; the plane is Σ z_i = 1, through the ends of the
    axes. With two objectives it is the line through the two extremes, and the distance that of Das (1999). With more,
    a plane through the individual minima is often not defined, since one design may be best in two objectives; this
    one always is. An objective in which all points are equal is left out.

    Args:
        F: Non-dominated points, shape (n, k), to be minimised.

    Returns:
        Shape (n,): the distance as a share of the ideal point's, which has 1; 0 on the plane, negative beyond it, and
        0 throughout where fewer than two objectives differ.
    """
    if len(F) == 0:
        return np.zeros(0)
    scale = Scale.of(F)
    if (scale.extent > 0.0).sum() < 2:
        return np.zeros(len(F))
    return np.asarray(1.0 - scale.apply(F).sum(axis=1))


def knee_points(F: FloatArray) -> list[int]:
    """Find the knees of a front: where it bulges most towards the ideal point.

    A knee is a point with a `bulge` of at least `LEAST_BULGE` and larger than that of every other within
    `KNEE_RADIUS` in every objective, in shares of the front's extents; the first of equals. A straight front
    has none, nor has one that bulges away from the ideal point.

    Args:
        F: Non-dominated points, shape (n, k), to be minimised; equal ones may be among them.

    Returns:
        Their rows, the deepest first.
    """
    depth = bulge(F)
    if len(F) == 0:
        return []
    scaled = Scale.of(F).apply(F)
    order = np.argsort(-depth, kind="stable")
    place = np.empty(len(F), dtype=np.int64)
    place[order] = np.arange(len(F))
    return [
        int(row)
        for row in order[depth[order] >= LEAST_BULGE]
        if place[_near(scaled, scaled[row])].min() == place[row]
    ]


def pseudo_weights(F: FloatArray) -> FloatArray:
    """Return the pseudo-weights of a front's points (Deb 2001, section 8.3.2): what each says of who would choose it.

    w_i = (f_i,max - f_i)/(f_i,max - f_i,min), divided by their sum.

    Args:
        F: Non-dominated points, shape (n, k), to be minimised.

    Returns:
        Shape (n, k), each row between 0 and 1 and of sum 1: the nearer to an objective's least value, the larger its
        share. An objective in which all points are equal has 0; where that leaves nothing, all have the same.
    """
    if len(F) == 0:
        return np.empty(F.shape)
    scale = Scale.of(F)
    distance = np.where(scale.extent > 0.0, 1.0 - scale.apply(F), 0.0)
    total = distance.sum(axis=1, keepdims=True)
    return np.where(total > 0.0, distance / np.where(total > 0.0, total, 1.0), 1.0 / F.shape[1])


def achievement(F: FloatArray, aspiration: FloatArray, scale: FloatArray) -> FloatArray:
    """Return how far points miss what is aspired to: max_i d_i + ρ Σ d_i, d = (F - aspiration)/scale.

    Wierzbicki's achievement function (1980). Its least over a front is the front's answer to the aspiration,
    reachable or not: no other point is better in every objective. Unlike goal attainment it needs no goal to be met,
    and goes on beyond one that is.

    Args:
        F: Points, shape (n, k), to be minimised.
        aspiration: The values wished for, shape (k,), in the objectives' units.
        scale: What is taken for one, shape (k,), above 0: a front's extents, say.

    Returns:
        Shape (n,); negative where a point is better than the aspiration in every objective.
    """
    distance = (F - aspiration) / scale
    return np.asarray(distance.max(axis=1) + AUGMENTATION * distance.sum(axis=1))


@dataclass(frozen=True)
class Goals:
    """Which points of a front meet the goals.

    Attributes:
        meeting: Rows of the points that meet every goal, in their order.
        nearest: The row whose largest lack is least; None where there is no point or no goal.
        lacks: What it lacks of each goal, shape (k,), in the objectives' units; 0 where met or not given.
    """

    meeting: NDArray[np.int64]
    nearest: int | None
    lacks: FloatArray


def meeting_goals(F: FloatArray, goals: FloatArray) -> Goals:
    """Find the points that meet every goal, and the one nearest to that.

    Args:
        F: Points, shape (n, k), to be minimised.
        goals: Shape (k,), in the objectives' units; NaN where an objective has none. None is 0.

    Returns:
        What was found. A lack is measured as a share of its goal; of equals the first is the nearest.
    """
    given = ~np.isnan(goals)
    if not given.any() or len(F) == 0:
        return Goals(np.zeros(0, dtype=np.int64), None, np.zeros(len(goals)))
    excess = F[:, given] - goals[given]
    shares = (excess / np.abs(goals[given])).max(axis=1)
    nearest = int(shares.argmin())
    lacks = np.zeros(len(goals))
    lacks[given] = np.maximum(excess[nearest], 0.0)
    return Goals(np.flatnonzero((excess <= 0.0).all(axis=1)), nearest, lacks)


def _near(points: FloatArray, centre: FloatArray) -> NDArray[np.bool_]:
    return np.asarray((np.abs(points - centre) <= KNEE_RADIUS).all(axis=1))
