"""Elementary effects: what a step of one variable does to a quantity; Morris (1991), Campolongo et al. (2007)."""

import numpy as np

from divideropt.analysis.pick_freeze import NORMAL_95
from divideropt.analysis.treatments import Treated
from divideropt.models.base import FloatArray
from divideropt.problem import DesignSpace

RESAMPLES = 1000
"""Bootstrap resamples of μ*: ten times SALib's default, since they cost nothing."""

LEAST_EFFECTS = 4
"""Elementary effects of a variable below which nothing is said of it."""

SEED = 1
"""Of the resamples."""


def ways_of(designs: FloatArray, space: DesignSpace) -> FloatArray:
    """Read the steps of trajectories off their designs.

    Args:
        designs: Trajectory by trajectory of d + 1 designs, shape (r (d + 1), d).
        space: The variables and their ranges.

    Returns:
        Each step in parts of the variables' ranges, shape (r, d, d): trajectory, step, variable.

    Raises:
        ValueError: There is no trajectory, or one does not move each variable once.
    """
    if not len(designs):
        raise ValueError("no trajectory is complete; sample more")
    shares = ((designs - space.lower) / (space.upper - space.lower)).reshape(-1, len(space) + 1, len(space))
    ways = np.diff(shares, axis=1)
    if (np.count_nonzero(ways, axis=1) != 1).any() or (np.count_nonzero(ways, axis=2) != 1).any():
        raise ValueError("a trajectory does not move each variable once, one a step: no Morris sample")
    return np.asarray(ways)


def effects_of(item: Treated, ways: FloatArray) -> FloatArray:
    """Divide each step's change of a quantity by its way.

    Args:
        item: The quantity, and which designs count.
        ways: The steps; see `ways_of`.

    Returns:
        The elementary effects by trajectory and variable, in the quantity's unit for a way of one range; NaN where an
        end of the step does not count, shape (r, d).
    """
    values = np.where(item.kept, item.values, np.nan).reshape(len(ways), -1)
    moved = np.abs(ways).argmax(axis=2)
    effects = np.diff(values, axis=1) / np.take_along_axis(ways, moved[:, :, None], axis=2)[:, :, 0]
    found = np.empty_like(effects)
    np.put_along_axis(found, moved, effects, axis=1)
    return found


def summary_of(effects: FloatArray) -> tuple[float, float, float, float]:
    """Summarise the effects of one variable, shape (r,): μ, μ*, σ, and half the width of the interval of μ*.

    All are NaN of too few effects.
    """
    if len(effects) < LEAST_EFFECTS:
        return np.nan, np.nan, np.nan, np.nan
    drawn = np.random.default_rng(SEED).integers(len(effects), size=(RESAMPLES, len(effects)))
    half = NORMAL_95 * np.abs(effects)[drawn].mean(axis=1).std(ddof=1)
    return float(effects.mean()), float(np.abs(effects).mean()), float(effects.std(ddof=1)), float(half)
