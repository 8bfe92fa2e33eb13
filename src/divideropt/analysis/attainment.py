"""Attainment surfaces: what so many of several runs reach (Fonseca, Guerreiro, López-Ibáñez and Paquete 2011)."""

from collections.abc import Sequence

import moocore
import numpy as np

from divideropt.models.base import FloatArray

DIMENSIONS = (2, 3)
"""Numbers of objectives for which moocore has them."""


def attainment_surface(fronts: Sequence[FloatArray], runs: int) -> FloatArray:
    """Return the points from which on at least so many of several fronts are reached.

    Args:
        fronts: Objective values of each run's front, shape (n_i, k) with k 2 or 3, to be minimised; none, where a run
            found nothing.
        runs: How many of the runs, from 1 (the best that any reached) to all of them (the worst).

    Returns:
        Shape (n, k), non-dominated: every point that at least so many runs weakly dominate is weakly dominated by one
        of these. Empty where fewer runs found anything.

    Raises:
        ValueError: No run, more or fewer runs than there are, or another number of objectives.
    """
    if not 1 <= runs <= len(fronts):
        raise ValueError(f"a surface of {runs} of {len(fronts)} runs; ask for 1 to all of them")
    dimension = fronts[0].shape[1]
    if dimension not in DIMENSIONS:
        raise ValueError(f"{dimension} objectives; attainment surfaces are computed for 2 and 3")
    found = [front for front in fronts if len(front)]
    if len(found) < runs:
        return np.empty((0, dimension))
    run = np.repeat(np.arange(len(found)), [len(front) for front in found])
    surface = moocore.eaf(np.concatenate(found), sets=run, percentiles=[100.0 * runs / len(found)])
    return np.asarray(surface[:, :dimension])


def median_surface(fronts: Sequence[FloatArray]) -> FloatArray:
    """Return what at least half of the runs reach, shape (n, k); otherwise as `attainment_surface`."""
    return attainment_surface(fronts, (len(fronts) + 1) // 2)


def worst_surface(fronts: Sequence[FloatArray]) -> FloatArray:
    """Return what every run reaches, shape (n, k); otherwise as `attainment_surface`."""
    return attainment_surface(fronts, len(fronts))
