"""Fewer points for the same curve: those that a straight line would miss by a visible distance (Douglas, Peucker)."""

import numpy as np

from divideropt.models.base import FloatArray

MISS = 0.15
"""How far a curve may be off [px]."""

PLOT = (312.0, 264.0)
"""Width and height of a panel's axes [px]."""


def thinned(
    x: FloatArray, y: FloatArray, x_range: tuple[float, float], y_range: tuple[float, float]
) -> tuple[FloatArray, FloatArray]:
    """Leave out the points that do not show.

    Args:
        x: Rising, shape (n,).
        y: Finite, shape (n,).
        x_range: Of the axis.
        y_range: Likewise.

    Returns:
        The same curve to within `MISS`, its first and last point among the rest.
    """
    across = (x - x_range[0]) / (x_range[1] - x_range[0]) * PLOT[0]
    up = (y - y_range[0]) / (y_range[1] - y_range[0]) * PLOT[1]
    kept = np.zeros(len(x), dtype=bool)
    kept[[0, -1]] = True
    stretches = [(0, len(x) - 1)]
    while stretches:
        first, last = stretches.pop()
        if last - first < 2:
            continue
        dx, dy = across[last] - across[first], up[last] - up[first]
        inner = slice(first + 1, last)
        off = np.abs(dx * (up[inner] - up[first]) - dy * (across[inner] - across[first]))
        length = float(np.hypot(dx, dy))
        if length == 0.0:
            off, length = np.hypot(across[inner] - across[first], up[inner] - up[first]), 1.0
        farthest = first + 1 + int(off.argmax())
        if off[farthest - first - 1] > MISS * length:
            kept[farthest] = True
            stretches += [(first, farthest), (farthest, last)]
    return x[kept], y[kept]
