"""Dimension sheets in a report: of the designs that it shows closely, as they are and rounded."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import count
from typing import Any

import numpy as np

from divideropt.campaign.plan import dimensioned, dividers
from divideropt.campaign.rounding import Judged, dimensions_of, judge, judged, rounded_design, rounded_names
from divideropt.models import Parameter, Quantity
from divideropt.models.dimensions import Dimension, Dimensioned, Kind
from divideropt.models.uncertain import Uncertain
from divideropt.problem import Evaluations, Problem, one_thread
from divideropt.report.display import axis_of, rounded
from divideropt.report.front import Design
from divideropt.report.sheet_text import DIGITS, HEADINGS

STEPS = (1e-5, 1e-4, 5e-4)
"""To multiples of which the designs are rounded [m]: ground, milled, and as coarse as one may want it."""

FIRST = 1e-4
"""The step that a page begins with, and that is simulated first."""

MOST_SIMULATED = 20_000
"""Simulations that the sheets of a report may cost, each some 0.2 ms; scenarios and samples count."""


@dataclass(frozen=True)
class SheetLine:
    """A line of every sheet: what it holds, how it is shown, and the goal of an objective."""

    section: str
    entry: Dimension | Parameter | Quantity
    goal: float | None = None


@dataclass(frozen=True)
class Column:
    """A design as it is or as rounded.

    Attributes:
        parameters: Every parameter by name.
        dimensions: Every dimension by name.
        judged: What it does; None where it was not simulated.
    """

    parameters: Mapping[str, float]
    dimensions: Mapping[str, float]
    judged: Judged | None


@dataclass(frozen=True)
class Sheets:
    """Sheets of some designs.

    Attributes:
        steps: To what they are rounded [m].
        lines: What they list.
        rounded: Names of the dimensions that are rounded.
        designs: By id the design as it is, then a step each as rounded; a sentence where that makes no valve.
        weight: Simulations that a rounded design costs; 0 where the page makes none, the model being somebody's own.
    """

    steps: tuple[float, ...]
    lines: tuple[SheetLine, ...]
    rounded: tuple[str, ...]
    designs: Mapping[str, tuple[Column | str, ...]]
    weight: int

    @property
    def simulated(self) -> tuple[int, ...]:
        """Of how many designs it is known what they do rounded, a step each; what makes no valve is known."""
        columns = list(zip(*self.designs.values(), strict=True))[1:]
        return tuple(sum(isinstance(c, str) or c.judged is not None for c in column) for column in columns)

    @property
    def columns(self) -> list[Column]:
        """All columns that there are."""
        return [column for row in self.designs.values() for column in row if not isinstance(column, str)]

    @property
    def valves(self) -> list[Column]:
        """The rounded ones among them."""
        return [column for row in self.designs.values() for column in row[1:] if not isinstance(column, str)]


def read_sheets(problem: Problem, designs: Sequence[Design], known: Evaluations) -> Sheets | None:
    """Round designs, and simulate the rounded ones as far as `MOST_SIMULATED` goes, `FIRST` before others.

    Args:
        problem: What was optimised.
        designs: Those that have a sheet, the first ones first.
        known: What came out of them, in their order.

    Returns:
        The sheets; None where there is no design, or the model offers no dimensions.
    """
    model = dimensioned(problem.model)
    if model is None or not designs:
        return None
    exact = [dict(problem.fixed) | dict(zip(problem.space.names, d.variables, strict=True)) for d in designs]
    made = [[_made(problem, model, parameters, step) for step in STEPS] for parameters in exact]
    weight = _weight(problem)
    places = sorted(np.ndindex(len(made), len(STEPS)), key=lambda place: STEPS[place[1]] != FIRST)
    valves = {(i, k): valve for i, k in places if not isinstance(valve := made[i][k], str)}
    asked = list(valves)[: MOST_SIMULATED // weight if weight else 0]
    with one_thread():
        results = dict(zip(asked, judge(problem, model, [valves[place] for place in asked]), strict=True))
    rows = {}
    for i, (design, result) in enumerate(zip(designs, judged(problem, model, exact, known), strict=True)):
        columns = [_column(model, made[i][k], results.get((i, k))) for k in range(len(STEPS))]
        rows[design.design_id] = (Column(result.parameters, result.dimensions, result), *columns)
    sheets = Sheets(STEPS, (), rounded_names(problem, model), rows, weight)
    return replace(sheets, lines=tuple(_lines(problem, model, sheets.columns)))


def sheets_payload(found: Sheets) -> dict[str, Any]:
    """Word the sheets for the page's script: values in the units shown, those that never vary once.

    A rounded column has its `row` among the `valves`, which the drawing has after the page's designs.
    """
    values = np.array([_values(found, column) for column in found.columns]).reshape(-1, len(found.lines))
    lines: list[dict[str, Any]] = []
    constant: list[bool] = []
    for i, line in enumerate(found.lines):
        axis = axis_of(line.entry, values[:, i])
        same = bool((values[:, i] == values[:1, i]).all())  # where one is not known, it is not
        constant.append(same)
        lines.append(
            {
                "section": HEADINGS[line.section],
                "name": line.entry.name,
                "words": axis.words,
                "symbol": axis.symbol.replace("^2", "²"),
                "unit": axis.unit,
                "shown": axis.shown.unit,
                "scale": axis.shown.scale,
                "goal": line.goal,
                "value": _short(values[0, i] * axis.shown.scale) if same and len(values) else None,
            }
        )
    scales = [line["scale"] for line in lines]

    def column(made: Column | str) -> dict[str, Any]:
        if isinstance(made, str):
            return {"error": made}
        numbers = zip(_values(found, made), scales, constant, strict=True)
        values = [_short(value * scale) for value, scale, same in numbers if not same]
        if made.judged is None:
            return {"values": values}
        verdict = made.judged.verdict
        said = {"outcome": str(verdict.outcome), "text": verdict.text, "feasible": made.judged.feasible}
        return {"values": values, **said, "valid": made.judged.valid}

    rows = count()

    def valve(made: Column | str) -> dict[str, Any]:
        return column(made) if isinstance(made, str) else {"row": next(rows), **column(made)}

    return {
        "steps": [f"{step * 1e3:g} mm" for step in found.steps],
        "lines": lines,
        "varying": [i for i, same in enumerate(constant) if not same],
        "designs": {name: [column(row[0]), *map(valve, row[1:])] for name, row in found.designs.items()},
    }


def _made(
    problem: Problem, model: Dimensioned, parameters: Mapping[str, float], step: float
) -> dict[str, float] | str:
    """Round a design, or say why that makes no valve."""
    try:
        return rounded_design(problem, model, parameters, step)
    except ValueError as error:
        return str(error)


def _column(model: Dimensioned, made: dict[str, float] | str, found: Judged | None) -> Column | str:
    if isinstance(made, str):
        return made
    return Column(made, found.dimensions if found else dimensions_of(model, [made])[0], found)


def _weight(problem: Problem) -> int:
    """How many simulations a design takes; 0 where nobody knows how long they last."""
    samples = 1 + problem.model.samples if isinstance(problem.model, Uncertain) else 1
    return samples * len(dividers(problem.model))


def _lines(problem: Problem, model: Dimensioned, columns: Sequence[Column]) -> list[SheetLine]:
    lines = [SheetLine(kind, d) for kind in Kind for d in model.dimensions.values() if d.listed and d.kind is kind]
    varies = {name for name in model.parameters if len({column.parameters[name] for column in columns}) > 1}
    varies |= set(problem.space.names)
    lines += [SheetLine("parameter", p) for name, p in model.parameters.items() if name in varies]
    lines += [SheetLine("objective", o.quantity, o.goal) for o in problem.objectives]
    return lines + [SheetLine("constraint", c.quantity) for c in problem.constraints]


def _values(found: Sheets, column: Column) -> list[float]:
    """A design's values, a line each, in the platform's units; NaN where it was not simulated."""
    sections = [line.section for line in found.lines]
    made = [
        column.parameters[line.entry.name] if line.section == "parameter" else column.dimensions[line.entry.name]
        for line in found.lines[: sections.index("objective")]
    ]
    if column.judged is None:
        return made + [np.nan] * (len(found.lines) - len(made))
    return [*made, *column.judged.objectives, *column.judged.constraints]


def _short(value: float) -> float | None:
    return rounded(value, DIGITS) if np.isfinite(value) else None
