"""Where in the box simulations failed: the share along each variable's range, and the bounds that others broke."""

from collections.abc import Sequence
from dataclasses import dataclass

from divideropt.analysis.breaches import Breaches
from divideropt.analysis.failures import PARTS, Failures
from divideropt.report.display import Axis
from divideropt.report.facts import VariableFacts

FEW = 10
"""Designs in a part of a range below which its share is chance."""

ENOUGH = 50
"""Designs from which on a part of a range may be named as that where most fail."""

_TOPS = (0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0)
"""Where the axis of the shares may end."""


@dataclass(frozen=True)
class Part:
    """A part of a variable's range: its bounds in the variable's unit, its designs, and those of them that failed."""

    lower: float
    upper: float
    designs: int
    failed: int

    @property
    def share(self) -> float:
        """Which part of them failed; 0 of none."""
        return self.failed / self.designs if self.designs else 0.0

    @property
    def few(self) -> bool:
        """Whether its share is chance."""
        return self.designs < FEW


@dataclass(frozen=True)
class Along:
    """A variable, and what became of the designs along its range."""

    axis: Axis
    parts: tuple[Part, ...]

    @property
    def most(self) -> int:
        """Designs in its fullest part."""
        return max(part.designs for part in self.parts)


@dataclass(frozen=True)
class Bound:
    """A bound of a constraint, how many designs break it, and how many break it alone."""

    words: str
    broken: int
    alone: int


@dataclass(frozen=True)
class Failing:
    """What failed in a campaign, and where.

    Attributes:
        designs: How many were simulated.
        failed: How many of them failed: their outcome is not ok.
        worked: How many did not, of which alone constraints say something.
        along: The variables; empty where nothing failed.
        top: Where the axis of their shares ends.
        worst: The variable and the part of its range in which the greatest share failed; None where nothing failed.
        bounds: The constraints' bounds.
    """

    designs: int
    failed: int
    worked: int
    along: tuple[Along, ...]
    top: float
    worst: tuple[Along, Part] | None
    bounds: tuple[Bound, ...]


def failing_of(
    failures: Failures, breaches: Breaches, variables: Sequence[VariableFacts], bounds: Sequence[str]
) -> Failing:
    """Word what failed.

    Args:
        failures: Of all runs.
        breaches: Likewise.
        variables: The box.
        bounds: The constraints' bounds in words, in the order of `breaches`.
    """
    along = tuple(_along(facts, failures, row) for row, facts in enumerate(variables)) if failures.total else ()
    shares = [part.share for one in along for part in one.parts if not part.few]
    named = [(one, part) for one in along for part in one.parts if part.designs >= ENOUGH]
    counts = zip(bounds, breaches.counts.tolist(), breaches.alone.tolist(), strict=True)
    return Failing(
        failures.designs,
        failures.total,
        breaches.designs,
        along,
        next(top for top in _TOPS if top >= max(shares, default=1.0)),
        max(named, key=lambda pair: pair[1].share, default=None),
        tuple(Bound(*count) for count in counts),
    )


def _along(facts: VariableFacts, failures: Failures, row: int) -> Along:
    ends = [facts.lower + (facts.upper - facts.lower) * k / PARTS for k in range(PARTS + 1)]
    counts = zip(failures.counts[row].tolist(), failures.failed[row].tolist(), strict=True)
    return Along(
        facts.axis, tuple(Part(ends[k], ends[k + 1], designs, failed) for k, (designs, failed) in enumerate(counts))
    )
