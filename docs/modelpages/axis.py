"""An axis of a chart: values to pixels, and round values to write at it."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

TICKS = 5
"""About so many intervals between ticks."""

RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
"""Digits to superscripts."""


@dataclass(frozen=True)
class Axis:
    """Values to pixels.

    Attributes:
        low: Value at `start`.
        high: Value at `end`.
        start: Pixel.
        end: Pixel.
        log: Whether it is logarithmic; then both values are above 0.
    """

    low: float
    high: float
    start: float
    end: float
    log: bool = False

    def __call__(self, value: float) -> float:
        """Return the pixel of a value."""
        low, high, at = (math.log10(v) if self.log else v for v in (self.low, self.high, value))
        return self.start + (at - low) / (high - low) * (self.end - self.start)

    def ticks(self) -> Iterator[tuple[float, str]]:
        """Give round values on the axis, and how they are written."""
        if self.log:
            for power in range(_first(math.log10(self.low)), _last(math.log10(self.high)) + 1):
                yield 10.0**power, f"10{str(power).translate(RAISED)}"
            return
        step = _round_step((self.high - self.low) / TICKS)
        digits = max(0, -math.floor(math.log10(step) + 1e-9))
        for k in range(_first(self.low / step), _last(self.high / step) + 1):
            yield k * step, f"{k * step:.{digits}f}".replace("-", "−")


def _first(value: float) -> int:
    return math.ceil(value - 1e-9)


def _last(value: float) -> int:
    return math.floor(value + 1e-9)


def _round_step(rough: float) -> float:
    """The smallest of 1, 2, 5 times a power of ten that is not much below."""
    power = 10.0 ** math.floor(math.log10(rough))
    return next(m * power for m in (1.0, 2.0, 5.0, 10.0) if m * power >= 0.75 * rough)
