"""A table of designs to a table of what they do: the work of `divideropt evaluate`."""

import csv
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from divideropt.errors import FileMistakes, Mistake, UsageError
from divideropt.models import Model, Parameter
from divideropt.models.base import FloatArray
from divideropt.problem import simulate

IDENTITY = "design_id"
"""A column that is passed through as it is."""


@dataclass(frozen=True)
class Designs:
    """Designs as a file gives them.

    Attributes:
        given: The parameters that have a column, in the file's order.
        values: One row a design, one column each, in the parameters' units, shape (n, len(given)).
        identities: The column `design_id`, or None.
    """

    given: tuple[str, ...]
    values: FloatArray
    identities: tuple[str, ...] | None


def read_designs(path: Path, parameters: Sequence[Parameter]) -> Designs:
    """Read a CSV file whose columns are parameters by name, in the parameters' units.

    Args:
        path: The file.
        parameters: What may be a column.

    Returns:
        The designs in the file's order.

    Raises:
        UsageError: The file cannot be read.
        FileMistakes: Every unknown column, empty cell and value out of its domain, with row and column.
    """
    known = {p.name: p for p in parameters}
    try:
        with path.open(encoding="utf-8-sig", newline="") as file:
            reader = csv.reader(file, strict=True)
            header = next(reader, [])
            _check_header(path, header, known)
            rows = [(reader.line_num, row or [""]) for row in reader]
    except OSError as error:
        raise UsageError(f"{path}: {error.strerror}; name a readable CSV file of designs") from error
    except (UnicodeDecodeError, csv.Error) as error:
        raise UsageError(f"{path}: not a CSV file in UTF-8 ({error}); save it as one") from error
    while rows and rows[-1][1] == [""]:
        rows.pop()  # blank lines at the end are no designs
    mistakes: list[Mistake] = []
    values = [_read_row(line, row, header, known, mistakes) for line, row in rows]
    if mistakes:
        raise FileMistakes(str(path), mistakes)
    given = tuple(name for name in header if name != IDENTITY)
    matrix = np.array(values, dtype=np.float64).reshape(len(values), len(given))
    identities = None
    if IDENTITY in header:
        place = header.index(IDENTITY)
        identities = tuple(row[place] for _, row in rows)
    return Designs(given, matrix, identities)


def evaluate_designs(designs: Designs, model: Model, fixed: dict[str, float]) -> pd.DataFrame:
    """Simulate designs.

    Args:
        designs: What to simulate.
        model: By what.
        fixed: Every parameter by name; the designs' columns replace theirs.

    Returns:
        A row a design, in the designs' order: `design_id` if given, the columns given, every quantity, `outcome`,
        `outcome_text`.
    """
    quantities, verdicts = simulate(model, fixed, designs.given, designs.values)
    table = pd.DataFrame(designs.values, columns=list(designs.given))
    if designs.identities is not None:
        table.insert(0, IDENTITY, list(designs.identities))
    results = pd.DataFrame(quantities, columns=list(model.quantities))
    results["outcome"] = [str(v.outcome) for v in verdicts]
    results["outcome_text"] = [v.text for v in verdicts]
    return pd.concat([table, results], axis=1)


def _check_header(path: Path, header: list[str], known: dict[str, Parameter]) -> None:
    if not header:
        raise UsageError(f"{path}: the file is empty; its first line must name the columns")
    mistakes = []
    for column, name in enumerate(header, start=1):
        if name in header[: column - 1]:
            mistakes.append(Mistake(1, column, f"the column {name!r} is here a second time; delete one of the two"))
        elif name not in known and name != IDENTITY:
            sentence = f"the column {name!r} is no parameter; use {IDENTITY}, or one of {', '.join(known)}"
            mistakes.append(Mistake(1, column, sentence))
    if mistakes:
        raise FileMistakes(str(path), mistakes)


def _read_row(
    line: int, row: list[str], header: list[str], known: dict[str, Parameter], mistakes: list[Mistake]
) -> list[float]:
    if len(row) != len(header):
        sentence = f"the row has {len(row)} cells, the header {len(header)}; fill it up, or mend the quotes"
        mistakes.append(Mistake(line, 1, sentence))
        return []
    numbers = []
    for column, (name, cell) in enumerate(zip(header, row, strict=True), start=1):
        if name == IDENTITY:
            continue
        try:
            numbers.append(_read_cell(known[name], cell))
        except ValueError as error:
            mistakes.append(Mistake(line, column, str(error)))
    return numbers


def _read_cell(parameter: Parameter, cell: str) -> float:
    unit = f" in {parameter.unit}" if parameter.unit else ""
    if not cell.strip():
        raise ValueError(f"{parameter.name} is empty; give a number{unit}, or leave the column out altogether")
    try:
        value = float(cell)
    except ValueError:
        raise ValueError(f"{parameter.name} is {cell!r}, not a number; give one{unit}") from None
    if not parameter.domain.contains(value):
        raise ValueError(f"{parameter.name} is {value:g}, but must be {parameter.domain}{unit}")
    return value
