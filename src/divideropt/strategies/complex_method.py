"""The complex method (Box 1965) and what became of it: one loop, five variants, restarts.

A complex of points is held in the box. The worst is reflected over the centroid of the others; a trial that is not
good enough retreats, again and again. What a variant does of this in its own way, and its source, stand in
`complex_moves`.

Explicit constraints, the bounds, are met by clipping. Implicit ones by retreat: an infeasible trial is worse than any
feasible one. Where no start is feasible, a search for the least violation comes first; then the infeasible points of
a new complex retreat half way to the centroid of the feasible ones, until they are feasible (Box).
"""

import dataclasses
from collections.abc import Callable
from typing import Annotated

import numpy as np
from pydantic import Field
from pydantic.dataclasses import dataclass

from divideropt.models.base import FloatArray
from divideropt.problem import AGGREGATES, DesignSpace, Problem, merit
from divideropt.problem.problem import INFEASIBLE_MERIT
from divideropt.strategies.base import (
    STRICT,
    AggregateName,
    BudgetSpentError,
    Count,
    Evaluate,
    within_budget,
)
from divideropt.strategies.complex_moves import VARIANTS, RestartName, Score, Variant, VariantName, forgetting_share

REACH = (0.003, 0.3)
"""Between these parts of the box, drawn anew each time, lies the half width of a complex begun around the best: large
ones find, small ones polish."""

FEASIBLE_ROUNDS = 12
"""How often an infeasible point of a first complex is moved half way to the feasible ones."""


@dataclass(frozen=True, config=STRICT)
class ComplexMethod:
    """Options of the complex method."""

    aggregate: AggregateName = "goal_attainment"
    """How several objectives become one."""
    variant: VariantName = "robust"
    """Which complex method: robust, ours; box (1965); guin, retreating to the best; complex_rf (Krus and Ölvander
    2013); author, C.7 of the thesis. The options below are the variant's own where not given."""
    points: Annotated[int, Field(ge=3, le=1000)] | None = None
    """Points of a complex; twice the number of variables where not given."""
    evaluations: Count = 2000
    """Budget of evaluations."""
    reflection: Annotated[float, Field(ge=1.0, le=3.0)] | None = None
    """α: how far beyond the centroid the worst point is reflected."""
    randomisation: Annotated[float, Field(ge=0.0, le=10.0)] | None = None
    """Size of the random part of a trial, in spreads of the complex (r_fak of Complex-RF)."""
    forgetting: Annotated[float, Field(ge=0.0, le=10.0)] | None = None
    """γ of Complex-RF: how fast what a point was told long ago counts as worse."""
    tolerance: Annotated[float, Field(ge=0.0, lt=1.0)] | None = None
    """A complex that spans no more than this part of the box in any variable has ended; 0 for never."""
    restart: RestartName | None = None
    """Where the next complex begins: none, fresh (anywhere in the box), or best (around the best design so far)."""

    def budget(self, variables: int) -> int:
        """Most evaluations a run asks for; see `Strategy.budget`."""
        return self.evaluations

    def objection(self, variables: int, objectives: int) -> tuple[str, str] | None:
        """A complex must span the box and fit into the budget; see `Strategy.objection`."""
        points = self.points or _usual_points(variables)
        if points <= variables:
            return "points", f"{points} points do not span {variables} variables; give at least {variables + 1}"
        if self.evaluations < points:
            return "evaluations", f"{self.evaluations} do not even make a complex of {points} points; give more"
        return None

    def run(self, problem: Problem, evaluate: Evaluate, seed: int) -> None:
        """Search from one complex after the other; see `Strategy.run`."""
        aggregate = AGGREGATES[self.aggregate]
        counted = within_budget(evaluate, self.evaluations)

        def score(designs: FloatArray) -> FloatArray:
            told = counted(designs)
            return merit(aggregate(told.F, problem.objectives), told)

        points = self.points or _usual_points(len(problem.space))
        try:
            search_all(score, problem.space, points, self._variant(), np.random.default_rng(seed))
        except BudgetSpentError:
            return

    def _variant(self) -> Variant:
        """The variant with the options that were given."""
        names = ("reflection", "randomisation", "forgetting", "tolerance", "restart")
        given = {name: getattr(self, name) for name in names if getattr(self, name) is not None}
        return dataclasses.replace(VARIANTS[self.variant], **given)


