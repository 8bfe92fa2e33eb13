"""The KKT residuals of fronts, from the simulated neighbours of some of their points."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import pyarrow as pa

from divideropt.analysis.differences import neighbours
from divideropt.analysis.optimality import Optimality, optimality
from divideropt.errors import StoreError
from divideropt.models.base import FloatArray
from divideropt.problem import Problem
from divideropt.store import TableSchema


class Kkt(StrEnum):
    """What is known of a front point's residual."""

    COMPUTED = "computed"
    NOT_DEFINED = "not_defined"
    NOT_COMPUTED = "not_computed"


@dataclass(frozen=True)
class Convergence:
    """How near to stationary the points of a front are.

    Attributes:
        computed: How many have a residual.
        not_defined: How many have none, since there are no gradients.
        median: Of the residuals; None where there is none.
        high: Their 95th percentile, or None.
        below: How many are below their floor: zero within the noise.
    """

    computed: int
    not_defined: int
    median: float | None
    high: float | None
    below: int


def scales_of(front: pa.Table, problem: Problem, schema: TableSchema) -> FloatArray:
    """Return what the objectives of residuals are divided by, shape (k,): the front's extents.

    Where a front has none in an objective, as with one point, it is the quantity's scale.
    """
    F = problem.tell(schema.evaluations(front)).F
    extents = np.ptp(F, axis=0) if len(F) else np.zeros(F.shape[1])
    sizes = np.array([abs(o.quantity.scale) or 1.0 for o in problem.objectives])
    return np.asarray(np.where(extents > 0.0, extents, sizes))


def residuals(
    points: pa.Table, around: pa.Table, scales: FloatArray, problem: Problem, schema: TableSchema
) -> dict[str, Optimality]:
    """Compute the residuals of points.

    Args:
        points: Results, one row a point.
        around: Results of the neighbours, those of a point one after the other under its `design_id`.
        scales: The objectives', shape (k,).
        problem: What was optimised.
        schema: The store's columns.

    Returns:
        By `design_id`, of the points whose neighbours are there.

    Raises:
        StoreError: Under the name of a point there are other designs than its neighbours.
    """
    groups = dict(_groups(around["design_id"].to_pylist()))
    evaluations, simulated = schema.evaluations(points), schema.evaluations(around)
    found = {}
    for row, name in enumerate(points["design_id"].to_pylist()):
        if name not in groups:
            continue
        design, beside = evaluations.designs[row], simulated.part(*groups[name])
        if not np.array_equal(beside.designs, neighbours(design, problem.space)):
            raise StoreError(
                f"optimality: under {name} there are other designs than its neighbours; delete the folder "
                "`optimality` of the store, and they are simulated again"
            )
        found[name] = optimality(problem, scales, design, evaluations.quantities[row], beside)
    return found


def measured(front: pa.Table, known: Mapping[str, Optimality], schema: TableSchema) -> pa.Table:
    """Say of each point of a front what its residual is; `known` has them by `design_id`."""
    found = [known.get(name) for name in front["design_id"].to_pylist()]
    columns = {
        "kkt": [str(_word(item)) for item in found],
        "kkt_residual": [None if item is None else item.residual for item in found],
        "kkt_floor": [None if item is None else item.floor for item in found],
    }
    return schema.front_rows(front, columns)


def convergence(front: pa.Table) -> Convergence:
    """Sum up the residuals of a measured front."""
    words = front["kkt"].to_pylist()
    found = front["kkt_residual"].drop_null().to_numpy()
    floors = front["kkt_floor"].drop_null().to_numpy()
    return converged(found, floors, words.count(Kkt.NOT_DEFINED))


def converged(found: Sequence[float] | FloatArray, floors: Sequence[float] | FloatArray, others: int) -> Convergence:
    """Sum up residuals, their floors, and the number of points where they are not defined."""
    values = np.asarray(found, dtype=float)
    if len(values) == 0:
        return Convergence(0, others, None, None, 0)
    median, high = np.quantile(values, [0.5, 0.95]).tolist()
    return Convergence(len(values), others, median, high, int((values <= np.asarray(floors)).sum()))


def _word(found: Optimality | None) -> Kkt:
    if found is None:
        return Kkt.NOT_COMPUTED
    return Kkt.COMPUTED if found.defined else Kkt.NOT_DEFINED


def _groups(names: Sequence[str]) -> Iterator[tuple[str, tuple[int, int]]]:
    """Where the rows of each name begin and end."""
    begin = 0
    for end in range(1, len(names) + 1):
        if end == len(names) or names[end] != names[begin]:
            yield names[begin], (begin, end)
            begin = end
