"""Dimension sheets in a report: of the designs whose step responses it holds, as they are and rounded."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from divideropt.campaign.plan import dimensioned, dividers
from divideropt.campaign.rounding import Judged, judge, rounded_design, rounded_names
from divideropt.models import Parameter, Quantity
from divideropt.models.dimensions import Dimension, Dimensioned, Kind
from divideropt.models.uncertain import Uncertain
from divideropt.problem import Problem, one_thread
from divideropt.report.display import axis_of, rounded
from divideropt.report.front import Design
from divideropt.report.sheet_text import DIGITS, HEADINGS

STEPS = (1e-5, 1e-4, 5e-4)
"""To multiples of which the designs are rounded [m]: ground, milled, and as coarse as one may want it."""

MOST_SIMULATED = 4000
"""Simulations that the sheets of a report may cost, each some 0.1 ms; scenarios and samples count."""


@dataclass(frozen=True)
class SheetLine:
    """A line of every sheet: what it holds, how it is shown, and the goal of an objective."""

    section: str
    entry: Dimension | Parameter | Quantity
    goal: float | None = None


@dataclass(frozen=True)
class Sheets:
    """Sheets of some designs.

    Attributes:
        steps: To what they are rounded [m].
        lines: What they list.
        rounded: Names of the dimensions that are rounded.
        designs: By id the design as it is, then a step each as rounded; a sentence where that makes no valve.
    """

    steps: tuple[float, ...]
    lines: tuple[SheetLine, ...]
    rounded: tuple[str, ...]
    designs: Mapping[str, tuple[Judged | str, ...]]


def read_sheets(problem: Problem, designs: Sequence[Design]) -> Sheets | None:
    """Round designs, and simulate them as they are and rounded.

    Args:
        problem: What was optimised.
        designs: Those that may have a sheet, the first ones first.

    Returns:
        The sheets, as many as `MOST_SIMULATED` allows; None where that is none, or the model offers no dimensions.
    """
    model = dimensioned(problem.model)
    if model is None:
        return None
    samples = 1 + problem.model.samples if isinstance(problem.model, Uncertain) else 1
    weight = samples * max(1, len(dividers(problem.model)))
    chosen = designs[: MOST_SIMULATED // (weight * (1 + len(STEPS)))]
    if not chosen:
        return None
    asked: list[dict[str, float]] = []
    places: dict[str, list[int | str]] = {}
    for design in chosen:
        parameters = dict(problem.fixed) | dict(zip(problem.space.names, design.variables, strict=True))
        places[design.design_id] = [len(asked)]
        asked.append(parameters)
        for step in STEPS:
            try:
                made = rounded_design(problem, model, parameters, step)
            except ValueError as error:
                places[design.design_id].append(str(error))
                continue
            places[design.design_id].append(len(asked))
            asked.append(made)
    with one_thread():
        judged = judge(problem, model, asked)
    found = {
        name: tuple(judged[place] if isinstance(place, int) else place for place in row)
        for name, row in places.items()
    }
    return Sheets(STEPS, tuple(_lines(problem, model, judged)), rounded_names(problem, model), found)


def sheets_payload(found: Sheets) -> dict[str, Any]:
    """Word the sheets for the page's script: values in the units shown, those that never vary once."""
    every = [column for columns in found.designs.values() for column in columns if not isinstance(column, str)]
    values = np.array([_values(found, column) for column in every]).reshape(len(every), len(found.lines))
    lines: list[dict[str, Any]] = []
    constant: list[bool] = []
    for i, line in enumerate(found.lines):
        axis = axis_of(line.entry, values[:, i])
        same = bool((values[:, i] == values[:1, i]).all())
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

    def column(judged: Judged | str) -> dict[str, Any]:
        if isinstance(judged, str):
            return {"error": judged}
        numbers = zip(_values(found, judged), scales, constant, strict=True)
        said = {"outcome": str(judged.verdict.outcome), "text": judged.verdict.text, "feasible": judged.feasible}
        said["valid"] = judged.valid
        return said | {"values": [_short(value * scale) for value, scale, same in numbers if not same]}

    return {
        "steps": [f"{step * 1e3:g} mm" for step in found.steps],
        "lines": lines,
        "varying": [i for i, same in enumerate(constant) if not same],
        "designs": {name: [column(judged) for judged in columns] for name, columns in found.designs.items()},
    }


def _lines(problem: Problem, model: Dimensioned, judged: Sequence[Judged]) -> list[SheetLine]:
    lines = [SheetLine(kind, d) for kind in Kind for d in model.dimensions.values() if d.listed and d.kind is kind]
    varies = {name for name in model.parameters if len({column.parameters[name] for column in judged}) > 1}
    varies |= set(problem.space.names)
    lines += [SheetLine("parameter", p) for name, p in model.parameters.items() if name in varies]
    lines += [SheetLine("objective", o.quantity, o.goal) for o in problem.objectives]
    return lines + [SheetLine("constraint", c.quantity) for c in problem.constraints]


def _values(found: Sheets, judged: Judged) -> list[float]:
    """A design's values, a line each, in the platform's units."""
    sections = [line.section for line in found.lines]
    made = [
        judged.parameters[line.entry.name] if line.section == "parameter" else judged.dimensions[line.entry.name]
        for line in found.lines[: sections.index("objective")]
    ]
    return [*made, *judged.objectives, *judged.constraints]


def _short(value: float) -> float | None:
    return rounded(value, DIGITS) if np.isfinite(value) else None
