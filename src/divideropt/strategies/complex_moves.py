"""The variants of the complex method: where a trial goes, when it is good enough, and when a complex has ended.

They differ by what stands here, and share the loop in `complex_method.search`.

- `box`: M. J. Box, "A new method of constrained optimization and a comparison with other methods", The Computer
  Journal 8 (1965) 42-52. A trial that is still the worst retreats half way to the centroid; one beyond an explicit
  bound is put just inside.
- `guin`: the retreat turns to the best point as the retreats mount (J. A. Guin, The Computer Journal 10 (1968)
  416-417), in the form of Krus and Andersson that C.7 of the thesis has. The trial need only beat what it replaces.
- `complex_rf`: random parts, and values that are forgotten (P. Krus and J. Ölvander, "Performance index and
  meta-optimization of a direct search optimization method", Engineering Optimization 45 (2013) 1167-1185).
- `author`: `complex.m`, C.7 of the thesis, with its peculiarities. A reflection need only be as good as the worst
  point, a retreat must be better; there is no limit to retreats, no end but the budget, no restart, and no care for a
  feasible start. Only what C.7 evaluates twice, its first points, is evaluated once here; and the merit of a design
  that fails is ours (docs/model/disagreements.md).
- `robust`, the default: `complex_rf` without its noise, which hinders along a ridge, but forgetting faster, which
  helps across one; with the expansion and the inside contraction of J. A. Nelder and R. Mead (The Computer Journal 7
  (1965) 308-313), and restarts around the best. `benchmarks/complex_method.py` compares them all.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from math import exp, inf
from types import MappingProxyType
from typing import Literal

import numpy as np

from divideropt.models.base import FloatArray

VariantName = Literal["robust", "box", "guin", "complex_rf", "author"]
"""The variants by name; see `VARIANTS`."""

RestartName = Literal["none", "fresh", "best"]
"""Where the next complex begins when one has ended: nowhere, anywhere in the box, or around the best so far."""

Score = Callable[[FloatArray], FloatArray]
"""Designs, shape (n, d), to merits, shape (n,): the smaller the better."""

Retreat = Callable[[FloatArray, FloatArray, FloatArray, int, np.random.Generator], FloatArray]
"""A trial that was no good, the centroid and the best point, each shape (d,), and the number of retreats before
this one, to the next trial, shape (d,)."""

RETREAT_MEMORY = 4
"""n_r of C.7 and b of Krus and Ölvander: the larger, the slower a retreat turns from the centroid to the best."""


@dataclass(frozen=True)
class Variant:
    """What one complex method does.

    Attributes:
        retreat: Where a trial goes that was no good.
        reflection: α, how far beyond the centroid the worst point is reflected, in its distance from there.
        expansion: Where a reflection is the best so far, how much further a second trial goes; 1 for none.
        contraction: Whether a reflection worse than what it replaces first turns back, half way from that to the
            centroid (the inside contraction of Nelder and Mead), before it retreats.
        must_leave_worst: A trial has to beat the worst of the other points, or else only what it replaces.
        accepts_equal: Whether a reflection may be as bad as that, too.
        most_retreats: Retreats of one trial; where none is good enough, the complex has ended. Infinite for no end.
        randomisation: Size of the random part of a trial, in spreads of the complex.
        forgetting: γ: how fast what the points were told long ago counts as worse.
        margin: How far inside a bound a trial beyond it is put, in parts of the box.
        feasible_start: Whether the points of the first complex are made feasible before the search.
        tolerance: A complex that spans no more than this part of the box in any variable has ended; 0 for never.
        restart: Where the next complex begins.
    """

    retreat: Retreat
    reflection: float = 1.3
    expansion: float = 1.0
    contraction: bool = False
    must_leave_worst: bool = True
    accepts_equal: bool = False
    most_retreats: float = 12
    randomisation: float = 0.0
    forgetting: float = 0.0
    margin: float = 0.0
    feasible_start: bool = True
    tolerance: float = 1e-5
    restart: RestartName = "fresh"


def forgetting_share(reflection: float, forgetting: float, points: int) -> float:
    """Return k_f = 1 - (α/2)^(γ/k), what a step adds to every value told, in spreads of them.

    Krus and Ölvander (2013); 0 where nothing is forgotten, or α is 2 or more.
    """
    return max(0.0, 1.0 - float((reflection / 2) ** (forgetting / points)))


def towards_centroid(
    trial: FloatArray, centroid: FloatArray, best: FloatArray, retreats: int, random: np.random.Generator
) -> FloatArray:
    """Half way to the centroid (Box 1965)."""
    return (trial + centroid) / 2


def towards_best(
    trial: FloatArray, centroid: FloatArray, best: FloatArray, retreats: int, random: np.random.Generator
) -> FloatArray:
    """Half way to a point between centroid and best, with a random part along their line (C.7)."""
    memory, k = RETREAT_MEMORY, retreats + 1
    share = (memory / (memory + k + 1)) ** ((memory + k - 1) / memory)
    target = share * centroid + (1 - share) * best
    scatter = (centroid - best) * (1 - share) * (2 * random.random() - 1)
    return np.asarray((trial + target) / 2 + scatter)


def gradually_towards_best(
    trial: FloatArray, centroid: FloatArray, best: FloatArray, retreats: int, random: np.random.Generator
) -> FloatArray:
    """Half way to a point between centroid and best, a = 1 - exp(-k/b) of the way (Krus and Ölvander 2013)."""
    share = 1 - exp(-retreats / RETREAT_MEMORY)
    return np.asarray((trial + (1 - share) * centroid + share * best) / 2)


VARIANTS: Mapping[VariantName, Variant] = MappingProxyType(
    {
        "robust": Variant(
            gradually_towards_best,
            expansion=2.0,
            contraction=True,
            forgetting=1.0,
            tolerance=1e-4,
            restart="best",
        ),
        "box": Variant(towards_centroid, margin=1e-6, most_retreats=30),
        "guin": Variant(towards_best, must_leave_worst=False),
        "complex_rf": Variant(gradually_towards_best, randomisation=0.3, forgetting=0.3, most_retreats=30),
        "author": Variant(
            towards_best,
            must_leave_worst=False,
            accepts_equal=True,
            most_retreats=inf,
            feasible_start=False,
            tolerance=0.0,
            restart="none",
        ),
    }
)
