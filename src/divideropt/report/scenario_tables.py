"""The report's tables of designs under scenarios: a row a quantity, a column a scenario."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from divideropt.report.display import Axis, axis_of
from divideropt.report.scenarios import DesignUnder, UnderScenarios
from divideropt.report.tables import Cell, Heading, Row, Table


@dataclass(frozen=True)
class LabelledTable:
    """A table of one design: why the design is shown, which it is, and the table."""

    label: str
    design_id: str
    table: Table


def scenario_tables(under: UnderScenarios | None, words: Mapping[str, str]) -> tuple[LabelledTable, ...]:
    """Tabulate designs under scenarios.

    Args:
        under: The designs; None for none.
        words: What happens in each scenario, by `Scenario NAME`, as the report's setting has it.

    Returns:
        A table a design, all in the same units: quantities down, the worst and then the scenarios across.
    """
    if under is None:
        return ()
    titles = {name: words.get(f"Scenario {name}", words.get("Scenario", "")) for name in under.scenarios}
    headings = [Heading("quantity", numeric=False), Heading("worst", title="of all scenarios")]
    headings += [Heading(name.replace("_", " "), title=title) for name, title in titles.items()]
    axes = _axes(under.designs)
    return tuple(
        LabelledTable(design.label, design.design_id, Table(tuple(headings), _rows(design, axes)))
        for design in under.designs
    )


def _axes(designs: Sequence[DesignUnder]) -> dict[str, Axis]:
    values: dict[str, list[float]] = {}
    for row in (row for design in designs for row in design.rows):
        values.setdefault(row.quantity.name, []).extend(row.values)
    entries = {row.quantity.name: row.quantity for row in designs[0].rows}
    return {name: axis_of(entry, values[name]) for name, entry in entries.items()}


def _rows(design: DesignUnder, axes: Mapping[str, Axis]) -> tuple[Row, ...]:
    rows = []
    for row in design.rows:
        axis = axes[row.quantity.name]
        cells = [Cell(f"{axis.words} {axis.bracket}".rstrip())]
        cells.append(Cell("–" if row.worst is None else axis.text(row.values[row.worst])))
        cells += [
            Cell(axis.text(value), worst=not row.same and place == row.worst)
            for place, value in enumerate(row.values)
        ]
        rows.append(Row("", tuple(cells)))
    told = [outcome or "not known" for outcome in design.outcomes]
    failed = next((outcome for outcome in told if outcome != "ok"), "ok")
    rows.append(Row("", (Cell("outcome"), Cell(failed), *(Cell(outcome) for outcome in told))))
    return tuple(rows)
