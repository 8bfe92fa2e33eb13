"""A dimension sheet for people: as text, and as a drawing with its table (SVG)."""

import html
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from divideropt.campaign.rounding import in_drawing_units
from divideropt.campaign.sheet import Sheet
from divideropt.models import Parameter, Quantity
from divideropt.models.dimensions import Dimension, Kind
from divideropt.report.display import Axis, axis_of, number, trimmed
from divideropt.report.sketch_layout import WIDTH, lay_out
from divideropt.report.sketch_svg import described, draw, light_style

DIGITS = 6
"""Significant digits of a dimension: a workshop's figures are exact to more than a simulation's."""

HEADINGS: Mapping[str, str] = {
    Kind.DIAMETER: "Diameters",
    Kind.LENGTH: "Lengths",
    Kind.ANGLE: "Angles",
    Kind.AREA: "Areas",
    Kind.VOLUME: "Volumes",
    Kind.MASS: "Masses",
    "parameter": "Parameters",
    "objective": "Objectives",
    "constraint": "Constraints",
    "outcome": "Outcome",
}
"""The sections of a sheet."""

LINE, TOP = 19.0, 74.0
"""Height of a table's line, and of the title block [px]."""


@dataclass(frozen=True)
class ShownLine:
    """A line in the unit shown: a text a column."""

    section: str
    words: str
    symbol: str
    unit: str
    texts: tuple[str, ...]
    note: str = ""


def sheet_text(found: Sheet) -> str:
    """Word a sheet as a table of text."""
    rows = shown_lines(found)
    widths = [max((len(getattr(row, key)) for row in rows), default=0) for key in ("words", "symbol")]
    columns = [max(len(row.texts[i]) for row in rows) for i in range(len(found.columns))]
    units = max(len(row.unit) for row in rows)
    said, section = [f"{title_of(found)}", ""], ""
    for row in rows:
        if row.section != section:
            section = row.section
            said.append(HEADINGS[section])
        numbers = "  ".join(f"{text:>{max(width, 7)}}" for text, width in zip(row.texts, columns, strict=True))
        cells = f"  {row.words:<{widths[0]}}  {row.symbol:<{widths[1]}}  {numbers}  {row.unit:<{units}}  {row.note}"
        said.append(cells.rstrip())
    return "\n".join(said) + "\n"


def sheet_svg(found: Sheet) -> str:
    """Draw a sheet: the design to scale, as rounded where it is, and the table beneath."""
    names = [d.name for d in found.model.dimensions.values()]
    both = {name: np.array([column.dimensions[name] for column in found.columns]) for name in names}
    drawing = lay_out(found.model.sketch, found.model.dimensions, both)
    shown = found.columns[-1]
    table, height = _table(found, drawing.height + TOP)
    whole = drawing.height + TOP + height
    words = f"{title_of(found)}: {described(drawing, shown.dimensions)}"
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" class="sketch" width="{WIDTH:g}" height="{whole:g}" '
        f'viewBox="0 0 {WIDTH:g} {whole:g}" role="img" aria-labelledby="sketch-title">'
        f'<title id="sketch-title">{html.escape(words)}</title><style>{light_style()}</style>'
        f'<rect width="100%" height="100%" fill="#ffffff"/>{_block(found)}'
        f'<g transform="translate(0 {TOP:g})">{draw(drawing, shown.dimensions)}</g>{table}</svg>\n'
    )


