"""Slopes of a model's results at a design, from simulations of its neighbours, and what can be trusted of them."""

from dataclasses import dataclass
from functools import cache

import numpy as np
from numpy.typing import NDArray

from divideropt.models.base import FloatArray
from divideropt.problem import DesignSpace

STEP = 1e-3
"""Between neighbours, of a variable's range. With a longer one more of the valve's neighbours fail or lie beyond a
kink, and more bounds count as reached; the noise is small enough (`docs/decisions/0013-kkt-residuals.md`)."""

CLOSE = 1 / 64
"""Of that step: between neighbours on one more line, so close together that a kink or a curve is nothing there, while
noise is what it was."""

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
        noise: Standard deviation of the results from a straight line through close neighbours, shape (m,); 0 where
            one of these failed. It misses noise that comes in steps, which the fourth differences show.
        failing: Whether there are neighbours below, and above, that could not be simulated, shape (2, d).
    """

    gradients: FloatArray
    jumps: FloatArray
    errors: FloatArray
    noise: FloatArray
    failing: NDArray[np.bool_]


def neighbours(design: FloatArray, space: DesignSpace, step: float = STEP) -> FloatArray:
    """Return the designs to be simulated for the slopes at one.

    Args:
        design: Shape (d,), in the variables' units.
        space: The box.
        step: Between neighbours, of a variable's range.

    Returns:
        Shape (4 d + 4, d), all inside the box: four along each variable, shifted where a bound is near, and four
        close together, towards the middle of the box in every variable.
    """
    width = space.upper - space.lower
    lines = np.repeat(design[None], (len(space) + 1) * (NODES - 1), axis=0)
    for i, offsets in enumerate(_offsets(design, space, step)):
        rows = slice(i * (NODES - 1), (i + 1) * (NODES - 1))
        lines[rows, i] += offsets[offsets != 0] * step * width[i]
    inwards = np.where(design < (space.lower + space.upper) / 2, width, -width)
    lines[1 - NODES :] += np.arange(1, NODES)[:, None] * CLOSE * step * inwards
    return space.clip(lines)


def slopes_at(
    design: FloatArray,
    space: DesignSpace,
    middle: FloatArray,
    around: FloatArray,
    usable: NDArray[np.bool_],
    step: float = STEP,
) -> Slopes | None:
    """Return the slopes at a design.

    Args:
        design: Shape (d,).
        space: The box.
        middle: Results there, shape (m,).
        around: Results of its `neighbours`, shape (4 d + 4, m).
        usable: Which of these could be simulated, shape (4 d + 4,).
        step: With which they were made.

    Returns:
        The slopes; None where too few neighbours along a variable could be simulated, or no line tells the noise.
    """
    d, m = len(space), len(middle)
    gradients, jumps, failing = np.empty((m, d)), np.zeros((m, d)), np.zeros((2, d), dtype=bool)
    lengths, noises = np.empty(d), []
    for i, offsets in enumerate(_offsets(design, space, step)):
        rows = slice(i * (NODES - 1), (i + 1) * (NODES - 1))
        place = int(np.flatnonzero(offsets == 0)[0])
        works = np.insert(usable[rows], place, True)
        values = np.insert(around[rows], place, middle, axis=0)
        failing[:, i] = (~works[:place]).any(), (~works[place:]).any()
        begin, end = _unbroken(works, place)
        if end - begin < LEAST_NODES:
            return None
        weights = _weights(tuple(offsets[begin:end].tolist()))
        gradients[:, i] = weights @ values[begin:end] / step
        lengths[i] = np.linalg.norm(weights) / step
        thirds = np.diff(values[begin:end], 3, axis=0)
        jumps[:, i] = np.abs(thirds).max(axis=0, initial=0.0) / step
        if end - begin == NODES:
            noises.append(np.diff(thirds, axis=0)[0])
    if not noises:
        return None
    noise = np.sqrt(np.mean(np.square(noises), axis=0) / _FOURTH)
    close = np.vstack([middle, around[1 - NODES :]])
    spread = _spread(close) if usable[1 - NODES :].all() else np.zeros(m)
    return Slopes(gradients, jumps, np.outer(noise, lengths), spread, failing)


_FOURTH = 70.0
"""Variance of a fourth difference of independent values of variance 1: (2 k)!/(k!)^2, from which Moré and Wild
(Estimating computational noise, 2011) take a computation's noise."""


def _spread(values: FloatArray) -> FloatArray:
    """Standard deviation of evenly spaced values, shape (n, m), from a straight line through them, shape (m,)."""
    line = np.vander(np.arange(len(values)), 2)
    rest = values - line @ np.linalg.lstsq(line, values)[0]
    return np.asarray(np.sqrt((rest**2).sum(axis=0) / (len(values) - 2)))


def _offsets(design: FloatArray, space: DesignSpace, step: float) -> NDArray[np.int64]:
    """Places on each variable's line, in steps, shape (d, 5): in the middle, or shifted to stay inside the box."""
    width = space.upper - space.lower
    below = np.floor((design - space.lower) / width / step).astype(np.int64)
    above = np.floor((space.upper - design) / width / step).astype(np.int64)
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
