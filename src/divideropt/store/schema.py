"""The columns of the tables, with unit, symbol and role in each column's metadata."""

from collections.abc import Iterable
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import pyarrow as pa

from divideropt.errors import StoreError
from divideropt.models.base import FloatArray, Outcome, Verdict
from divideropt.problem import Evaluations, Problem

SCHEMA_VERSION = 1
"""Version of the tables; a store of a later one is refused."""

_VERSION_KEY = b"divideropt.schema_version"


class Role(StrEnum):
    """What a column is to the campaign."""

    KEY = "key"
    VARIABLE = "variable"
    OBJECTIVE = "objective"
    CONSTRAINT = "constraint"
    QUANTITY = "quantity"
    OUTCOME = "outcome"


@dataclass(frozen=True)
class TableSchema:
    """The columns of one campaign's tables.

    Attributes:
        arrow: The log's columns in their order, with metadata.
        variables: Names of the variables' columns.
        quantities: Names of the quantities, in the model's order.
    """

    arrow: pa.Schema
    variables: tuple[str, ...]
    quantities: tuple[str, ...]

    @classmethod
    def of(cls, problem: Problem) -> "TableSchema":
        """Lay out the columns for a problem."""
        fields = [
            _text("design_id", Role.KEY),
            _text("run", Role.KEY),
            pa.field("batch", pa.int64(), nullable=False, metadata={"role": Role.KEY}),
        ]
        for variable in problem.space.variables:
            p = variable.parameter
            fields.append(_number(p.name, p.unit, p.symbol, p.description, Role.VARIABLE))
        for name, role in _ordered_quantities(problem):
            q = problem.model.quantities[name]
            fields.append(_number(q.name, q.unit, q.symbol, q.description, role, signed=q.signed))
        fields += [_text("outcome", Role.OUTCOME), _text("outcome_text", Role.OUTCOME)]
        arrow = pa.schema(fields, metadata={_VERSION_KEY: str(SCHEMA_VERSION)})
        return cls(arrow, problem.space.names, tuple(problem.model.quantities))

    def table(self, run: str, first: int, batch: int, evaluations: Evaluations) -> pa.Table:
        """Word a batch as rows; NaN becomes null."""
        n = len(evaluations)
        columns: dict[str, object] = {
            "design_id": [f"{run}/{first + i}" for i in range(n)],
            "run": [run] * n,
            "batch": np.full(n, batch),
            "outcome": [str(v.outcome) for v in evaluations.verdicts],
            "outcome_text": [v.text for v in evaluations.verdicts],
        }
        columns |= _columns(self.variables, evaluations.designs)
        columns |= _columns(self.quantities, evaluations.quantities)
        arrays = [pa.array(columns[f.name], f.type, from_pandas=True) for f in self.arrow]
        return pa.Table.from_arrays(arrays, schema=self.arrow)

    def evaluations(self, table: pa.Table) -> Evaluations:
        """Read rows back, bit for bit; null becomes NaN."""
        words = zip(table["outcome"].to_pylist(), table["outcome_text"].to_pylist(), strict=True)
        verdicts = [_verdict(outcome, text) for outcome, text in words]
        return Evaluations(_matrix(table, self.variables), _matrix(table, self.quantities), verdicts)


def check_version(schema: pa.Schema, path: object) -> None:
    """Refuse a table this program does not know.

    Raises:
        StoreError: The table has no version, or a later one.
    """
    stated = (schema.metadata or {}).get(_VERSION_KEY)
    if stated is None or not stated.isdigit():
        raise StoreError(f"{path}: not a table of this program (no schema version in it); move it out of the store")
    if int(stated) > SCHEMA_VERSION:
        raise StoreError(
            f"{path}: schema version {int(stated)}, this program knows up to {SCHEMA_VERSION}; use a later divideropt"
        )


def _ordered_quantities(problem: Problem) -> Iterable[tuple[str, Role]]:
    """Objectives first, then the constraints' quantities, then the rest."""
    roles = {o.quantity.name: Role.OBJECTIVE for o in problem.objectives}
    for constraint in problem.constraints:
        roles.setdefault(constraint.quantity.name, Role.CONSTRAINT)
    for name in problem.model.quantities:
        roles.setdefault(name, Role.QUANTITY)
    return roles.items()


def _text(name: str, role: Role) -> pa.Field:
    return pa.field(name, pa.string(), nullable=False, metadata={"role": role})


def _number(name: str, unit: str, symbol: str, description: str, role: Role, *, signed: bool = False) -> pa.Field:
    metadata = {"role": role, "unit": unit, "symbol": symbol, "description": description}
    if signed:
        metadata["objective"] = "acts on the magnitude; the column is signed"
    return pa.field(name, pa.float64(), metadata=metadata)


def _verdict(outcome: str, text: str) -> Verdict:
    if outcome not in set(Outcome):
        raise StoreError(f"the log has an outcome {outcome!r}, which this program does not know; restore it")
    return Verdict(Outcome(outcome), text)


def _columns(names: tuple[str, ...], matrix: FloatArray) -> dict[str, FloatArray]:
    return {name: matrix[:, i] for i, name in enumerate(names)}


def _matrix(table: pa.Table, names: tuple[str, ...]) -> FloatArray:
    if not names:
        return np.empty((table.num_rows, 0))
    columns = [table[name].to_numpy(zero_copy_only=False) for name in names]
    return np.column_stack([np.asarray(c, dtype=np.float64) for c in columns])