def shown_lines(found: Sheet) -> list[ShownLine]:
    """List a sheet's lines as they are shown: dimensions, variables and what rounding changed, criteria, outcome."""
    rows = []
    for kind in Kind:
        rows += [
            _line(kind, d, [c.dimensions[d.name] for c in found.columns], _mark(found, d.name))
            for d in found.model.dimensions.values()
            if d.listed and d.kind is kind
        ]
    variables = {v.parameter.name: v for v in found.problem.space.variables}
    for name, parameter in found.model.parameters.items():
        values = [column.parameters[name] for column in found.columns]
        if name in variables or len(set(values)) > 1:
            variable = variables.get(name)
            outside = variable is not None and not variable.lower <= values[-1] <= variable.upper
            rows.append(_line("parameter", parameter, values, "outside the campaign’s bounds" if outside else ""))
    for i, o in enumerate(found.problem.objectives):
        values, met = [column.objectives[i] for column in found.columns], found.columns[-1].met[i]
        axis = axis_of(o.quantity, values)
        note = "" if o.goal is None else f"goal {axis.bound(o.goal)}, {'met' if met else 'missed'}"
        rows.append(_line("objective", o.quantity, values, note))
    for i, c in enumerate(found.problem.constraints):
        values = [column.constraints[i] for column in found.columns]
        axis = axis_of(c.quantity, [v for v in (*values, c.minimum, c.maximum) if v is not None])
        bounds = {"at least": c.minimum, "at most": c.maximum}
        note = " and ".join(f"{word} {axis.bound(bound)}" for word, bound in bounds.items() if bound is not None)
        rows.append(_line("constraint", c.quantity, values, note))
    outcomes = tuple(str(column.verdict.outcome) for column in found.columns)
    rows.append(ShownLine("outcome", "outcome", "", "", outcomes, found.columns[-1].verdict.text))
    rows.append(ShownLine("outcome", "feasible", "", "", tuple("yes" if c.feasible else "no" for c in found.columns)))
    goals = sum(met is not None for met in found.exact.met)
    if goals:
        counts = tuple(f"{sum(met is True for met in c.met)} of {goals}" for c in found.columns)
        rows.append(ShownLine("outcome", "goals met", "", "", counts))
    if any(column.valid is not None for column in found.columns):
        vouched = tuple({True: "yes", False: "no", None: "–"}[column.valid] for column in found.columns)
        note = "beyond what the model assumes" if found.columns[-1].valid is False else ""
        rows.append(ShownLine("outcome", "within validity", "", "", vouched, note))
    return rows


def title_of(found: Sheet) -> str:
    """Say whose sheet it is, and how it is rounded."""
    design = f"design {found.design} of {found.campaign}" if found.design else f"a design of {found.campaign}"
    if found.step is None:
        return f"{design}, not rounded"
    return f"{design}, as it is and rounded to {in_drawing_units(found.step)}"


def _line(section: str, entry: Dimension | Parameter | Quantity, values: Sequence[float], note: str) -> ShownLine:
    axis: Axis = axis_of(entry, values)
    digits = DIGITS if isinstance(entry, Dimension) else 5
    texts = tuple(trimmed(number(axis.scaled(value), digits)) for value in values)
    return ShownLine(section, axis.words, axis.symbol.replace("^2", "²"), axis.shown.unit, texts, note)


def _mark(found: Sheet, name: str) -> str:
    return "rounded" if found.rounded is not None and name in found.names else ""


def _block(found: Sheet) -> str:
    title = html.escape(title_of(found))
    shown = "drawn as rounded" if found.rounded is not None else "drawn as it is"
    return (
        f'<text x="24" y="34" style="font-size: 19px; font-weight: 600">{title[:1].upper()}{title[1:]}</text>'
        f'<text class="note" x="24" y="56">Dimension sheet of divideropt, {shown}; hatched: schematic</text>'
    )


def _table(found: Sheet, top: float) -> tuple[str, float]:
    """Write the lines in two columns: dimensions, and what the design does."""
    rows = shown_lines(found)
    made = [row for row in rows if row.section in set(Kind)]
    does = [row for row in rows if row.section not in set(Kind)]
    parts, heights = [], []
    for x, lines in ((24.0, made), (520.0, does)):
        y, section = top + 24.0, ""
        heads = zip((x + 318.0, x + 398.0)[-len(found.columns) :], ("as it is", "rounded"), strict=False)
        parts += [
            f'<text class="note" x="{place:g}" y="{y - 12:g}" text-anchor="end">{word}</text>'
            for place, word in heads
        ]
        for row in lines:
            if row.section != section:
                section = row.section
                parts.append(f'<text class="title" x="{x:g}" y="{y + 6:g}">{HEADINGS[section]}</text>')
                parts.append(f'<path class="measure" d="M{x:g} {y + 12:g}h456"/>')
                y += LINE + 8.0
            cells = [(x, "start", row.words, ""), (x + 178.0, "start", row.symbol, "note")]
            places = (x + 318.0, x + 398.0)[-len(row.texts) :]
            cells += [(place, "end", text, "") for place, text in zip(places, row.texts, strict=True)]
            cells.append((x + 404.0, "start", row.unit, "note"))
            parts += [
                f'<text class="{style}" x="{place:g}" y="{y:g}" text-anchor="{anchor}">{html.escape(text)}</text>'
                for place, anchor, text, style in cells
                if text
            ]
            y += LINE
            if row.section in ("objective", "constraint", "parameter", "outcome") and row.note:
                note = html.escape(row.note[:72])
                parts.append(f'<text class="note" x="{x + 12:g}" y="{y - 3:g}">{note}</text>')
                y += LINE - 5.0
        heights.append(y)
    return "".join(parts), max(heights) - top + 20.0
