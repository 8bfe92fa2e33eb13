"""A table of designs to a table of what they do: the work of `divideropt evaluate`."""

import csv
import io
from array import array
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd

from divideropt.campaign.reader import MOST_MISTAKES
from divideropt.campaign.sections import nearest, show
from divideropt.campaign.textfile import read_text_file
from divideropt.errors import FileMistakes, Mistake, UsageError
from divideropt.models import Model, Parameter
from divideropt.models.base import FloatArray
from divideropt.problem import simulate
from divideropt.store.schema import STORED, deviation_of
from divideropt.units import parse_number

IDENTITY = "design_id"
"""A column that is passed through as it is."""

LARGEST_FILE = 64 * 2**20
"""Bytes: some hundred thousand designs of ten columns, and more than a table for people has."""

LONGEST_LINE = 100_000
"""Characters; a design of every parameter has some thousand."""


@dataclass(frozen=True)
class Designs:
    """Designs as a file gives them.

    Attributes:
        given: The parameters that have a column, in the file's order.
        values: One row a design, one column each, in the parameters' units, shape (n, len(given)).
        identities: The column `design_id`, or None.
        passed_over: The columns that say what came out of a design before, of which nothing was read.
    """

    given: tuple[str, ...]
    values: FloatArray
    identities: tuple[str, ...] | None
    passed_over: tuple[str, ...] = ()


def read_designs(path: Path, parameters: Sequence[Parameter], results: Collection[str] = ()) -> Designs:
    """Read a CSV file whose columns are parameters by name, in the parameters' units.

    Args:
        path: The file.
        parameters: What may be a column.
        results: What may be a column too, and is passed over: `result_columns` of the model.

    Returns:
        The designs in the file's order.

    Raises:
        UsageError: The file cannot be read.
        FileMistakes: Every unknown column, empty cell and value out of its domain, with row and column.
    """
    text = read_text_file(path, LARGEST_FILE, "table of designs")
    if not text.strip():
        raise UsageError(f"{path}: the file is empty; its first line must name the columns")
    return parse_designs(text, str(path), parameters, results)


def result_columns(model: Model) -> frozenset[str]:
    """Name the columns that a table has once its designs were simulated, in a store or by `divideropt evaluate`."""
    return frozenset((*STORED, *model.quantities, *map(deviation_of, model.quantities)))


def parse_designs(text: str, path: str, parameters: Sequence[Parameter], results: Collection[str] = ()) -> Designs:
    """Read designs from CSV; `path` names it in mistakes. Otherwise as `read_designs`.

    Every cell is data: of `design_id` any text, a formula too, and of a parameter a plain decimal number.
    """
    known = {p.name: p for p in parameters}
    rows = _rows(text, path)
    _, header = next(rows)
    _check_header(path, header, known, results)
    given = tuple(name for name in header if name in known)
    values, identities = array("d"), []
    mistakes: list[Mistake] = []
    for line, row in rows:
        values.extend(_read_row(line, row, header, known, mistakes))
        identities += [cell for name, cell in zip(header, row, strict=False) if name == IDENTITY]
        if len(mistakes) >= MOST_MISTAKES:
            mistakes.append(Mistake(line + 1, 1, "from here on nothing was read, after so many mistakes"))
            break
    if mistakes:
        raise FileMistakes(path, mistakes)
    matrix = np.array(values, dtype=np.float64).reshape(-1, len(given)) if given else np.empty((len(identities), 0))
    passed = tuple(name for name in header if name not in known and name in results)
    return Designs(given, matrix, tuple(identities) if IDENTITY in header else None, passed)


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


def _rows(text: str, path: str) -> Iterator[tuple[int, list[str]]]:
    """Yield each row with the line where it begins; blank lines at the end are none."""
    reader = csv.reader(_lines(text, path), strict=True)
    blank: list[int] = []
    while True:
        begin = reader.line_num + 1
        try:
            row = next(reader, None)
        except csv.Error as error:
            sentence = f"the row that begins here is not CSV ({error}); mend its quotes"
            raise FileMistakes(path, [Mistake(begin, 1, sentence)]) from None
        if row is None:
            return
        if not row:
            blank.append(begin)
            continue
        yield from ((line, []) for line in blank)
        blank = []
        yield begin, row


def _lines(text: str, path: str) -> Iterator[str]:
    for number, line in enumerate(io.StringIO(text, newline=""), start=1):
        if len(line) > LONGEST_LINE:
            sentence = f"the line has {len(line)} characters, the most permitted are {LONGEST_LINE}; break it"
            raise FileMistakes(path, [Mistake(number, 1, sentence)])
        yield line


def _check_header(path: str, header: list[str], known: Mapping[str, Parameter], results: Collection[str]) -> None:
    if not header:
        raise FileMistakes(path, [Mistake(1, 1, "the first line is blank, and must name the columns; delete it")])
    mistakes: list[Mistake] = []
    seen: set[str] = set()
    for column, name in enumerate(header, start=1):
        if len(mistakes) >= MOST_MISTAKES:
            mistakes.append(Mistake(1, column, "from here on no column was judged, after so many mistakes"))
            break
        if name in seen:
            mistakes.append(
                Mistake(1, column, f"the column {show(name)} is here a second time; delete one of the two")
            )
        elif name not in known and name != IDENTITY and name not in results:
            meant = nearest(name, (IDENTITY, *known))
            listed = f"use {IDENTITY}, or one of {', '.join(known)}" if not mistakes else "rename or delete it"
            sentence = f"the column {show(name)} is no parameter; {f'did you mean {meant}?' if meant else listed}"
            mistakes.append(Mistake(1, column, sentence))
        seen.add(name)
    if mistakes:
        raise FileMistakes(path, mistakes)


def _read_row(
    line: int, row: list[str], header: list[str], known: dict[str, Parameter], mistakes: list[Mistake]
) -> list[float]:
    if not row:
        mistakes.append(Mistake(line, 1, "the line is empty, and not the last; delete it"))
        return []
    if len(row) != len(header):
        sentence = f"the row has {len(row)} cells, the header {len(header)}; fill it up, or mend the quotes"
        mistakes.append(Mistake(line, 1, sentence))
        return []
    numbers = []
    for column, (name, cell) in enumerate(zip(header, row, strict=True), start=1):
        if name == IDENTITY:
            if "\0" in cell:
                mistakes.append(Mistake(line, column, f"{IDENTITY} has the character U+0000 in it; delete it"))
            continue
        if name not in known:  # a result
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
        value = parse_number(cell)
    except ValueError:
        raise ValueError(f"{parameter.name} is {show(cell)}, not a number; give one{unit}, such as 1.5e-3") from None
    if not parameter.domain.contains(value):
        raise ValueError(f"{parameter.name} is {value:g}, but must be {parameter.domain}{unit}")
    return value
