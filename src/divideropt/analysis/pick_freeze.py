"""Sobol indices of one quantity from a pick-freeze sample, and their bootstrap intervals.

An index is a function of means over the blocks, so a bootstrap needs the blocks' terms once and then only sums of
them, weighted by how often a block was drawn: one product of matrices. SALib draws the same blocks, but copies every
value for every resample.
"""

import math
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from divideropt.analysis.blocks import Blocks
from divideropt.analysis.saltelli import Combine, saltelli_terms
from divideropt.models.base import FloatArray

RESAMPLES = 100
"""Bootstrap resamples, SALib's own default: they leave 7 % of an interval's width to chance."""

NORMAL_95 = 1.959963984540054
"""Half the width of a 95 % interval, in standard deviations of the normal distribution."""

CHUNK = 8192
"""Blocks whose weights are floating-point numbers at a time, so that a long sample's do not fill the memory."""

LEAST_EXPONENT = -1022
"""Of the smallest power of two that a float holds with all its digits."""

Bools = NDArray[np.bool_]


@dataclass(frozen=True)
class Estimate:
    """Indices in the order of `Blocks.keys`.

    Attributes:
        values: NaN where too little is known.
        half: Half the width of the 95 % interval.
        used: Part of the blocks, or of the pairs of designs, that the index rests on.
    """

    values: FloatArray
    half: FloatArray
    used: FloatArray


def whole(values: FloatArray, blocks: Blocks) -> Estimate:
    """Estimate the indices of a quantity that is defined in every design.

    Args:
        values: Shape (n, blocks.size), finite and not constant.
        blocks: The layout.

    Returns:
        SALib's indices: first order and total by Saltelli et al. (2010), second order by Saltelli (2002); NaN where
        the designs A and B, whose variance divides them, all have the same value.
    """
    from SALib.analyze.sobol import analyze  # noqa: PLC0415 (slow to import)

    values = values / size_of(values)
    scaled = (values - values.mean()) / values.std()
    if np.ptp(scaled[:, [0, blocks.b]]) <= np.finfo(float).eps:  # SALib would say 0
        nothing = np.full(len(blocks.keys), np.nan)
        return Estimate(nothing, nothing, np.ones(len(nothing)))
    d = blocks.variables
    description = {"num_vars": d, "names": [str(i) for i in range(d)], "bounds": [[0.0, 1.0]] * d}
    found = analyze(description, scaled.ravel(), calc_second_order=blocks.second_order, num_resamples=2, seed=1)
    indices = np.array([*found["S1"], *found["ST"], *(found["S2"][i, j] for i, j in blocks.pairs)])
    terms, combine = saltelli_terms(scaled, blocks)
    return Estimate(indices, _half_widths(terms, combine), np.ones(len(indices)))


def by_pairs(values: FloatArray, kept: Bools, blocks: Blocks, least: int) -> Estimate:
    """Estimate the indices among the kept designs alone, from every pair of them that the sample has.

    The total index of a variable is 1 - ρ, ρ the correlation of the quantity between designs that differ in that
    variable only; its first-order index is the correlation between designs that share that variable only (Janon et
    al. 2014, Asymptotic normality and efficiency of two Sobol index estimators, equation 6), each over the pairs of
    which both are kept. Where all are, these are Sobol indices; where not, the variables of the kept designs depend
    on each other, and an index says what it says here: by how much two working designs differ that differ in one
    variable.

    Args:
        values: Shape (n, blocks.size); those not kept may be anything.
        kept: Likewise.
        blocks: The layout.
        least: Pairs that an index rests on at least.

    Returns:
        The indices, NaN where fewer pairs are kept, or all of them are equal.
    """
    groups = _pair_groups(blocks)
    values = values / size_of(values[kept])
    centre, size = values[kept].mean(), values[kept].std()
    filled = np.where(kept, (values - centre) / size, 0.0)
    terms = np.concatenate([_pair_terms(filled, kept, group) for group in groups], axis=1)
    counts = terms[:, ::4].sum(axis=0)

    def combine(means: FloatArray) -> FloatArray:
        count, mean, square, product = (means[:, k::4] for k in range(4))
        with np.errstate(divide="ignore", invalid="ignore"):
            variance = square / count - (mean / count) ** 2
            rho = (product / count - (mean / count) ** 2) / np.where(variance > 0.0, variance, np.nan)
        d = blocks.variables
        first, total, closed = rho[:, :d], 1.0 - rho[:, d : 2 * d], rho[:, 2 * d :]
        second = [closed[:, k] - first[:, i] - first[:, j] for k, (i, j) in enumerate(blocks.pairs)]
        return np.column_stack([first, total, *second])

    indices = combine(terms.mean(axis=0)[None])[0]
    enough = counts >= least
    used = counts / (len(values) * np.array([len(group) for group in groups]))
    return Estimate(np.where(enough, indices, np.nan), _half_widths(terms, combine), used)


def size_of(values: FloatArray) -> float:
    """The power of two by which values are divided so that their squares are numbers: no digit is lost or won.

    Args:
        values: Finite, of any shape, at least one.
    """
    largest = float(np.abs(values).max())
    return math.ldexp(1.0, max(math.frexp(largest)[1] - 1, LEAST_EXPONENT)) if largest > 0.0 else 1.0


def _pair_groups(blocks: Blocks) -> list[list[tuple[int, int]]]:
    """Places in a block of the pairs behind each index: sharing one variable, all but one, exactly two."""
    variables, more = range(blocks.variables), blocks.second_order
    sharing = [[(blocks.b, blocks.ab(i)), *([(0, blocks.ba(i))] if more else [])] for i in variables]
    differing = [[(0, blocks.ab(i)), *([(blocks.b, blocks.ba(i))] if more else [])] for i in variables]
    both = [[(blocks.ba(i), blocks.ab(j)), (blocks.ba(j), blocks.ab(i))] for i, j in blocks.pairs]
    return sharing + differing + both


def _pair_terms(y: FloatArray, kept: Bools, group: list[tuple[int, int]]) -> FloatArray:
    """Of each block: how many pairs are kept, the sums of their means, mean squares and products, shape (n, 4)."""
    terms = np.zeros((len(y), 4))
    for one, other in group:
        both = kept[:, one] & kept[:, other]
        first, second = np.where(both, y[:, one], 0.0), np.where(both, y[:, other], 0.0)
        terms[:, 0] += both
        terms[:, 1] += (first + second) / 2
        terms[:, 2] += (first**2 + second**2) / 2
        terms[:, 3] += first * second
    return terms


def _half_widths(terms: FloatArray, combine: Combine) -> FloatArray:
    """Half the widths of the intervals, as SALib has them: by the standard deviation over the resamples."""
    drawn = _weights(len(terms))
    sums = np.zeros((RESAMPLES, terms.shape[1]))
    for begin in range(0, len(terms), CHUNK):
        part = slice(begin, begin + CHUNK)
        sums += drawn[:, part].astype(np.float64) @ terms[part]
    return np.asarray(NORMAL_95 * combine(sums / len(terms)).std(axis=0, ddof=1))


@lru_cache(maxsize=32)
def _weights(count: int) -> NDArray[np.uint8]:
    """How often each of so many blocks is drawn in each resample, shape (RESAMPLES, count); seeded by the count."""
    random = np.random.default_rng(count)
    draws = (np.bincount(random.integers(count, size=count), minlength=count) for _ in range(RESAMPLES))
    return np.array([row.astype(np.uint8) for row in draws])
