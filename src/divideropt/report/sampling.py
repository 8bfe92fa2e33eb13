"""Few instead of many: points that keep a curve's shape."""

import heapq

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
