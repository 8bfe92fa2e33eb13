"""Whether one strategy is better than another over their seeds, and by how much: rank tests and effect sizes.

Each seed gives one value of an indicator; nothing is assumed of how values are distributed. Seeds of two strategies
have nothing in common, so samples are not paired.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import comb

import numpy as np
from scipy import stats

from divideropt.models.base import FloatArray

SIGNIFICANCE = 0.05
"""Level of a test: the chance of calling different what is not."""

_SIZES = ((0.06, "negligible"), (0.14, "small"), (0.21, "medium"))


@dataclass(frozen=True)
class PairTest:
    """Two samples compared.

    Attributes:
        first: Name of a sample.
        second: Name of another.
        p: Two-sided p-value of the Mann-Whitney U test, which is Wilcoxon's rank-sum test; None where a sample has
            fewer than two values, of which no test can say anything.
        effect: Vargha and Delaney's A: the chance that a value of the first is above one of the second, ties half;
            None as p.
    """

    first: str
    second: str
    p: float | None
    effect: float | None


def pair_tests(samples: Mapping[str, Sequence[float]]) -> list[PairTest]:
    """Compare each two of several samples, in their order.

    Args:
        samples: Values by the sample's name; infinite ones rank as such.

    Returns:
        A test a pair, p not corrected: see `holm`.
    """
    found = []
    for first, second in combinations(samples, 2):
        x, y = np.asarray(samples[first], dtype=float), np.asarray(samples[second], dtype=float)
        if min(len(x), len(y)) < 2:
            found.append(PairTest(first, second, None, None))
        else:
            p = float(stats.mannwhitneyu(x, y).pvalue)
            found.append(PairTest(first, second, p, probability_above(x, y)))
    return found


def several_test(samples: Sequence[Sequence[float]]) -> float | None:
    """Return the p-value of the Kruskal-Wallis test of more than two samples.

    Args:
        samples: Values of each; infinite ones rank as such.

    Returns:
        The chance that samples of one distribution differ as much; 1 where all values are the same; None where there
        are at most two samples, or one has fewer than two values.
    """
    if len(samples) <= 2 or min(map(len, samples)) < 2:
        return None
    values = np.concatenate([np.asarray(sample, dtype=float) for sample in samples])
    if (values == values[0]).all():
        return 1.0
    return float(stats.kruskal(*samples).pvalue)


def probability_above(x: FloatArray, y: FloatArray) -> float:
    """Return Vargha and Delaney's A (2000): P(X > Y) + P(X = Y)/2.

    Args:
        x: Values of the first sample, shape (n,), at least one.
        y: Values of the second, shape (m,), at least one.

    Returns:
        0.5 where neither is stochastically above the other; 1 where every x is above every y.
    """
    ranks = stats.rankdata(np.concatenate([x, y]))[: len(x)]
    return float((ranks.sum() / len(x) - (len(x) + 1) / 2) / len(y))


def effect_size(effect: float) -> str:
    """Word Vargha and Delaney's A by their limits, 0.56, 0.64 and 0.71, on either side of 0.5."""
    distance = round(abs(effect - 0.5), 12)
    return next((word for limit, word in _SIZES if distance < limit), "large")


def holm(p: Sequence[float]) -> list[float]:
    """Correct p-values of several tests by Holm's step-down method (1979).

    Args:
        p: One a test, in any order.

    Returns:
        In the same order, at most 1: rejecting what is at most α rejects any true hypothesis with a chance of at
        most α.
    """
    order = np.argsort(p, kind="stable")
    factors = len(p) - np.arange(len(p))
    corrected = np.minimum(1.0, np.maximum.accumulate(np.asarray(p, dtype=float)[order] * factors))
    result = np.empty(len(p))
    result[order] = corrected
    return [float(value) for value in result]


def least_p(first: int, second: int) -> float:
    """Return the smallest p-value that samples of these sizes can have, in the exact test: 2 of all their orders."""
    return min(1.0, 2.0 / comb(first + second, first))
