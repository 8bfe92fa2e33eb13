"""Few instead of many: points that keep a curve's shape, and designs spread evenly along a front."""

import heapq
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from divideropt.models.base import FloatArray


def thin(times: FloatArray, values: FloatArray, count: int, tolerance: float) -> NDArray[np.intp]:
    """Choose the points of a polyline that keep its shape, most where it bends most (Ramer, Douglas, Peucker).

    Args:
        times: Shape (m,), not decreasing.
        values: Curves over them, shape (m, k), each scaled to a size of 1.
        count: Most points to keep, at least 2.
        tolerance: Deviation of the kept polyline at which no further point is needed.

    Returns:
        Indices in order, the first and the last always among them.
    """
    last = len(times) - 1
    kept = {0, last}
    waiting = [_worst(times, values, 0, last)]
    while waiting and len(kept) < count:
        deviation, begin, middle, end = heapq.heappop(waiting)
        if -deviation <= tolerance:
            break
        kept.add(middle)
        for part in ((begin, middle), (middle, end)):
            if part[1] - part[0] > 1:
                heapq.heappush(waiting, _worst(times, values, *part))
    return np.array(sorted(kept), dtype=np.intp)


def spread(points: FloatArray, first: Sequence[int], count: int) -> list[int]:
    """Choose points far from each other: after the first ones, always the one farthest from all chosen.

    Args:
        points: Shape (n, k).
        first: Rows that are chosen anyway.
        count: How many rows to choose in all.

    Returns:
        Distinct rows, those of `first` in front; the same for the same input.
    """
    chosen = list(dict.fromkeys(first))[:count]
    if len(points) <= count:
        return chosen + [i for i in range(len(points)) if i not in set(chosen)]
    width = np.ptp(points, axis=0)
    places = np.ascontiguousarray(((points - points.min(axis=0)) / np.where(width > 0.0, width, 1.0)).T)
    if not chosen:
        chosen = [0]
    gap = np.full(len(points), np.inf)
    for row in chosen:
        gap = np.minimum(gap, _distances(places, row))
    gap[chosen] = -1.0  # also where designs coincide, none is chosen twice
    while len(chosen) < count:
        row = int(np.argmax(gap))
        chosen.append(row)
        gap = np.minimum(gap, _distances(places, row))
        gap[row] = -1.0
    return chosen


def _worst(times: FloatArray, values: FloatArray, begin: int, end: int) -> tuple[float, int, int, int]:
    """Find where the chord over a stretch is farthest from the curves: (minus the deviation, begin, there, end)."""
    if end - begin < 2:
        return 0.0, begin, begin, end
    inside = slice(begin + 1, end)
    length = times[end] - times[begin]
    share = (times[inside] - times[begin]) / (length if length > 0.0 else 1.0)
    chord = values[begin] + share[:, None] * (values[end] - values[begin])
    deviation = np.abs(values[inside] - chord).max(axis=1)
    worst = int(np.argmax(deviation))
    return -float(deviation[worst]), begin, begin + 1 + worst, end


def _distances(places: FloatArray, column: int) -> FloatArray:
    """Squared distances of points, shape (k, n), from one of them."""
    return np.asarray(sum((coordinate - coordinate[column]) ** 2 for coordinate in places))