def _usual_points(variables: int) -> int:
    """Return Box's 2n, but 3 for a single variable (Krus and Ölvander)."""
    return max(2 * variables, 3)


@dataclasses.dataclass
class Complex:
    """The points held, and their merits.

    Attributes:
        points: Shape (k, d).
        merits: As told, shape (k,): the raw objective.
        aged: The same, the worse the longer ago it was told; moves the complex, and is never reported.
    """

    points: FloatArray
    merits: FloatArray
    aged: FloatArray = dataclasses.field(init=False)

    def __post_init__(self) -> None:
        """Nothing is old yet; what was asked and told stays as it was."""
        self.points, self.merits, self.aged = self.points.copy(), self.merits.copy(), self.merits.copy()

    @property
    def best(self) -> int:
        """Index of the best point, whatever its age."""
        return int(self.merits.argmin())

    @property
    def worst(self) -> int:
        """Index of the worst point, age counted."""
        return int(self.aged.argmax())

    def span(self, space: DesignSpace) -> float:
        """How much of the box the points span, in the variable where that is most."""
        extent = self.points.max(axis=0) - self.points.min(axis=0)
        return float((extent / (space.upper - space.lower)).max())

    def age(self, share: float) -> None:
        """Make every value told worse by a share of their spread; the infeasible are worse than any as they are."""
        feasible = self.aged < INFEASIBLE_MERIT
        if share > 0 and feasible.any():
            values = self.aged[feasible]
            self.aged[feasible] = values + share * (values.max() - values.min())

    def replace(self, index: int, point: FloatArray, value: float) -> None:
        """Put a point in another's place."""
        self.points[index], self.merits[index], self.aged[index] = point, value, value


def search_all(score: Score, space: DesignSpace, points: int, variant: Variant, random: np.random.Generator) -> None:
    """Search from one complex after the other, by the variant's rule of restarts.

    Args:
        score: Answers a batch of trials; ends the run by raising.
        space: The box.
        points: Points of a complex.
        variant: What is done.
        random: Every draw.
    """
    best = _Best(score)
    held = _anywhere(best, space, points, random)
    if variant.feasible_start:
        held = _made_feasible(held, best, space, variant, random)
    search(held, best.score, space, random, variant)
    while variant.restart != "none":
        around = variant.restart == "best" and best.value < INFEASIBLE_MERIT
        held = _around(best, space, points, random) if around else _anywhere(best, space, points, random)
        search(held, best.score, space, random, variant)


def search(
    held: Complex,
    score: Score,
    space: DesignSpace,
    random: np.random.Generator,
    variant: Variant = VARIANTS["guin"],
    until: float = -np.inf,
) -> None:
    """Improve a complex until it has ended: by its tolerance, or because no retreat was good enough.

    Args:
        held: Improved in place.
        score: Answers a trial; may end the run by raising.
        space: The box; a trial outside is moved to its nearest point, or just inside.
        random: Draws the random parts.
        variant: What is done.
        until: Ends the search as soon as the best merit is below.
    """
    width = space.upper - space.lower
    share = forgetting_share(variant.reflection, variant.forgetting, len(held.points))

    def place(trial: FloatArray) -> FloatArray:
        if variant.randomisation > 0:
            trial = trial + variant.randomisation * span * width * (random.random(len(width)) - 0.5)
        return _inside(trial, space, variant.margin)

    while held.merits.min() >= until:
        span = held.span(space)
        if variant.tolerance > 0 and span <= variant.tolerance:
            return
        held.age(share)
        if not _replace_worst(held, score, place, random, variant):
            return


