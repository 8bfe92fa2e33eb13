"""Whether one sample of runs is better than another: rank sums, an effect size, and a correction for many tests."""

from collections.abc import Sequence

import numpy as np
from scipy.stats import mannwhitneyu

from divideropt.models.base import FloatArray


def rank_sum(a: FloatArray, b: FloatArray) -> tuple[float, float]:
    """Compare two samples.

    Args:
        a: Shape (n,).
        b: Shape (m,).

    Returns:
        The two-sided p of Mann and Whitney's test, and Vargha and Delaney's A12: the chance that a value of a is
        above one of b, ties counted half.
    """
    a, b = np.asarray(a), np.asarray(b)
    found = mannwhitneyu(a, b, alternative="two-sided")
    p = 1.0 if np.isnan(found.pvalue) else float(found.pvalue)
    return p, float(found.statistic) / (len(a) * len(b))


def holm(p: Sequence[float]) -> FloatArray:
    """Correct the p-values of one family of tests after Holm (1979), shape (n,)."""
    values = np.asarray(p, dtype=np.float64)
    order = values.argsort()
    steps = values[order] * np.arange(len(values), 0, -1)
    corrected = np.empty_like(values)
    corrected[order] = np.minimum(np.maximum.accumulate(steps), 1.0)
    return corrected
