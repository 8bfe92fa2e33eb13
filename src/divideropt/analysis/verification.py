"""Which front points to simulate again, and what that says of them."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from divideropt.errors import StoreError
from divideropt.models.base import FloatArray
from divideropt.problem import AGGREGATES, Evaluations, Problem
from divideropt.store import TableSchema
from divideropt.store.schema import DEVIATION_FLOOR, deviation_of

NEAREST = 5
"""Points nearest the goals, which somebody may build: always verified."""

SEED = 1
"""Of the sample: a constant, so that the same front gives the same sample."""


class Verified(StrEnum):
    """What is known of a front point."""

    YES = "yes"
    NO = "no"
    DEVIATES = "deviates"


@dataclass(frozen=True)
class Tally:
    """How the points of a front came out.

    Attributes:
        points: How many there are.
        agree: How many of them were simulated again and came out the same.
        deviate: How many were and did not.
        largest: The largest deviation of each objective; None where none was verified.
    """

    points: int
    agree: int
    deviate: int
    largest: Mapping[str, float | None]


def worth_verifying(
    front: pa.Table, problem: Problem, schema: TableSchema, sample: int, *, extremes: bool = True
) -> list[str]:
    """Choose points of a front: both extremes of each objective, those nearest the goals, and a sample of the others.

    Args:
        front: Feasible non-dominated results.
        problem: What was optimised.
        schema: The store's columns.
        sample: How many of the others; all, where there are fewer.
        extremes: Whether the extremes and those nearest the goals are among them; else only the sample is.

    Returns:
        Their `design_id`, in that order; the same for the same front.
    """
    if front.num_rows == 0:
        return []
    F = problem.tell(schema.evaluations(front)).F
    rows = [*F.argmin(axis=0).tolist(), *F.argmax(axis=0).tolist()] if extremes else []
    if extremes and all(o.goal is not None for o in problem.objectives):
        attainment = AGGREGATES["goal_attainment"](F, problem.objectives)
        rows += np.argsort(attainment, kind="stable")[:NEAREST].tolist()
    others = np.setdiff1d(np.arange(len(F)), rows)
    rows += np.random.default_rng(SEED).choice(others, min(sample, len(others)), replace=False).tolist()
    ids = front["design_id"].to_pylist()
    return [ids[row] for row in dict.fromkeys(rows)]


def marked(front: pa.Table, reference: pa.Table, problem: Problem, schema: TableSchema, tolerance: float) -> pa.Table:
    """Say of each point of a front whether simulating it again gave the same.

    Args:
        front: Results, one row a point.
        reference: Results of the model's reference, of any designs in any order.
        problem: What was optimised.
        schema: The store's columns.
        tolerance: Largest relative deviation of an objective that still counts as the same.

    Returns:
        The front with the columns `verified` and `deviation_<objective>`.

    Raises:
        StoreError: The reference was given another design under the name of a point.
    """
    place = {name: row for row, name in enumerate(reference["design_id"].to_pylist())}
    rows = np.array([place.get(name, -1) for name in front["design_id"].to_pylist()], dtype=np.int64)
    known = np.flatnonzero(rows >= 0)
    told = schema.evaluations(front.take(pa.array(known)))
    exact = schema.evaluations(reference.take(pa.array(rows[known])))
    _check_designs(front["design_id"].take(pa.array(known)).to_pylist(), told, exact)
    deviations = np.full((front.num_rows, len(schema.objectives)), np.nan)
    deviations[known] = _deviations(told.quantities, exact.quantities, problem)
    agree = np.array([a.outcome is b.outcome for a, b in zip(told.verdicts, exact.verdicts, strict=True)], dtype=bool)
    agree &= (deviations[known] <= tolerance).all(axis=1)
    words = np.full(front.num_rows, str(Verified.NO), dtype=object)
    words[known] = np.where(agree, str(Verified.YES), str(Verified.DEVIATES))
    columns = {"verified": words} | {deviation_of(n): deviations[:, i] for i, n in enumerate(schema.objectives)}
    return schema.front_rows(front, columns)


def tally(front: pa.Table, schema: TableSchema) -> Tally:
    """Count the points of a marked front."""
    words = front["verified"].to_pylist()
    largest = {}
    for name in schema.objectives:
        values = front[deviation_of(name)].drop_null().to_pylist()
        largest[name] = max(values, default=None)
    return Tally(len(words), words.count(Verified.YES), words.count(Verified.DEVIATES), largest)


def _deviations(values: FloatArray, exact: FloatArray, problem: Problem) -> FloatArray:
    """Relative deviations of the objectives, shape (n, k), NaN where either side is not defined."""
    places = {name: i for i, name in enumerate(problem.model.quantities)}
    quantities = [o.quantity for o in problem.objectives]
    columns = [places[q.name] for q in quantities]
    floors = DEVIATION_FLOOR * np.abs([q.scale for q in quantities])
    reference = exact[:, columns]
    difference = np.abs(values[:, columns] - reference)
    with np.errstate(invalid="ignore"):  # nothing over nothing, where a model's scale is 0
        relative = difference / np.maximum(np.abs(reference), floors)
    return np.asarray(np.where(difference == 0.0, 0.0, relative))


def _check_designs(names: Sequence[str], told: Evaluations, exact: Evaluations) -> None:
    differ: NDArray[np.bool_] = (told.designs != exact.designs).any(axis=1)
    if differ.any():
        raise StoreError(
            f"verification: {names[int(differ.argmax())]} there is another design than on the front; "
            "delete the folder `verification` of the store, and its points are simulated again"
        )
