"""A design's dimension sheet: the work of `divideropt sheet`."""

import re
import shlex
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pandas as pd

from divideropt.campaign.branches import stored_runs
from divideropt.campaign.config import Campaign
from divideropt.campaign.dump import dump_settings
from divideropt.campaign.load import default_campaign, load_campaign, stored_campaign
from divideropt.campaign.plan import build_problem, dimensioned, dividers
from divideropt.campaign.rounding import Judged, in_drawing_units, judge, rounded_design, rounded_names
from divideropt.campaign.sections import show
from divideropt.campaign.simulate import read_settings
from divideropt.errors import UsageError
from divideropt.models.base import VALIDITY
from divideropt.models.dimensions import Dimensioned, Kind
from divideropt.problem import Problem
from divideropt.store import Store, TableSchema
from divideropt.units import format_measure, parse_measure

_ID = re.compile(r"([a-z0-9_]{1,64}-[0-9]{1,20}(?:-branch-[0-9]{1,20})?)/([0-9]{1,18})", re.ASCII)

UNIT = "m"
"""Of a step."""


@dataclass(frozen=True)
class Sheet:
    """A design's dimensions, and the same rounded.

    Attributes:
        campaign: The campaign's name.
        design: The design's id, or "" where it has none.
        problem: What the design was judged in.
        model: Whose dimensions.
        step: To multiples of which the dimensions are rounded [m]; None where they are not.
        exact: The design as it is.
        rounded: As rounded; None without a step.
        names: The dimensions that are rounded.
    """

    campaign: str
    design: str
    problem: Problem
    model: Dimensioned
    step: float | None
    exact: Judged
    rounded: Judged | None
    names: tuple[str, ...]

    @property
    def columns(self) -> tuple[Judged, ...]:
        """What the sheet compares: the design, and if asked for the rounded one."""
        return (self.exact,) if self.rounded is None else (self.exact, self.rounded)


@dataclass(frozen=True)
class Line:
    """A line of a sheet: a value a column, in the unit; NaN where not defined."""

    section: str
    name: str
    symbol: str
    unit: str
    values: tuple[float, ...]
    note: str = ""


def sheet(
    source: Path | Campaign | None, design: str | None = None, settings: Sequence[str] = (), step: str | None = None
) -> Sheet:
    """Measure a design, round its dimensions, and simulate both.

    Args:
        source: A store, or a campaign or its file; the campaign that ships with the package where not given.
        design: Of a store, which of its designs: `<run>/<index>`.
        settings: `NAME=VALUE` with a unit, for parameters that differ.
        step: To multiples of what the dimensions are rounded, `0.1 mm`; not at all where not given.

    Returns:
        The sheet.

    Raises:
        UsageError: There is no such design, a setting or the step is wrong, or the model has no dimensions.
        FileMistakes: The campaign cannot be read.
        StoreError: The store is damaged.
    """
    campaign, given = _found(source, design)
    problem = build_problem(campaign)
    model = dimensioned(problem.model)
    if model is None:
        raise UsageError(
            "this campaign's model offers no dimensions, so there is no sheet; see `divideropt evaluate`"
        )
    parameters = dict(problem.fixed) | given | read_settings(settings, model.parameters)
    width = None if step is None else _step(step)
    designs = [parameters]
    if width is not None:
        try:
            designs.append(rounded_design(problem, model, parameters, width))
        except ValueError as error:
            raise UsageError(f"--step {show(step)}: {error}") from None
    exact, *rounded = judge(problem, model, designs)
    names = rounded_names(problem, model)
    return Sheet(campaign.name, design or "", problem, model, width, exact, next(iter(rounded), None), names)


