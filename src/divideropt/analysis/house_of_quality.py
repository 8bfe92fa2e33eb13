"""The House of Quality from total-order indices: how strongly each variable acts on each criterion, 0 to 4.

The score of a variable is 4 √(ST / the row's largest ST), rounded: an index is a share of variance, its root goes
with how far the variable moves the quantity, which is what one reads from a sweep and what the author's numbers are
of; and each of his rows has a 4. It is 0 where the 95 % interval of the index reaches 0.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd

from divideropt.analysis.treatments import Treatment
from divideropt.models.divider.thesis_house import COST_EXPONENTS, THESIS_HOUSE, ThesisRow
from divideropt.problem import DesignSpace, Problem

STRONGEST = 4
"""The author's largest number, a strong effect."""

WORTHWHILE = 0.25
"""Importance from which on a variable is worth optimising: as if it scored 1, a weak effect, on every objective."""

_FOR_HOUSE = (str(Treatment.ALL), str(Treatment.WORKING))


@dataclass(frozen=True)
class Criterion:
    """A row of the house.

    Attributes:
        words: What it is.
        quantity: By which quantity it is judged, None for the proxy of cost.
        weight: Of the campaign's objective, None where it is no objective.
        demand: Whether the campaign has a constraint on it, and no objective.
        scores: One a variable; None where the quantity has no indices.
        author: The author's, None where he has none.
        author_weight: His weight, None where it is a demand or no row of his.
    """

    words: str
    quantity: str | None
    weight: float | None
    demand: bool
    scores: tuple[int, ...] | None
    author: tuple[int | None, ...] | None = None
    author_weight: float | None = None

    @property
    def importance(self) -> str:
        """The weight as the author writes it: a number, D for a demand, or nothing."""
        return f"{self.weight:g}" if self.weight is not None else "D" if self.demand else ""


@dataclass(frozen=True)
class House:
    """A House of Quality.

    Attributes:
        variables: Its columns.
        rows: Its criteria.
        importance: Of each variable, 0 to 1: the mean of its scores over the objectives by their weights, in parts of
            4; None where no objective has scores. Demands and cost do not count.
        author_importance: The same of the author's scores and weights, None without his table.
    """

    variables: tuple[str, ...]
    rows: tuple[Criterion, ...]
    importance: tuple[float, ...] | None
    author_importance: tuple[float | None, ...] | None

    @property
    def worthwhile(self) -> tuple[str, ...]:
        """The variables worth optimising, the most important first."""
        pairs = zip(self.importance or (), self.variables, strict=False)
        return tuple(name for value, name in sorted(pairs, key=lambda p: -p[0]) if value >= WORTHWHILE)

    @property
    def differences(self) -> tuple[int, ...]:
        """Our score less the author's, wherever both have one."""
        return tuple(
            mine - its
            for row in self.rows
            if row.scores is not None and row.author is not None
            for mine, its in zip(row.scores, row.author, strict=True)
            if its is not None
        )


def house_of_quality(indices: pd.DataFrame, problem: Problem, *, thesis: bool) -> House:
    """Make the house.

    Args:
        indices: Of a Sobol study, as `SobolStudy.indices`.
        problem: What was studied.
        thesis: Whether the model is the author's valve, so that his numbers are beside.

    Returns:
        The house: his criteria and the objectives that are none of them, or without `thesis` the objectives and
        constraints.
    """
    totals = indices[(indices["kind"] == "ST") & indices["treatment"].isin(_FOR_HOUSE)]
    totals = totals[totals["samples"] == totals["samples"].max()]
    names = problem.space.names
    rows = [_thesis_row(row, totals, problem) for row in THESIS_HOUSE] if thesis else []
    asked = [o.quantity.name for o in problem.objectives]
    asked += [] if thesis else [c.quantity.name for c in problem.constraints]
    there = {row.quantity for row in rows}
    rows += [
        _row(name.replace("_", " ").replace(".", " "), name, totals, problem)
        for name in dict.fromkeys(asked)
        if name not in there
    ]
    return House(names, tuple(rows), _importance(rows), _author_importance(rows, names) if thesis else None)