def _replace_worst(
    held: Complex,
    score: Score,
    place: Callable[[FloatArray], FloatArray],
    random: np.random.Generator,
    variant: Variant,
) -> bool:
    """Replace the worst point by its reflection or by what that retreats to; return whether one was good enough."""

    def tried(trial: FloatArray) -> tuple[FloatArray, float]:
        placed = place(trial)
        return placed, float(score(placed[None])[0])

    worst, best = held.worst, held.points[held.aged.argmin()]
    limit = float(np.delete(held.aged, worst).max() if variant.must_leave_worst else held.aged[worst])
    centroid = np.delete(held.points, worst, axis=0).mean(axis=0)
    beyond = variant.reflection * (centroid - held.points[worst])
    trial, value = tried(centroid + beyond)
    if variant.expansion > 1 and value < held.aged.min():
        further, promised = tried(centroid + variant.expansion * beyond)
        if promised < value:
            trial, value = further, promised
    retreats, good = 0, value < limit or (variant.accepts_equal and value == limit)
    while not good and retreats < variant.most_retreats:
        if variant.contraction and retreats == 0 and value >= held.aged[worst]:
            target = (held.points[worst] + centroid) / 2
        else:
            target = variant.retreat(trial, centroid, best, retreats, random)
        trial, value = tried(target)
        retreats, good = retreats + 1, value < limit
    if good:
        held.replace(worst, trial, value)
    return good


class _Best:
    """The best design told so far, by the raw merit, whatever a complex has forgotten or dropped."""

    def __init__(self, score: Score) -> None:
        self._score = score
        self.point: FloatArray | None = None
        self.value = np.inf

    def score(self, designs: FloatArray) -> FloatArray:
        """Score a batch and keep the best."""
        values = self._score(designs)
        row = int(values.argmin())
        if self.point is None or values[row] < self.value:
            self.point, self.value = designs[row].copy(), float(values[row])
        return values


def _made_feasible(
    held: Complex, best: _Best, space: DesignSpace, variant: Variant, random: np.random.Generator
) -> Complex:
    """Return a complex of feasible points, as far as they can be had."""
    points = len(held.points)
    while best.value >= INFEASIBLE_MERIT:  # the merit of the infeasible is their violation
        search(held, best.score, space, random, variant, until=INFEASIBLE_MERIT)
        held = _anywhere(best, space, points, random)
        if best.value < INFEASIBLE_MERIT and best.point is not None:
            held.replace(0, best.point, best.value)
    for _ in range(FEASIBLE_ROUNDS):
        outside = held.merits >= INFEASIBLE_MERIT
        if not outside.any():
            break
        moved = (held.points[outside] + held.points[~outside].mean(axis=0)) / 2
        values = best.score(moved)
        for index, point, value in zip(np.flatnonzero(outside), moved, values, strict=True):
            held.replace(int(index), point, float(value))
    return held


def _anywhere(best: _Best, space: DesignSpace, points: int, random: np.random.Generator) -> Complex:
    sample = space.sample(points, random)
    return Complex(sample, best.score(sample))


def _around(best: _Best, space: DesignSpace, points: int, random: np.random.Generator) -> Complex:
    """Return the best design and points around it."""
    assert best.point is not None
    reach = np.exp(random.uniform(*np.log(REACH))) * (space.upper - space.lower)
    fresh = space.clip(best.point + reach * (2 * random.random((points - 1, len(space))) - 1))
    known = best.point[None], [best.value]
    return Complex(np.concatenate([known[0], fresh]), np.concatenate([known[1], best.score(fresh)]))


def _inside(trial: FloatArray, space: DesignSpace, margin: float) -> FloatArray:
    """Move a trial to the nearest point of the box, and where it was beyond a bound, just inside."""
    if margin == 0:
        return space.clip(trial)
    inset = margin * (space.upper - space.lower)
    below, above = trial < space.lower, trial > space.upper
    return np.where(below, space.lower + inset, np.where(above, space.upper - inset, trial))
