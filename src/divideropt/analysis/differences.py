"""Slopes of a model's results at a design, from simulations of its neighbours, and what can be trusted of them."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from divideropt.models.base import FloatArray
from divideropt.problem import DesignSpace

STEP = 2e-3
"""Between neighbours, of a variable's range: the noise of the valve's slopes falls with a longer step, but more
neighbours fail (`docs/decisions/0013-kkt-residuals.md`)."""

NODES = 5
"""Designs on a line, the middle one included."""

LEAST_NODES = 3
"""So many of them give a slope, of second order."""


@dataclass(frozen=True)
class Slopes:
    """Slopes of m results over d variables, each variable in parts of its range.

    Attributes:
        gradients: Shape (m, d), of fourth order in the step where all neighbours could be simulated.
        jumps: How far the slope jumps within reach of the neighbours if there is a kink, shape (m, d). A kink makes
            third differences of a third of its jump times the step, or more; curvature makes none.
        errors: Standard deviation of the gradients, of the noise that fourth differences show, shape (m, d).
        failing: Whether there are neighbours below, and above, that could not be simulated, shape (2, d).
    """

    gradients: FloatArray
    jumps: FloatArray
    errors: FloatArray
    failing: NDArray[np.bool_]


def neighbours(design: FloatArray, space: DesignSpace) -> FloatArray:
    """Return the designs to be simulated for the slopes at one.

    Args:
        design: Shape (d,), in the variables' units.
        space: The box.

    Returns:
        Shape (4 d, d), all inside the box: four along each variable, shifted where a bound is near.
    """
    width = space.upper - space.lower
    lines = np.repeat(design[None], len(space) * (NODES - 1), axis=0)
    for i, offsets in enumerate(_offsets(design, space)):
        rows = slice(i * (NODES - 1), (i + 1) * (NODES - 1))
        lines[rows, i] += offsets[offsets != 0] * STEP * width[i]
    return space.clip(lines)


def slopes_at(
    design: FloatArray, space: DesignSpace, middle: FloatArray, around: FloatArray, usable: NDArray[np.bool_]
) -> Slopes | None:
    """Return the slopes at a design.

    Args:
        design: Shape (d,).
        space: The box.
        middle: Results there, shape (m,).
        around: Results of its `neighbours`, shape (4 d, m).
        usable: Which of these could be simulated, shape (4 d,).

    Returns:
        The slopes; None where too few neighbours along a variable could be simulated, or no line tells the noise.
    """
    d, m = len(space), len(middle)
    gradients, jumps, failing = np.empty((m, d)), np.zeros((m, d)), np.zeros((2, d), dtype=bool)
    lengths, noises = np.empty(d), []
    for i, offsets in enumerate(_offsets(design, space)):
        rows = slice(i * (NODES - 1), (i + 1) * (NODES - 1))
        place = int(np.flatnonzero(offsets == 0)[0])
        works = np.insert(usable[rows], place, True)
        values = np.insert(around[rows], place, middle, axis=0)
        failing[:, i] = (~works[:place]).any(), (~works[place:]).any()
        begin, end = _unbroken(works, place)
        if end - begin < LEAST_NODES:
            return None
        weights = _weights(tuple(offsets[begin:end].tolist()))
        gradients[:, i] = weights @ values[begin:end] / STEP
        lengths[i] = np.linalg.norm(weights) / STEP
        thirds = np.diff(values[begin:end], 3, axis=0)
        jumps[:, i] = np.abs(thirds).max(axis=0, initial=0.0) / STEP
        if end - begin == NODES:
            noises.append(np.diff(thirds, axis=0)[0])
    if not noises:
        return None
    noise = np.sqrt(np.mean(np.square(noises), axis=0) / _FOURTH)
    return Slopes(gradients, jumps, np.outer(noise, lengths), failing)


_FOURTH = 70.0
"""Variance of a fourth difference of independent values of variance 1: (2 k)!/(k!)^2 (Moré and Wild 2011, (2.2))."""


def _offsets(design: FloatArray, space: DesignSpace) -> NDArray[np.int64]:
    """Places on each variable's line, in steps, shape (d, 5): in the middle, or shifted to stay inside the box."""
    width = space.upper - space.lower
    below = np.floor((design - space.lower) / width / STEP).astype(np.int64)
    above = np.floor((space.upper - design) / width / STEP).astype(np.int64)
    half = NODES // 2
    first = np.maximum(np.minimum(-half, above - NODES + 1), -below)
    return np.asarray(first[:, None] + np.arange(NODES))


def _unbroken(works: NDArray[np.bool_], place: int) -> tuple[int, int]:
    """The longest stretch around a place in which all works, as begin and end."""
    begin, end = place, place + 1
    while begin > 0 and works[begin - 1]:
        begin -= 1
    while end < len(works) and works[end]:
        end += 1
    return begin, end


@cache
def _weights(offsets: tuple[int, ...]) -> FloatArray:
    """Weights of values at whole places in the derivative at 0 of the polynomial through them."""
    powers = np.vander(np.array(offsets, dtype=float), increasing=True).T
    return np.asarray(np.linalg.solve(powers, np.eye(len(offsets))[1]))