def lines(found: Sheet) -> Iterator[Line]:
    """List a sheet's lines: dimensions by their kind, parameters, objectives, constraints."""
    for kind in Kind:
        for d in found.model.dimensions.values():
            if d.listed and d.kind is kind:
                values = tuple(column.dimensions[d.name] for column in found.columns)
                yield Line(kind, d.name, d.symbol, d.unit, values, _treatment(found, d.name))
    for name, parameter in found.model.parameters.items():
        values = tuple(column.parameters[name] for column in found.columns)
        yield Line("parameter", name, parameter.symbol, parameter.unit, values, _within(found, name, values[-1]))
    for i, o in enumerate(found.problem.objectives):
        values = tuple(column.objectives[i] for column in found.columns)
        met = found.columns[-1].met[i]
        note = "" if met is None else f"goal {o.goal:g} {o.quantity.unit}".rstrip() + (", met" if met else ", missed")
        yield Line("objective", o.quantity.name, o.quantity.symbol, o.quantity.unit, values, note)
    for i, c in enumerate(found.problem.constraints):
        values = tuple(column.constraints[i] for column in found.columns)
        bounds = {"at least": c.minimum, "at most": c.maximum}
        limits = " and ".join(f"{word} {bound:g}" for word, bound in bounds.items() if bound is not None)
        kept = (c.minimum is None or values[-1] >= c.minimum) and (c.maximum is None or values[-1] <= c.maximum)
        note = f"{limits} {c.quantity.unit}".rstrip() + (", kept" if kept else ", broken")
        yield Line("constraint", c.quantity.name, c.quantity.symbol, c.quantity.unit, values, note)


def sheet_table(found: Sheet) -> pd.DataFrame:
    """Return a row a line in SI: section, name, symbol, unit, exact, rounded (with a step), note."""
    titles = ("exact", "rounded")[: len(found.columns)]
    rows: list[dict[str, Any]] = [
        {
            "section": line.section,
            "name": line.name,
            "symbol": line.symbol,
            "unit": line.unit,
            **dict(zip(titles, line.values, strict=True)),
            "note": line.note,
        }
        for line in lines(found)
    ]
    for name, values, note in _outcome(found):
        rows.append(
            {"section": "outcome", "name": name, "symbol": "", "unit": "", **dict(zip(titles, values, strict=True))}
            | {"note": note}
        )
    columns = ["section", "name", "symbol", "unit", *titles, "note"]
    return pd.DataFrame(rows, columns=columns).astype(dict.fromkeys(titles, object))


def sheet_yaml(found: Sheet) -> str:
    """Return what a campaign's `model` may have as `set`, as the report's page saves a design: read back to the bit.

    It has the variables, and what else the last column's design has otherwise than the campaign. For the divider a
    comment has the line that simulates it.
    """
    design = found.columns[-1].parameters
    variables = found.problem.space.names
    chosen = {n: v for n, v in design.items() if n in variables or v != found.problem.fixed[n]}
    what = f"design {found.design} of campaign" if found.design else "a design of campaign"
    rounded = "" if found.step is None else f", rounded to {in_drawing_units(found.step)}"
    said = [f"# {what} {found.campaign}{rounded}"]
    if dividers(found.problem.model):
        settings = (f"{n}={format_measure(v, found.model.parameters[n].unit)}" for n, v in chosen.items())
        options = " ".join(f"--set {shlex.quote(setting)}" for setting in settings)
        said.append(f"# divideropt simulate campaign.yaml {options}")
    return "\n".join(said) + "\n" + dump_settings(chosen, found.model.parameters)


def sheet_data(found: Sheet) -> dict[str, Any]:
    """Return a sheet as plain data for a program."""
    titles = ("exact", "rounded")[: len(found.columns)]
    sections: dict[str, dict[str, Any]] = {"dimension": {}, "parameter": {}, "objective": {}, "constraint": {}}
    for line in lines(found):
        place = line.section if line.section in sections else "dimension"
        entry: dict[str, Any] = {"kind": str(line.section)} if place == "dimension" else {}
        entry |= {"unit": line.unit, **dict(zip(titles, line.values, strict=True))}
        sections[place][line.name] = entry | ({"note": line.note} if line.note else {})
    return {
        "campaign": found.campaign,
        "design": found.design or None,
        "step": found.step,
        "rounded_dimensions": list(found.names) if found.rounded is not None else [],
        **{f"{name}s": entries for name, entries in sections.items()},
        **{
            title: {
                "outcome": str(column.verdict.outcome),
                "text": column.verdict.text,
                "feasible": column.feasible,
                "goals_met": sum(met is True for met in column.met),
                VALIDITY: column.valid,
            }
            for title, column in zip(titles, found.columns, strict=True)
        },
        "goals": sum(met is not None for met in found.exact.met),
    }


