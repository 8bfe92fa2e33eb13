"""The table of versions: what computed a store, and what made its report."""

from divideropt.report.provenance import Provenance
from divideropt.report.tables import Cell, Heading, Row, Table

MOST_WRITERS = 3
"""Machines and versions that the page has a column for, the last that wrote to the store."""


def versions_table(provenance: Provenance) -> Table:
    """List versions: of what made the report, and of the last that wrote to the store."""
    writers = provenance.writers[-MOST_WRITERS:]
    names = dict.fromkeys([*provenance.here, *(name for writer in writers for name in writer if name != "features")])
    computed = [Heading("computed with" if len(writers) == 1 else f"writer {i}") for i in _numbers(provenance)]
    headings = (Heading("name", numeric=False), *computed, Heading("this report"))
    rows = [
        Row(
            "",
            (Cell(name), *(Cell(writer.get(name, "–")) for writer in writers), Cell(provenance.here.get(name, "–"))),
        )
        for name in names
    ]
    return Table(headings, tuple(rows))


def _numbers(provenance: Provenance) -> range:
    """The writers that have a column, counted from the first that wrote."""
    count = len(provenance.writers)
    return range(max(0, count - MOST_WRITERS) + 1, count + 1)
