"""The designs of a report, and the bounds that the front leans on."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
import pyarrow as pa

from divideropt.analysis import Kkt, Optimality, Verified
from divideropt.errors import StoreError, printable
from divideropt.models.base import VALIDITY, FloatArray
from divideropt.problem import AGGREGATES, DesignSpace, Problem
from divideropt.store import TableSchema
from divideropt.store.schema import deviation_of

NEAR_BOUND = 1e-3
"""Share of a variable's range within which a design lies on the bound."""

LEAST_SHARE = 0.05
"""Share of the front from which on it leans on a bound; fewer designs are the front's edge."""


_ID = re.compile(r"[a-z0-9_]{1,64}-[0-9]{1,20}(?:-branch-[0-9]{1,20})?/[0-9]{1,20}", re.ASCII)


@dataclass(frozen=True, slots=True)
class Design:
    """One design.

    Attributes:
        design_id: `<run>/<index>`.
        run: Its run.
        strategy: The run's strategy.
        variables: In the variables' units.
        objectives: What is minimised, in the quantities' units; of signed quantities the magnitude.
        attainment: max λ_i of (3.24), or None where an objective has no goal.
        met: Whether each objective's goal is met, None where it has none.
        verified: What is known of simulating it again by the model's reference.
        deviation: The largest deviation of an objective there, None where not known.
        kkt: What is known of its KKT residual.
        optimality: The residual and its floor, None where not computed or not defined.
        valid: Whether the model vouches for it (`within_validity`), None where it does not say.
    """

    design_id: str
    run: str
    strategy: str
    variables: tuple[float, ...]
    objectives: tuple[float, ...]
    attainment: float | None
    met: tuple[bool | None, ...]
    verified: Verified = Verified.NO
    deviation: float | None = None
    kkt: Kkt = Kkt.NOT_COMPUTED
    optimality: Optimality | None = None
    valid: bool | None = None


@dataclass(frozen=True)
class Leaning:
    """A bound that the front leans on.

    Attributes:
        variable: Index of the variable.
        side: `lower` or `upper`.
        bound: Its value, in the variable's unit.
        share: Part of the front's designs that lie on it.
    """

    variable: int
    side: str
    bound: float
    share: float


def designs_of(
    table: pa.Table, problem: Problem, schema: TableSchema, strategies: Mapping[str, str]
) -> tuple[Design, ...]:
    """Read the designs of a front.

    Args:
        table: Feasible evaluations; of a front, marked with what is known of each.
        problem: What was optimised.
        schema: The store's columns.
        strategies: The strategy of each run.

    Returns:
        The best by goal attainment first; in the table's order where there are no goals.

    Raises:
        StoreError: A design is not named as ours are.
    """
    evaluations = schema.evaluations(table)
    objectives = problem.tell(evaluations).F
    attainment = _attainment(objectives, problem)
    order = range(len(objectives)) if attainment is None else np.argsort(attainment, kind="stable").tolist()
    ids, runs = table["design_id"].to_pylist(), table["run"].to_pylist()
    _check_ids(ids)
    known = _known(table, schema)
    told = VALIDITY in table.column_names
    valid = table[VALIDITY].to_pylist() if told else [None] * table.num_rows
    return tuple(
        Design(
            ids[i],
            runs[i],
            strategies.get(runs[i], runs[i]),
            tuple(evaluations.designs[i].tolist()),
            tuple(objectives[i].tolist()),
            None if attainment is None else float(attainment[i]),
            _met(objectives[i], problem),
            *known[i],
            valid[i],
        )
        for i in order
    )


def leanings(designs: Sequence[Design], space: DesignSpace) -> tuple[Leaning, ...]:
    """List the bounds that the front leans on, the one with the most designs first."""
    if not designs:
        return ()
    places = np.array([design.variables for design in designs])
    near = NEAR_BOUND * (space.upper - space.lower)
    sides = {
        "lower": (space.lower, places - space.lower <= near),
        "upper": (space.upper, space.upper - places <= near),
    }
    found = [
        Leaning(i, side, float(bounds[i]), float(on[:, i].mean()))
        for side, (bounds, on) in sides.items()
        for i in range(len(space))
        if on[:, i].mean() >= LEAST_SHARE
    ]
    return tuple(sorted(found, key=lambda leaning: (-leaning.share, leaning.variable, leaning.side)))


def _check_ids(ids: Sequence[str]) -> None:
    strange = next((name for name in ids if not _ID.fullmatch(name)), None)
    if strange is not None:
        raise StoreError(
            f"a design of the store is named {printable(strange[:60])!r}, not <run>/<index>: the store is damaged; "
            "restore it, or start anew (--fresh)"
        )


def _attainment(objectives: FloatArray, problem: Problem) -> FloatArray | None:
    if any(objective.goal is None for objective in problem.objectives):
        return None
    return AGGREGATES["goal_attainment"](objectives, problem.objectives)


def _known(table: pa.Table, schema: TableSchema) -> list[tuple[Verified, float | None, Kkt, Optimality | None]]:
    """What a front says of each design besides its results; of other tables that nothing is known."""
    if "verified" not in table.column_names:
        return [(Verified.NO, None, Kkt.NOT_COMPUTED, None)] * table.num_rows
    deviations = zip(*(table[deviation_of(name)].to_pylist() for name in schema.objectives), strict=True)
    largest = (max((d for d in row if d is not None), default=None) for row in deviations)
    verified, words, residuals, floors = (
        table[name].to_pylist() for name in ("verified", "kkt", "kkt_residual", "kkt_floor")
    )
    return [
        (Verified(word), value, Kkt(kkt), None if residual is None else Optimality(residual, floor))
        for word, value, kkt, residual, floor in zip(verified, largest, words, residuals, floors, strict=True)
    ]


def _met(row: FloatArray, problem: Problem) -> tuple[bool | None, ...]:
    return tuple(
        None if objective.goal is None else bool(value <= objective.goal)
        for value, objective in zip(row, problem.objectives, strict=True)
    )
