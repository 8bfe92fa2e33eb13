"""Distributions of an uncertain number, each within two ends, as functions of a share of 1."""

from dataclasses import dataclass, field
from typing import Protocol

import numpy as np
import scipy

from divideropt.models.base import Domain, FloatArray

NORMAL_ENDS = 3.0
"""At so many standard deviations from its mean a normal distribution is cut off: tolerances have ends."""


class Distribution(Protocol):
    """How an uncertain number is distributed."""

    @property
    def lower(self) -> float:
        """Smallest value it takes."""
        ...

    @property
    def upper(self) -> float:
        """Largest value it takes."""
        ...

    def quantiles(self, shares: FloatArray) -> FloatArray:
        """Return the values below which these shares of it lie, any shape, each share between 0 and 1."""
        ...


@dataclass(frozen=True)
class Uniform:
    """Every value between two ends is as likely as any other."""

    lower: float
    upper: float

    def quantiles(self, shares: FloatArray) -> FloatArray:
        """Return the values below which these shares of it lie."""
        return np.clip(self.lower + (self.upper - self.lower) * shares, self.lower, self.upper)


@dataclass(frozen=True)
class LogUniform:
    """The logarithm is uniform; both ends are above 0."""

    lower: float
    upper: float

    def quantiles(self, shares: FloatArray) -> FloatArray:
        """Return the values below which these shares of it lie."""
        low, high = np.log(self.lower), np.log(self.upper)
        return np.asarray(np.clip(np.exp(low + (high - low) * shares), self.lower, self.upper))


@dataclass(frozen=True)
class Triangular:
    """The density rises from the lower end to the mode and falls from there to the upper end."""

    lower: float
    mode: float
    upper: float

    def quantiles(self, shares: FloatArray) -> FloatArray:
        """Return the values below which these shares of it lie."""
        width, left, right = self.upper - self.lower, self.mode - self.lower, self.upper - self.mode
        rising = self.lower + np.sqrt(shares * width * left)
        falling = self.upper - np.sqrt((1.0 - shares) * width * right)
        return np.clip(np.where(shares * width < left, rising, falling), self.lower, self.upper)


@dataclass(frozen=True)
class Normal:
    """A normal distribution cut off at `NORMAL_ENDS` standard deviations and at the ends of a domain.

    What lies beyond is given to the rest in proportion, so that nothing piles up at the ends.

    Attributes:
        mean: Mean before it is cut off, within the domain.
        sd: Standard deviation before it is cut off, above 0.
        domain: What is permitted at all.
    """

    mean: float
    sd: float
    domain: Domain = field(default_factory=Domain)

    @property
    def lower(self) -> float:
        """Smallest value it takes."""
        return max(self.mean - NORMAL_ENDS * self.sd, self.domain.lower)

    @property
    def upper(self) -> float:
        """Largest value it takes."""
        return min(self.mean + NORMAL_ENDS * self.sd, self.domain.upper)

    def quantiles(self, shares: FloatArray) -> FloatArray:
        """Return the values below which these shares of it lie."""
        below, above = scipy.special.ndtr((np.array([self.lower, self.upper]) - self.mean) / self.sd)
        scores = scipy.special.ndtri(below + (above - below) * shares)
        return np.asarray(np.clip(self.mean + self.sd * scores, self.lower, self.upper))
