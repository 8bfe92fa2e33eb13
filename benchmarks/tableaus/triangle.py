"""Coefficients below a diagonal."""

from collections.abc import Sequence

import numpy as np

from divideropt.models.base import FloatArray


def lower(*rows: Sequence[float]) -> FloatArray:
    """Return a square matrix with these rows below its diagonal, from its second row on."""
    matrix = np.zeros((len(rows) + 1, len(rows) + 1))
    for i, row in enumerate(rows, start=1):
        matrix[i, :i] = row
    return matrix
