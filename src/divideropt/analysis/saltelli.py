"""The estimators of Saltelli et al. (2010; second order, 2002) as functions of means over a sample's blocks."""

from collections.abc import Callable

import numpy as np

from divideropt.analysis.blocks import Blocks
from divideropt.models.base import FloatArray

Combine = Callable[[FloatArray], FloatArray]


def saltelli_terms(y: FloatArray, blocks: Blocks) -> tuple[FloatArray, Combine]:
    """Take SALib's estimators apart, so that a bootstrap has only sums to form.

    Args:
        y: The quantity, of mean 0 and deviation 1, shape (n, blocks.size).
        blocks: The layout.

    Returns:
        The terms of each block, shape (n, c), and what makes indices, shape (k, len(blocks.keys)), of k rows of their
        means.
    """
    d, a, b = blocks.variables, y[:, 0], y[:, blocks.b]
    ab = y[:, 1 : 1 + d]
    terms = [
        (a + b)[:, None] / 2,
        (a**2 + b**2)[:, None] / 2,
        b[:, None] * (ab - a[:, None]),
        (a[:, None] - ab) ** 2 / 2,
    ]
    terms += [(y[:, blocks.ba(i)] * y[:, blocks.ab(j)] - a * b)[:, None] for i, j in blocks.pairs]

    def combine(means: FloatArray) -> FloatArray:
        variance = (means[:, 1] - means[:, 0] ** 2)[:, None]
        with np.errstate(divide="ignore", invalid="ignore"):  # a resample in which nothing varies has no index
            shares = means[:, 2:] / variance
        first, total, joint = shares[:, :d], shares[:, d : 2 * d], shares[:, 2 * d :]
        second = [joint[:, k] - first[:, i] - first[:, j] for k, (i, j) in enumerate(blocks.pairs)]
        return np.column_stack([first, total, *second])

    return np.concatenate(terms, axis=1), combine
