"""Strategies compared over their seeds, after equally many evaluations of each run.

All indicators measure against the best known front, that of everything the compared runs have logged; only what a run
found in its first evaluations counts for the run. Objectives are scaled by the extents of that front within the
reference point, to which IGD+ and ε keep, and the goal directions start a little below its ideal point.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from divideropt.analysis.fronts import nondominated
from divideropt.analysis.goal_directions import gaps, reached
from divideropt.analysis.indicators import additive_epsilon, hypervolume, igd_plus
from divideropt.analysis.ranking import PairTest, holm, pair_tests, several_test
from divideropt.analysis.scale import Scale, region
from divideropt.models.base import FloatArray
from divideropt.problem import AGGREGATES, Objective, Told
from divideropt.strategies import reference_directions

DIRECTIONS = 91
"""Goal directions, at most: the largest Das-Dennis set, which for three objectives is just as many."""

BELOW_IDEAL = 0.05
"""Of the extents: so far below the ideal point the goal directions start, as Steuer's utopian point is. From the
ideal point itself λ would be 0 where a direction is an axis, and any gap a multiple of nothing."""


@dataclass(frozen=True)
class Indicator:
    """A figure by which runs are compared.

    Attributes:
        title: Heading of its column.
        meaning: What it is.
        sign: 1 where more is better, -1 where less is.
    """

    title: str
    meaning: str
    sign: float


INDICATORS: Mapping[str, Indicator] = MappingProxyType(
    {
        "hypervolume": Indicator("hypervolume", "share of the box up to the reference point that is dominated", 1.0),
        "igd_plus": Indicator("IGD+", "mean distance of the best known front to what is dominated", -1.0),
        "epsilon": Indicator("ε", "least shift after which the best known front is dominated", -1.0),
        "attainment": Indicator("best max λ", "goal attainment (3.24); below 0 every goal is met", -1.0),
        "mean_gap": Indicator("mean gap", "λ over the best known, less 1: mean over the goal directions", -1.0),
        "worst_gap": Indicator("worst gap", "the same in the worst direction", -1.0),
    }
)
"""By name. IGD+ and ε are in shares of the best known front's extents."""


@dataclass(frozen=True)
class Contender:
    """A run to be compared.

    Attributes:
        group: Its strategy, and its store where there are several: what is compared.
        run: Its name.
        told: What its optimiser was told, all of it.
    """

    group: str
    run: str
    told: Told

    @property
    def evaluations(self) -> int:
        """How many it has logged."""
        return len(self.told.F)

    def front(self, evaluations: int) -> FloatArray:
        """Return the feasible non-dominated among the first so many evaluations, shape (n, k)."""
        F = self.told.F[:evaluations][self.told.feasible[:evaluations]]
        return np.asarray(F[nondominated(F)])


@dataclass(frozen=True)
class Score:
    """What a run reached.

    Attributes:
        group: As in `Contender`.
        run: As in `Contender`.
        front: Designs on its own front.
        shared: How many of them are on the front of all compared runs after as many evaluations; the first of equals.
        values: By indicator; None where one is not defined: no reference point, or an objective without a goal.
    """

    group: str
    run: str
    front: int
    shared: int
    values: Mapping[str, float | None]


@dataclass(frozen=True)
class Ranking:
    """The groups compared by one indicator.

    Attributes:
        indicator: Its name.
        overall: p of the Kruskal-Wallis test, not corrected; None for two groups, or where one has a single run.
        pairs: Each two groups; `effect` is the chance that a run of the first is better.
        corrected: The pairs' p, by Holm's method over all pairs of all indicators; None where there is no p.
    """

    indicator: str
    overall: float | None
    pairs: tuple[PairTest, ...]
    corrected: tuple[float | None, ...]


@dataclass(frozen=True)
class Comparison:
    """What came out.

    Attributes:
        evaluations: Of each run, that count.
        scores: A run each, in the order given.
        left_out: Runs that have not got that far.
        tests: A comparison an indicator that is defined; none where there is one group only.
    """

    evaluations: int
    scores: tuple[Score, ...]
    left_out: tuple[Contender, ...]
    tests: tuple[Ranking, ...]

    @property
    def groups(self) -> Mapping[str, tuple[Score, ...]]:
        """The scores by group, in the order given."""
        names = dict.fromkeys(score.group for score in self.scores)
        return {name: tuple(s for s in self.scores if s.group == name) for name in names}


