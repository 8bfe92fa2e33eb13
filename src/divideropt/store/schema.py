"""The columns of the tables, with unit, symbol and role in each column's metadata."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

import numpy as np
import pyarrow as pa

from divideropt.errors import StoreError, UsageError
from divideropt.models.base import FloatArray, Outcome, Verdict
from divideropt.problem import Evaluations, Problem
from divideropt.units import LARGEST

SCHEMA_VERSION = 2
"""Version of the tables; a table of any other is refused.

It grows by one with the first change since the last release after which an older store cannot be read as it was:
other columns in a log or a front, another meaning of a column, another quantity in a model. Later changes of the same
release share the number. Version 2: fronts say which points were verified, and how near to stationary they are.
"""

VERIFIED = {
    "yes": "simulated again by the model's reference, every objective's deviation within the campaign's tolerance "
    "and the outcome the same (constraints are not compared)",
    "deviates": "simulated again and not so",
    "no": "not simulated again",
}
"""What the words in a front's `verified` mean."""

DEVIATION_FLOOR = 0.01
"""Of a quantity's scale: below it a reference value divides no deviation, since an objective may be zero."""

DEVIATION = (
    "|value - reference| / max(|reference|, 1 % of the quantity's scale), a signed quantity by its value; "
    "null where not simulated again or not defined"
)

KKT = {
    "computed": "the Karush-Kuhn-Tucker residual was computed from simulations of the design's neighbours",
    "not_defined": "they show a kink, or fail on both sides, so there are no gradients",
    "not_computed": "not asked for, or not on the combined front",
}
"""What the words in a front's `kkt` mean."""

KKT_RESIDUAL = (
    "rate at which one direction improves every objective at least: parts of the combined front's extent in each, "
    "for a way of one range of the variables; 0 where the design is Pareto-stationary"
)

KKT_FLOOR = "what the noise of the model may make of the residual; a residual below is zero within the noise"

STORED = ("run", "batch", "outcome", "outcome_text", "verified", "kkt", "kkt_residual", "kkt_floor")
"""The columns that every campaign's tables have beside `design_id`, its variables and its model's quantities."""

_VERSION_KEY = b"divideropt.schema_version"


class Role(StrEnum):
    """What a column is to the campaign."""

    KEY = "key"
    VARIABLE = "variable"
    OBJECTIVE = "objective"
    CONSTRAINT = "constraint"
    QUANTITY = "quantity"
    OUTCOME = "outcome"
    VERIFICATION = "verification"
    OPTIMALITY = "optimality"


