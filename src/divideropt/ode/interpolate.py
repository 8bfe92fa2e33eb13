"""The polynomial through the nodes of a step, compiled."""

import numpy as np

from divideropt.ode.base import NODES
from divideropt.ode.compiled import compiled

_BARYCENTRIC = 1.0 / np.prod(NODES[:, None] - NODES + np.eye(NODES.size), axis=1)


@compiled
def interpolate(theta, values):  # type: ignore[no-untyped-def]
    """Return the value at a place on a step, by the barycentric formula.

    Args:
        theta: The place, 0 at the left edge and 1 at the right.
        values: At the nodes, shape (NODES_PER_STEP,).
    """
    above, below = 0.0, 0.0
    for m in range(NODES.size):
        gap = theta - NODES[m]
        if gap == 0.0:
            return values[m]
        weight = _BARYCENTRIC[m] / gap
        above += weight * values[m]
        below += weight
    return above / below