def compare(
    contenders: Sequence[Contender],
    objectives: Sequence[Objective],
    reference: FloatArray | None,
    evaluations: int | None = None,
) -> Comparison | None:
    """Compare runs.

    Args:
        contenders: Runs of one problem, those of a group with different seeds.
        objectives: The problem's.
        reference: The reference point of the hypervolume, shape (k,), or None.
        evaluations: How many of each run count, at least 1; as many as all have that have any, where not given.

    Returns:
        The comparison; None where no run has a feasible design, or none so many evaluations.
    """
    counts = [c.evaluations for c in contenders if c.evaluations]
    at = evaluations or min(counts, default=0)
    taking_part = [c for c in contenders if c.evaluations >= max(at, 1)]
    known = best_known(contenders, len(objectives))
    if not taking_part or len(known) == 0:
        return None
    fronts = [c.front(at) for c in taking_part]
    measure = _Measure(known, objectives, reference)
    scores = tuple(
        Score(c.group, c.run, len(front), shared, measure.of(front))
        for c, front, shared in zip(taking_part, fronts, _shares(fronts), strict=True)
    )
    left_out = tuple(c for c in contenders if c.evaluations < max(at, 1))
    comparison = Comparison(at, scores, left_out, ())
    return replace(comparison, tests=_tests(comparison.groups))


def best_known(contenders: Sequence[Contender], objectives: int) -> FloatArray:
    """Return the front of all that runs have logged, shape (n, objectives)."""
    fronts = [np.empty((0, objectives)), *(c.front(c.evaluations) for c in contenders)]
    together = np.concatenate(fronts)
    return np.asarray(together[nondominated(together)])


class _Measure:
    """Measures fronts against the best known."""

    def __init__(self, known: FloatArray, objectives: Sequence[Objective], reference: FloatArray | None) -> None:
        self._objectives, self._reference = objectives, reference
        inside = known[region(known, reference)]
        self._scale = Scale.of(inside)
        self._known = self._scale.apply(inside)
        self._directions = reference_directions(len(objectives), DIRECTIONS)
        self._best = self._reached(self._scale.apply(known))

    def of(self, front: FloatArray) -> dict[str, float | None]:
        scaled = self._scale.apply(front)
        gap = gaps(self._reached(scaled), self._best)
        return {
            "hypervolume": None if self._reference is None else hypervolume(front, self._reference),
            "igd_plus": igd_plus(scaled, self._known),
            "epsilon": additive_epsilon(scaled, self._known),
            "attainment": self._attainment(front),
            "mean_gap": float(gap.mean()),
            "worst_gap": float(gap.max()),
        }

    def _attainment(self, front: FloatArray) -> float | None:
        if any(o.goal is None for o in self._objectives):
            return None
        return float(AGGREGATES["goal_attainment"](front, self._objectives).min(initial=np.inf))

    def _reached(self, scaled: FloatArray) -> FloatArray:
        k = len(self._objectives)
        return reached(scaled, self._directions, np.full(k, -BELOW_IDEAL), np.ones(k))


def _shares(fronts: Sequence[FloatArray]) -> list[int]:
    """How many points of each front are on that of all."""
    kept = nondominated(np.concatenate(fronts))
    ends = np.cumsum([0, *(len(front) for front in fronts)]).tolist()
    return [int(kept[begin:end].sum()) for begin, end in pairwise(ends)]


def _tests(groups: Mapping[str, Sequence[Score]]) -> tuple[Ranking, ...]:
    found = []
    for name, indicator in INDICATORS.items():
        samples = {
            g: [indicator.sign * v for s in scores if (v := s.values[name]) is not None]
            for g, scores in groups.items()
        }
        if len(samples) > 1 and all(samples.values()):
            found.append((name, several_test(list(samples.values())), pair_tests(samples)))
    corrected = iter(holm([pair.p for _, _, pairs in found for pair in pairs if pair.p is not None]))
    return tuple(
        Ranking(name, overall, tuple(pairs), tuple(None if pair.p is None else next(corrected) for pair in pairs))
        for name, overall, pairs in found
    )