@dataclass(frozen=True)
class TableSchema:
    """The columns of one campaign's tables.

    Attributes:
        arrow: The log's columns in their order, with metadata.
        variables: Names of the variables' columns.
        quantities: Names of the quantities, in the model's order.
        objectives: Names of those that are objectives.
    """

    arrow: pa.Schema
    variables: tuple[str, ...]
    quantities: tuple[str, ...]
    objectives: tuple[str, ...]

    @classmethod
    def of(cls, problem: Problem) -> "TableSchema":
        """Lay out the columns for a problem.

        Raises:
            UsageError: A name of the model's is that of another column.
        """
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
            number = _number(q.name, q.unit, q.symbol, q.description, role, signed=q.signed)
            fields.append(number.with_type(pa.bool_()) if q.logical else number)
        fields += [_text("outcome", Role.OUTCOME), _text("outcome_text", Role.OUTCOME)]
        _check_names([field.name for field in fields])  # before anything looks a column up by its name
        arrow = pa.schema(fields, metadata={_VERSION_KEY: str(SCHEMA_VERSION)})
        objectives = tuple(o.quantity.name for o in problem.objectives)
        schema = cls(arrow, problem.space.names, tuple(problem.model.quantities), objectives)
        _check_names([field.name for field in schema.front] + ["batch"])
        return schema

    @property
    def results(self) -> pa.Schema:
        """The log's columns without `batch`: what is known of a design wherever it is listed."""
        return self.arrow.remove(self.arrow.get_field_index("batch"))

    @property
    def front(self) -> pa.Schema:
        """The columns of a front, with whether simulating a design again gave the same, and with its KKT residual."""
        fields = [_text("verified", Role.VERIFICATION, _meaning(VERIFIED))]
        fields += [_number(deviation_of(name), "", "", DEVIATION, Role.VERIFICATION) for name in self.objectives]
        fields += [
            _text("kkt", Role.OPTIMALITY, _meaning(KKT)),
            _number("kkt_residual", "", "", KKT_RESIDUAL, Role.OPTIMALITY),
            _number("kkt_floor", "", "", KKT_FLOOR, Role.OPTIMALITY),
        ]
        return pa.schema([*self.results, *fields], metadata=self.arrow.metadata)

    def log_rows(self, run: str, first: int, batch: int, batches: Sequence[Evaluations]) -> pa.Table:
        """Word batches, counted from `batch`, as rows of the log, counted from `first`; NaN becomes null."""
        evaluations = Evaluations.together(batches)
        n = len(evaluations)
        ids = [f"{run}/{i}" for i in range(first, first + n)]
        numbers = np.repeat(np.arange(batch, batch + len(batches)), [len(b) for b in batches])
        return self._rows(self.arrow, evaluations, design_id=ids, run=[run] * n, batch=numbers)

    def result_rows(self, ids: Sequence[str], runs: Sequence[str], evaluations: Evaluations) -> pa.Table:
        """Word evaluations of named designs as rows of `results`; NaN becomes null."""
        return self._rows(self.results, evaluations, design_id=ids, run=runs)

    def front_rows(self, table: pa.Table, columns: Mapping[str, object]) -> pa.Table:
        """Word results as a front.

        Args:
            table: The results; of a front, with what it says besides.
            columns: What to say instead, by column; NaN becomes null.

        Returns:
            The front; what neither says is that nothing is known.
        """
        unknown = {"verified": "no", "kkt": "not_computed"}
        arrays = []
        for field in self.front:
            if field.name in columns:
                arrays.append(pa.array(columns[field.name], field.type, from_pandas=True))
            elif field.name in table.column_names:
                arrays.append(table[field.name])
            else:
                arrays.append(pa.array([unknown.get(field.name)] * table.num_rows, field.type))
        return pa.Table.from_arrays(arrays, schema=self.front)

    def _rows(self, schema: pa.Schema, evaluations: Evaluations, **keys: object) -> pa.Table:
        columns: dict[str, object] = keys | {
            "outcome": [str(v.outcome) for v in evaluations.verdicts],
            "outcome_text": [v.text for v in evaluations.verdicts],
        }
        columns |= _columns(self.variables, evaluations.designs)
        columns |= _columns(self.quantities, evaluations.quantities)
        arrays = [pa.array(columns[f.name], _given_type(f), from_pandas=True).cast(f.type) for f in schema]
        return pa.Table.from_arrays(arrays, schema=schema)

    def objection(self, table: pa.Table) -> str | None:
        """Say what a table of results holds that no simulation gives; None where nothing."""
        unknown = set(table["outcome"].unique().to_pylist()) - set(Outcome)
        if unknown:
            return f"an outcome {min(unknown)!r}, which this program does not know"
        wrong = ~np.isfinite(_matrix(table, self.variables)).all(axis=1)
        if wrong.any():
            return f"{table['design_id'][int(wrong.argmax())]} has a variable that is no number"
        size = np.abs(_matrix(table, self.quantities))
        wrong = ((size > LARGEST) & (size < np.inf)).any(axis=1)
        if wrong.any():
            return f"{table['design_id'][int(wrong.argmax())]} has a quantity beyond {LARGEST:g} that is not infinite"
        return None

    def log_objection(self, table: pa.Table, run: str, first: int) -> str | None:
        """Say what is wrong with rows of a run's log, whose first is given; None where nothing."""
        ids = pa.chunked_array([[f"{run}/{i}" for i in range(first, first + table.num_rows)]])
        if not table["design_id"].equals(ids) or table["run"].unique().to_pylist() != [run]:
            return f"not the evaluations from {run}/{first} on"
        return self.objection(table)

    def front_objection(self, table: pa.Table) -> str | None:
        """Say what a front holds that cannot be; None where nothing."""
        for name, words in (("verified", VERIFIED), ("kkt", KKT)):
            unknown = set(table[name].unique().to_pylist()) - set(words)
            if unknown:
                return f"`{name}` is {min(map(str, unknown))!r}, not one of {', '.join(words)}"
        return self.objection(table)

    def evaluations(self, table: pa.Table) -> Evaluations:
        """Read rows back, bit for bit; null becomes NaN."""
        return Evaluations(_matrix(table, self.variables), _matrix(table, self.quantities), _verdicts(table))


