"""How near a front comes to goals in every direction, which is where its users look and hypervolume does not."""

import numpy as np

from divideropt.models.base import FloatArray

CHUNK = 2**22
"""Numbers held at a time."""


def reached(F: FloatArray, directions: FloatArray, ideal: FloatArray, scale: FloatArray) -> FloatArray:
    """Return, for each direction w, the least λ that a front reaches: min over its points of max_i z_i/w_i.

    z = (F - ideal)/scale; λ is Gembicki's γ (1974) with the ideal point for goals and w for weights.

    Args:
        F: Objective values, shape (n, k), to be minimised.
        directions: Shape (m, k), every component above 0; `divideropt.strategies.reference_directions` spreads them.
        ideal: Shape (k,), in the objectives' units.
        scale: What is taken for one, shape (k,), above 0, in the objectives' units.

    Returns:
        Shape (m,); infinite where there is no point.
    """
    scaled = (F - ideal) / scale
    best = np.full(len(directions), np.inf)
    rows = max(1, CHUNK // max(1, directions.size))
    for begin in range(0, len(scaled), rows):
        part = scaled[begin : begin + rows, None, :] / directions
        best = np.minimum(best, part.max(axis=2).min(axis=0))
    return best


def gaps(found: FloatArray, best: FloatArray) -> FloatArray:
    """Return by what part each λ is above the best known, shape (m,).

    Args:
        found: λ reached, shape (m,).
        best: The least λ known of each direction, shape (m,), none negative.

    Returns:
        found/best - 1; 0 where both are 0, infinite where only the best is.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        share = found / best - 1.0
    return np.asarray(np.where(found == best, 0.0, share))
