"""The tables of what failed: along each variable's range, and by constraint."""

from divideropt.analysis.failures import PARTS
from divideropt.report.display import share
from divideropt.report.failing import Along, Failing
from divideropt.report.tables import Cell, Heading, Row, Table


def along_table(failing: Failing) -> Table:
    """List how many of how many designs failed in each part of each variable's range."""
    step = 100 // PARTS
    parts = [
        Heading(f"{step * k}–{step * (k + 1)} %", title="part of the range, from its lower bound")
        for k in range(PARTS)
    ]
    headings = (Heading("variable", numeric=False), Heading("range"), *parts)
    return Table(headings, tuple(_row(along) for along in failing.along))


def bounds_table(failing: Failing) -> Table:
    """List how many designs that ended well break each bound, the most broken first."""
    headings = (
        Heading("constraint", numeric=False),
        Heading("designs that break it"),
        Heading("share", title="of the designs whose simulation ended well"),
        Heading("break no other", title="without this constraint they would be feasible"),
    )
    bounds = sorted(failing.bounds, key=lambda bound: -bound.broken)
    rows = [
        (bound.words, str(bound.broken), share(bound.broken, failing.worked), str(bound.alone)) for bound in bounds
    ]
    return Table(headings, tuple(Row("", tuple(Cell(text) for text in row)) for row in rows))


def _row(along: Along) -> Row:
    axis, parts = along.axis, along.parts
    ends = f"{axis.bound(parts[0].lower)} to {axis.bound(parts[-1].upper)}"
    counts = (f"{part.failed} of {part.designs}" if part.designs else "–" for part in parts)
    return Row("", (Cell(axis.words), Cell(ends), *(Cell(count) for count in counts)))