def _outcome(found: Sheet) -> Iterator[tuple[str, tuple[str, ...], str]]:
    columns = found.columns
    yield "outcome", tuple(str(c.verdict.outcome) for c in columns), columns[-1].verdict.text
    yield "feasible", tuple("yes" if c.feasible else "no" for c in columns), ""
    goals = sum(met is not None for met in found.exact.met)
    if goals:
        yield "goals_met", tuple(f"{sum(met is True for met in c.met)} of {goals}" for c in columns), ""
    if any(c.valid is not None for c in columns):
        yield VALIDITY, tuple("" if c.valid is None else "yes" if c.valid else "no" for c in columns), ""


def _treatment(found: Sheet, name: str) -> str:
    """How a dimension comes to its value in the rounded design."""
    if found.rounded is None:
        return ""
    if name in found.names:
        return "rounded"
    return "held" if found.rounded.dimensions[name] == found.exact.dimensions[name] else "follows"


def _within(found: Sheet, name: str, value: float) -> str:
    """Say so of a variable, and if rounding took it out of the campaign's bounds."""
    for variable in found.problem.space.variables:
        if variable.parameter.name == name:
            bounds = f"{variable.lower:g} to {variable.upper:g} {variable.parameter.unit}".rstrip()
            return f"variable, {'within' if variable.lower <= value <= variable.upper else 'outside'} {bounds}"
    return ""


def _found(source: Path | Campaign | None, design: str | None) -> tuple[Campaign, dict[str, float]]:
    """Return the campaign, and the variables of a store's design."""
    if isinstance(source, Path) and source.is_dir():
        store = Store(source)
        campaign = stored_campaign(store)
        if design is None:
            raise UsageError(
                f"{source} is a store: say which of its designs, such as nsga2-1/310; the report's table and "
                "fronts/combined.parquet name those of the front"
            )
        return campaign, _stored(store, campaign, design)
    if design is not None:
        where = f"{source} is no store's folder" if isinstance(source, Path) else "none is given"
        raise UsageError(f"{show(design)}: a design's id is one of a store, and {where}; give the store first")
    if isinstance(source, Path):
        return load_campaign(source), {}
    return (default_campaign() if source is None else source), {}


def _stored(store: Store, campaign: Campaign, design: str) -> dict[str, float]:
    """Read a design's variables from the log of its run."""
    match = _ID.fullmatch(design)
    if match is None:
        raise UsageError(f"{show(design)} is no design's id: one is <run>/<index>, such as nsga2-1/310")
    schema = TableSchema.of(build_problem(campaign))
    run, index, first = match[1], int(match[2]), 0
    for table in store.log(run, schema).read():
        if index < first + table.num_rows:
            row = table.slice(index - first, 1)
            return {name: float(row[name][0].as_py()) for name in schema.variables}
        first += table.num_rows
    if first == 0:
        runs = ", ".join(run.name for run in stored_runs(campaign, store))
        held = f"the store {store.folder} has no evaluation of a run {run}"
        raise UsageError(f"{show(design)}: {held}; its runs are {runs}")
    held = f"the store {store.folder} has {first} evaluations of run {run}, {run}/0 to {run}/{first - 1}"
    raise UsageError(f"{show(design)}: {held}; name one of them")


def _step(text: str) -> float:
    try:
        width = parse_measure(text, UNIT)
    except ValueError:
        width = 0.0
    if width <= 0.0:
        raise UsageError(f"--step {show(text)} is no length above 0; write a number with its unit, such as '0.1 mm'")
    return width
