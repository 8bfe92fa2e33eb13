"""The report's tables, as headings and cells of text."""

from collections.abc import Sequence
from dataclasses import dataclass

from divideropt.analysis import Kkt, Verified
from divideropt.models import Outcome
from divideropt.report.data import ReportData
from divideropt.report.display import number, share
from divideropt.report.front import Design

LAST = "1e300"
"""What a cell without a number is sorted by: beyond all that have one."""


@dataclass(frozen=True)
class Heading:
    """A column: its words, symbol and unit, what it is, and whether it holds numbers."""

    words: str
    detail: str = ""
    title: str = ""
    numeric: bool = True


@dataclass(frozen=True)
class Cell:
    """A cell: its text, what to sort by, if a goal is met there, None where there is none, and if it is the worst."""

    text: str
    order: str = ""
    met: bool | None = None
    worst: bool = False


@dataclass(frozen=True)
class Row:
    """A row: the design it is about, "" if none, and its cells."""

    design_id: str
    cells: tuple[Cell, ...]


@dataclass(frozen=True)
class Table:
    """A table."""

    headings: tuple[Heading, ...]
    rows: tuple[Row, ...]


def front_table(data: ReportData, most: int) -> Table:
    """List the designs of the front, the first so many."""
    designs = data.front[:most]
    table = _designs(data, designs, Heading("design", numeric=False))
    first, *others = table.headings
    verified = Heading("verified", title="simulated again by the model's reference", numeric=False)
    headings, more = [first, verified], [verified_cell]
    if any(design.kkt is not Kkt.NOT_COMPUTED for design in data.front):
        headings.append(Heading("KKT residual", title="rate at which one direction improves every objective"))
        more.append(residual_cell)
    rows = tuple(
        Row(row.design_id, (row.cells[0], *(cell(design, data) for cell in more), *row.cells[1:]))
        for row, design in zip(table.rows, designs, strict=True)
    )
    return Table((*headings, *others), rows)


def verified_cell(design: Design, data: ReportData) -> Cell:
    """Say what is known of simulating a design again."""
    return Cell(verified_words(design, data), design.verified)


def residual_cell(design: Design, data: ReportData) -> Cell:
    """Say what is known of a design's residual; of one below its floor only that it is."""
    if design.optimality is None:
        return Cell("not defined" if design.kkt is Kkt.NOT_DEFINED else "–", LAST)
    residual, floor = design.optimality.residual, design.optimality.floor
    text = number(residual, 2) if residual > floor else f"< {number(floor, 2)}"
    return Cell(text, repr(residual))


def verified_words(design: Design, data: ReportData) -> str:
    """Say what is known of a design: `yes`, `no`, or how it deviates."""
    if design.verified is not Verified.DEVIATES:
        return design.verified
    if design.deviation is None or 100.0 * design.deviation <= data.tolerance:
        return "deviates, by its outcome"
    return f"deviates, by {number(100.0 * design.deviation, 2)} %"


def best_table(data: ReportData) -> Table:
    """List the best design of each strategy."""
    table = _designs(data, data.best, Heading("design", numeric=False))
    rows = tuple(
        Row(row.design_id, (Cell(design.strategy, design.strategy), *row.cells))
        for row, design in zip(table.rows, data.best, strict=True)
    )
    return Table((Heading("strategy", numeric=False), *table.headings), rows)


def runs_table(data: ReportData) -> Table:
    """List the runs: budget, evaluations, what of them came to the front, hypervolume, why each ended."""
    headings = [Heading("run", numeric=False), Heading("seed"), Heading("evaluations"), Heading("budget")]
    headings += [Heading("feasible"), Heading("on the front", title="designs of the combined front")]
    measured = any(run.hypervolumes for run in data.runs)
    if measured:
        headings.append(Heading("hypervolume", title="share of the reference box that the run dominates"))
    rows = []
    for run in data.runs:
        shared = sum(design.run == run.name for design in data.front)
        counts = (run.seed, run.evaluations, run.budget, run.feasible, shared)
        cells = [Cell(run.name, run.name), *(Cell(str(count), str(count)) for count in counts)]
        if measured:
            cells.append(Cell("–" if run.hypervolume is None else f"{run.hypervolume:.4f}"))
        cells.append(Cell(run.ending or "–"))
        rows.append(Row("", tuple(cells)))
    headings.append(Heading("ended", title="why the run asked for no more", numeric=False))
    return Table(tuple(headings), tuple(rows))


def outcome_table(data: ReportData) -> Table:
    """Count how the simulations of each strategy ended, with a sentence of the first that ended so."""
    outcomes = [o for o in Outcome if any(o in run.outcomes for run in data.runs)]
    headings = (
        Heading("outcome", numeric=False),
        Heading("designs"),
        Heading("share"),
        *(Heading(strategy) for strategy in data.strategies),
        Heading("in its own words, the first of them", numeric=False),
    )
    rows = []
    for outcome in outcomes:
        example = next((run.examples[outcome] for run in data.runs if outcome in run.examples), "")
        counts = [
            sum(run.own.get(outcome, 0) for run in data.runs if run.strategy == strategy)
            for strategy in data.strategies
        ]
        words = [outcome, str(sum(counts)), share(sum(counts), data.failing.designs), *map(str, counts), example]
        rows.append(Row("", tuple(Cell(word) for word in words)))
    return Table(headings, tuple(rows))


def _designs(data: ReportData, designs: Sequence[Design], first: Heading) -> Table:
    goals = bool(designs) and designs[0].attainment is not None
    axes = [facts.axis for facts in data.objectives] + [facts.axis for facts in data.variables]
    headings = [first]
    if goals:
        headings.append(Heading("max λ", title="goal attainment (3.24); below 0 every goal is met"))
    headings += [
        Heading(
            axis.words,
            " ".join(part for part in (axis.symbol, axis.bracket) if part),
            axis.description,
        )
        for axis in axes
    ]
    return Table(tuple(headings), tuple(_row(data, design) for design in designs))


def _row(data: ReportData, design: Design) -> Row:
    cells = [Cell(design.design_id, design.design_id)]
    if design.attainment is not None:
        cells.append(Cell(number(design.attainment), repr(design.attainment)))
    objectives = zip(data.objectives, design.objectives, design.met, strict=True)
    cells += [Cell(facts.axis.text(value), repr(value), met) for facts, value, met in objectives]
    variables = zip(data.variables, design.variables, strict=True)
    cells += [Cell(facts.axis.text(value), repr(value)) for facts, value in variables]
    return Row(design.design_id, tuple(cells))