def check_version(schema: pa.Schema, path: object) -> None:
    """Refuse a table this program does not know.

    Raises:
        StoreError: The table has no version, or another.
    """
    stated = (schema.metadata or {}).get(_VERSION_KEY)
    if stated is None or not stated.isdigit():
        raise StoreError(f"{path}: not a table of this program (no schema version in it); move it out of the store")
    if int(stated) > SCHEMA_VERSION:
        raise StoreError(
            f"{path}: schema version {int(stated)}, this program knows up to {SCHEMA_VERSION}; use a later divideropt"
        )
    if int(stated) < SCHEMA_VERSION:
        raise StoreError(
            f"{path}: schema version {int(stated)}, this program writes {SCHEMA_VERSION}; go on with the divideropt "
            "that made it, or start anew (--fresh, which moves the old store aside)"
        )


def _meaning(words: Mapping[str, str]) -> str:
    return "; ".join(f"{word}: {says}" for word, says in words.items())


def deviation_of(objective: str) -> str:
    """Name the column that holds an objective's deviation."""
    return f"deviation_{objective}"


def _check_names(names: Iterable[str]) -> None:
    twice = [name for name, count in Counter(names).items() if count > 1]
    if twice:
        raise UsageError(
            f"{', '.join(twice)}: the model gives this name to a parameter or a quantity, and it is that of another "
            "column of the store; rename it in the model"
        )


def _ordered_quantities(problem: Problem) -> Iterable[tuple[str, Role]]:
    """Objectives first, then the constraints' quantities, then the rest."""
    roles = {o.quantity.name: Role.OBJECTIVE for o in problem.objectives}
    for constraint in problem.constraints:
        roles.setdefault(constraint.quantity.name, Role.CONSTRAINT)
    for name in problem.model.quantities:
        roles.setdefault(name, Role.QUANTITY)
    return roles.items()


def _text(name: str, role: Role, description: str = "") -> pa.Field:
    metadata = {"role": role} | ({"description": description} if description else {})
    return pa.field(name, pa.string(), nullable=False, metadata=metadata)


def _number(name: str, unit: str, symbol: str, description: str, role: Role, *, signed: bool = False) -> pa.Field:
    metadata = {"role": role, "unit": unit, "symbol": symbol, "description": description}
    if signed:
        metadata["objective"] = "acts on the magnitude; the column is signed"
    return pa.field(name, pa.float64(), metadata=metadata)


def _given_type(field: pa.Field) -> pa.DataType:
    """The type in which a column's values come: a logical quantity is 1 or 0 until it is in a table."""
    return pa.float64() if pa.types.is_boolean(field.type) else field.type


def _verdicts(table: pa.Table) -> list[Verdict]:
    """Read the verdicts, equal ones as one object: there are few."""
    outcomes, texts = (table[name].combine_chunks().dictionary_encode() for name in ("outcome", "outcome_text"))
    words = len(texts.dictionary)
    codes, places = np.unique(
        outcomes.indices.to_numpy().astype(np.int64) * words + texts.indices.to_numpy(), return_inverse=True
    )
    distinct = (divmod(code, words) for code in codes.tolist())
    found = [Verdict(Outcome(outcomes.dictionary[i].as_py()), texts.dictionary[j].as_py()) for i, j in distinct]
    return [found[place] for place in places.tolist()]


def _columns(names: tuple[str, ...], matrix: FloatArray) -> dict[str, FloatArray]:
    return {name: matrix[:, i] for i, name in enumerate(names)}


def _matrix(table: pa.Table, names: tuple[str, ...]) -> FloatArray:
    matrix = np.empty((table.num_rows, len(names)))
    for i, name in enumerate(names):
        matrix[:, i] = table[name].cast(pa.float64()).to_numpy()
    return matrix
