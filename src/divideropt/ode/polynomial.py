"""The polynomial through the nodes of a step, compiled: its coefficients, and its value at a place.

The coefficients are those of the powers of 2θ - 1, which keep eleven digits and more where powers of θ would not.
"""

import numpy as np

from divideropt.ode.base import NODES
from divideropt.ode.compiled import compiled

_FROM_NODES = np.linalg.inv(np.vander(2.0 * NODES - 1.0, increasing=True))


@compiled
def coefficients(values, c):  # type: ignore[no-untyped-def]
    """Fill the coefficients.

    Args:
        values: At the nodes, shape (NODES_PER_STEP,).
        c: Receives them, shape (NODES_PER_STEP,).
    """
    for k in range(NODES.size):
        c[k] = 0.0
    for m in range(NODES.size):
        for k in range(NODES.size):
            c[k] += _FROM_NODES[k, m] * values[m]


@compiled
def value_at(theta, c):  # type: ignore[no-untyped-def]
    """Return the value at a place on a step.

    Args:
        theta: The place, 0 at the left edge and 1 at the right.
        c: The coefficients.
    """
    s, total = 2.0 * theta - 1.0, c[NODES.size - 1]
    for k in range(NODES.size - 2, -1, -1):
        total = total * s + c[k]
    return total