def scores(totals: Sequence[float], low: Sequence[float]) -> tuple[int, ...]:
    """Score total-order indices, given the lower ends of their intervals."""
    largest = max((t for t, end in zip(totals, low, strict=True) if end > 0.0), default=0.0)
    return tuple(
        math.floor(STRONGEST * math.sqrt(min(1.0, total / largest)) + 0.5) if end > 0.0 else 0
        for total, end in zip(totals, low, strict=True)
    )


def _row(words: str, quantity: str, totals: pd.DataFrame, problem: Problem) -> Criterion:
    found = totals[totals["quantity"] == quantity].set_index("variable")
    names = problem.space.names
    columns = [found.reindex(list(names))[column].tolist() for column in ("value", "low")]
    known = all(math.isfinite(number) for column in columns for number in column)  # an interval may not be defined
    given = scores(*columns) if known else None
    weights = {o.quantity.name: o.weight for o in problem.objectives}
    demanded = {c.quantity.name for c in problem.constraints}
    return Criterion(words, quantity, weights.get(quantity), quantity not in weights and quantity in demanded, given)


def _thesis_row(row: ThesisRow, totals: pd.DataFrame, problem: Problem) -> Criterion:
    names = problem.space.names
    if row.quantities:
        made = _row(row.words, _asked(row.quantities, problem), totals, problem)
    else:
        cost = _cost(problem.space)
        made = Criterion(row.words, None, None, demand=False, scores=None if cost is None else scores(cost, cost))
    his = tuple(row.scores.get(name) for name in names)
    return Criterion(made.words, made.quantity, made.weight, made.demand, made.scores, his, row.weight)


def _asked(quantities: Sequence[str], problem: Problem) -> str:
    """The one of these, or what is gathered of it, that is an objective, else a constraint, else the first."""
    asked = [o.quantity.name for o in problem.objectives] + [c.quantity.name for c in problem.constraints]
    found = [given for name in quantities for given in asked if given == name or given.endswith(f".{name}")]
    objectives = asked[: len(problem.objectives)]
    return next((name for name in found if name in objectives), found[0] if found else quantities[0])


def _cost(space: DesignSpace) -> tuple[float, ...] | None:
    """The share of each variable in the variance of the proxy of cost, a sum of powers; None where none is in it."""
    variances = [
        _power_variance(
            v.lower / (v.lower + v.upper), v.upper / (v.lower + v.upper), COST_EXPONENTS[v.parameter.name]
        )
        if v.parameter.name in COST_EXPONENTS and v.lower > 0.0
        else 0.0
        for v in space.variables
    ]
    total = sum(variances)
    return tuple(v / total for v in variances) if total > 0.0 else None


def _power_variance(lower: float, upper: float, exponent: float) -> float:
    """Variance of (2 x)^p, x uniform between two positive ends, p not -1/2."""
    ends = 2.0 * lower, 2.0 * upper
    return _power_mean(*ends, 2.0 * exponent) - _power_mean(*ends, exponent) ** 2


def _power_mean(lower: float, upper: float, exponent: float) -> float:
    """Mean of x^p."""
    if exponent == -1.0:
        return math.log(upper / lower) / (upper - lower)
    raised = math.pow(upper, exponent + 1.0) - math.pow(lower, exponent + 1.0)
    return raised / ((exponent + 1.0) * (upper - lower))


def _importance(rows: Sequence[Criterion]) -> tuple[float, ...] | None:
    counted = [(row.weight, row.scores) for row in rows if row.weight is not None and row.scores is not None]
    if not counted:
        return None
    weights = np.array([weight for weight, _ in counted])
    return tuple((weights @ np.array([given for _, given in counted]) / (STRONGEST * weights.sum())).tolist())


def _author_importance(rows: Sequence[Criterion], names: Sequence[str]) -> tuple[float | None, ...]:
    """His scores weighed by his weights, over the criteria that he optimised."""
    counted = [row for row in rows if row.author_weight is not None and row.quantity is not None and row.author]
    total = STRONGEST * sum(row.author_weight or 0.0 for row in counted)
    found: list[float | None] = []
    for place in range(len(names)):
        given = [(row.author_weight or 0.0, row.author[place]) for row in counted if row.author is not None]
        known = [weight * score for weight, score in given if score is not None]
        found.append(sum(known) / total if len(known) == len(given) else None)
    return tuple(found)
