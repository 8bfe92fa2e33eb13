"""The table beside the figures of convergence: a strategy's median early, halfway and at the end."""

from collections.abc import Iterator, Sequence

from divideropt.analysis import Course
from divideropt.report.convergence import Track
from divideropt.report.display import number
from divideropt.report.tables import Cell, Heading, Row, Table

SHARES = ((0.1, "after a tenth"), (0.5, "after half"), (1.0, "after all"))
"""Of the evaluations: where the medians are told."""


def convergence_table(tracks: Sequence[Track]) -> Table:
    """List each strategy's medians, and their last spread, as far as the shortest of its runs goes."""
    headings = (
        Heading("figure", numeric=False),
        Heading("strategy", numeric=False),
        Heading("runs"),
        Heading("evaluations", title="of the shortest run"),
        *(Heading(words) for _, words in SHARES),
        Heading("spread after all"),
    )
    rows = (_cells(track, strategy, course) for track in tracks for strategy, course in track.courses.items())
    return Table(headings, tuple(Row("", tuple(Cell(text) for text in row)) for row in rows))


def unequal(tracks: Sequence[Track]) -> tuple[tuple[str, int], ...]:
    """The strategies whose runs are not equally long, and how many evaluations the shortest has."""
    found = []
    for strategy, course in tracks[0].courses.items() if tracks else ():
        longest = max(line.marks[-1] for line in tracks[0].lines if line.strategy == strategy)
        if longest > course.marks[-1]:
            found.append((strategy, course.marks[-1]))
    return tuple(found)


def _cells(track: Track, strategy: str, course: Course) -> Iterator[str]:
    yield from (track.title, strategy, str(course.runs), str(course.marks[-1]))
    yield from (number(course.median[_place(course, share)]) for share, _ in SHARES)
    ends = (course.lower[-1], course.upper[-1])
    yield "–" if course.runs == 1 else " to ".join(number(end) for end in ends)


def _place(course: Course, share: float) -> int:
    """The last mark within a share of the evaluations, or the first."""
    return max(i for i, mark in enumerate(course.marks) if i == 0 or mark <= share * course.marks[-1])
