"""A mean, a standard deviation or a percentile of one quantity over samples: a quantity itself."""

import re
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from divideropt.models.base import FloatArray, Quantity

MEAN, SD = "mean", "sd"

KINDS = rf"{MEAN}|{SD}|p(?:0|[1-9][0-9]?)(?:\.[0-9]{{0,2}}[1-9])?|p100"
"""Pattern of what may be asked for; a percentile in one spelling only, since it names a column."""

_KIND = re.compile(KINDS, re.ASCII)
_NAMED = re.compile(rf"({KINDS})\.(.+)", re.ASCII)


@dataclass(frozen=True)
class Statistic:
    """What is made of one quantity's values over the samples of an uncertain design.

    A signed quantity counts by its magnitude. A failed sample is worse than any value: larger, or smaller for a lower
    bound. So neither mean nor standard deviation are defined where one failed, nor is a percentile that is between
    two values of which one is a failed sample's.

    Attributes:
        quantity: Of which quantity, by name.
        kind: `mean`, `sd` (with n - 1), or a percentile, `p95`, interpolated linearly between the sorted values.
        least: Whether it has a lower bound.
    """

    quantity: str
    kind: str
    least: bool = False

    @property
    def name(self) -> str:
        """Name of the quantity it makes, `p95.settling_time`."""
        return f"{self.kind}.{self.quantity}"

    def described(self, quantity: Quantity) -> Quantity:
        """Return the quantity it makes of the one it is of."""
        of = "its magnitude" if quantity.signed else "it"
        symbol = f"|{quantity.symbol}|" if quantity.signed and quantity.symbol else quantity.symbol
        description = f"{quantity.description}; {words_of(self.kind)} of {of} over the samples"
        return replace(quantity, name=self.name, symbol=symbol, description=description, signed=False, logical=False)

    def of(self, values: FloatArray, failed: NDArray[np.bool_]) -> FloatArray:
        """Compute it for a batch.

        Args:
            values: Of the quantity, of a signed one the magnitudes, shape (n, samples).
            failed: Which samples failed, the same shape; where a value is NaN, that sample counts as failed too.

        Returns:
            Shape (n,), NaN where it is not defined; a row's does not depend on the others.
        """
        values = np.where(failed | np.isnan(values), -np.inf if self.least else np.inf, values)
        with np.errstate(invalid="ignore", over="ignore"):
            if self.kind == MEAN:
                found = _mean(values)
            elif self.kind == SD:
                squares = (values - _mean(values)[:, None]) ** 2
                found = np.sqrt(np.cumsum(squares, axis=1)[:, -1] / (values.shape[1] - 1))
            else:
                found = _percentile(values, float(self.kind[1:]))
        return np.where(np.isfinite(found), found, np.nan)


def is_kind(word: object) -> bool:
    """Whether a word is a statistic: `mean`, `sd`, `p95`, `p99.5`."""
    return isinstance(word, str) and _KIND.fullmatch(word) is not None


def percent_of(kind: str) -> float | None:
    """Return a percentile's percent; None for another statistic."""
    return float(kind[1:]) if kind.startswith("p") else None


def parted(name: str) -> tuple[str, str] | None:
    """Part the name of a statistic's quantity, `p95.settling_time`, into kind and quantity; None for another's."""
    match = _NAMED.fullmatch(name)
    return (match[1], match[2]) if match else None


def words_of(kind: str) -> str:
    """Word a statistic: `mean`, `standard deviation`, `95th percentile`."""
    percent = percent_of(kind)
    if percent is None:
        return {MEAN: "mean", SD: "standard deviation"}[kind]
    teens = 11 <= percent <= 13
    ending = "th" if teens else {1.0: "st", 2.0: "nd", 3.0: "rd"}.get(percent % 10, "th")
    return f"{kind[1:]}{ending} percentile"


def _mean(values: FloatArray) -> FloatArray:
    """Sum one after the other: NumPy's own sum pairs numbers by how they lie in memory, which the batch decides."""
    return np.asarray(np.cumsum(values, axis=1)[:, -1] / values.shape[1])


def _percentile(values: FloatArray, percent: float) -> FloatArray:
    """Interpolate as `numpy.percentile` does, but for a place that is exactly a value's, which stands alone."""
    ranked = np.sort(values, axis=1)
    place = (values.shape[1] - 1) * (percent / 100.0)
    lower = int(np.floor(place))
    share = place - lower
    if share == 0.0:
        return np.asarray(ranked[:, lower])
    low, high = ranked[:, lower], ranked[:, lower + 1]
    step = high - low
    return np.asarray(high - step * (1.0 - share) if share >= 0.5 else low + step * share)
