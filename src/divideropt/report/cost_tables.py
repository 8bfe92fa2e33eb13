"""The report's tables of what robustness costs."""

from divideropt.report.cost import Best, Reading
from divideropt.report.data import ReportData
from divideropt.report.display import Axis, number
from divideropt.report.tables import Cell, Heading, Row, Table

ALONE, WHOLE = "nominal", "whole campaign"
"""By what a design is judged."""


def bests_table(data: ReportData) -> Table:
    """List the best of either front, judged by the companion's problem and by the campaign's, a row each."""
    if data.cost is None:
        return Table((), ())
    goals = any(reading.attainment is not None for best in data.cost.bests for reading in _readings(best).values())
    headings = [Heading("best of", numeric=False), Heading("in", numeric=False), Heading("design", numeric=False)]
    headings.append(Heading("judged", title="by the companion’s problem or by the whole campaign’s", numeric=False))
    if goals:
        headings.append(Heading("max λ", title="goal attainment (3.24); below 0 every goal is met"))
    for name, facts in zip(data.cost.objectives, data.objectives, strict=True):
        detail = " ".join(part for part in (facts.axis.symbol, facts.axis.bracket) if part)
        headings.append(Heading(name.replace("_", " "), detail, _judged_words(name.replace("_", " "), facts.axis)))
    headings.append(Heading("outcome", numeric=False))
    rows = []
    for best in data.cost.bests:
        reasons = ", ".join(reason.replace("_", " ") for reason in best.reasons)
        name = f"nominal/{best.design_id}" if best.nominal else best.design_id
        first = [Cell("nominal front" if best.nominal else "robust front"), Cell(reasons), Cell(name)]
        for judge, reading in _readings(best).items():
            cells = [*first, Cell(judge), *_cells(data, reading, goals)]
            rows.append(Row("" if best.nominal else best.design_id, tuple(cells)))
            first = [Cell("")] * len(first)
    return Table(tuple(headings), tuple(rows))


def reasons_table(data: ReportData) -> Table:
    """List why designs of the companion's front do not stand the whole campaign."""
    headings = (Heading("why", numeric=False), Heading("designs"), Heading("for example", numeric=False))
    reasons = data.cost.reasons if data.cost else ()
    rows = (Row("", (Cell(item.words), Cell(str(item.count)), Cell(item.example or "–"))) for item in reasons)
    return Table(headings, tuple(rows))


def volumes_table(data: ReportData) -> Table:
    """List the hypervolumes of both fronts in both problems; empty without a reference point."""
    if data.cost is None or data.cost.volumes is None:
        return Table((), ())
    headings = (Heading("hypervolume", numeric=False), Heading(ALONE), Heading(WHOLE))
    rows = (
        Row("", (Cell(name), *(Cell(f"{value:.4f}") for value in values)))
        for name, values in zip(("nominal front", "robust front"), data.cost.volumes, strict=True)
    )
    return Table(headings, tuple(rows))


def _judged_words(words: str, axis: Axis) -> str:
    """Say what a column of objectives holds, where the judges have different quantities there."""
    if axis.words == words:
        return axis.description
    return f"{ALONE}: {words} of the design as it is, in the base scenario; {WHOLE}: {axis.words}"


def _readings(best: Best) -> dict[str, Reading]:
    found = {ALONE: best.alone, WHOLE: best.whole}
    return {judge: reading for judge, reading in found.items() if reading is not None}


def _cells(data: ReportData, reading: Reading, goals: bool) -> list[Cell]:
    cells = [Cell("–" if reading.attainment is None else number(reading.attainment))] if goals else []
    values = zip(data.objectives, reading.objectives, reading.met, strict=True)
    cells += [Cell(facts.axis.text(value), met=met) for facts, value, met in values]
    return [*cells, Cell(reading.words)]
