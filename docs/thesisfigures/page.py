"""The page: every figure with what it says and the verdict, and those that cannot be drawn."""

import platform
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from importlib.metadata import version

from claims.judgement import Answer
from claims.tables import table

from thesisfigures.catalogue import FIGURES, NOT_DRAWN
from thesisfigures.figure import VARIANTS, Both, Figure, Row, verdicts

COMMAND = "python docs/make_thesis_figures.py"
"""What writes the page."""

IMAGES = "../images/thesis"
"""Where the drawings are, from the page."""


def page(rows: Mapping[str, Sequence[Row]], both: Both) -> str:
    """Write the page.

    Args:
        rows: What was judged of each figure, by its number.
        both: Runs, for the notes.
    """
    lines = [*_opening(), *_summary(rows), *_not_drawn()]
    for figure in FIGURES:
        lines += _section(figure, rows[figure.number], both)
    return "\n".join([*lines, *_closing()]) + "\n"


def _opening() -> Iterator[str]:
    yield "# The thesis’s figures, drawn again"
    yield ""
    yield (
        "Every figure of Chapters 2 and 3 of the thesis (Wiens 2004) that a program can draw, and simulated twins of "
        "three measured ones of Chapter 4, each with the verdict whether our drawing shows what the thesis says of "
        "its own. We have the thesis as a scan without most of its images: what a figure shows is taken from its "
        "caption and from the text that refers to it, not from the curves."
    )
    yield ""
    yield (
        "Chapter 3 is drawn twice, for `conservative` from the settled start that section 3.1 describes, and for "
        "`listing` started cold, the author’s code as he ran it: the test of section 3.1 on Appendix B’s base set, "
        "the ranges, the 100 points and the five values of `changeall.m` (C.2). Time runs from the step; a cold "
        "start is the 0.6 s before it. A settled start rests at its equilibrium until the step even where that is "
        "unstable, since nothing disturbs it: what is said of a response before the step shows in the cold one."
    )
    yield ""
    yield (
        "The statements of section 3.4 and Chapter 4 (A…, B…) are those that [the page of claims](claims.md) judges, "
        "here those whose place is the figure; one placed in the text above or below a figure is not. The others, of "
        "figures that no statement is about, are judged here by a criterion of ours in the same way. A verdict joins "
        "the answers to all that is judged of a figure: yes or no where they agree, else in part. What the words "
        "mean (*strong*, *falls*, …) is said [there](claims.md#what-the-words-mean)."
    )
    yield ""


def _summary(rows: Mapping[str, Sequence[Row]]) -> Iterator[str]:
    yield "## In short"
    yield ""
    found = {number: verdicts(judged) for number, judged in rows.items()}
    names = [str(variant) for variant in VARIANTS]
    both = [found[number] for number in rows if set(names) <= set(found[number])]
    counts = [[name, *(str(Counter(one[name] for one in both)[answer]) for answer in Answer)] for name in names]
    yield f"Of the {len(both)} figures of section 3.1 and 3.4, so many show what is said of them:"
    yield ""
    yield from table(["", *Answer], counts)
    yield ""
    cells = []
    for figure in FIGURES:
        link = f"[{figure.number}](#{_anchor(figure)})"
        answers = "; ".join(f"{name} **{answer}**" for name, answer in found[figure.number].items())
        cells.append([link, figure.shows, answers])
    yield from table(["figure", "shows", "verdict"], cells)
    yield ""


def _not_drawn() -> Iterator[str]:
    yield "## What cannot be drawn"
    yield ""
    yield from table(["figure", "what it is"], [[number, reason] for number, reason in NOT_DRAWN.items()])
    yield ""


def _section(figure: Figure, rows: Sequence[Row], both: Both) -> Iterator[str]:
    yield f"## {_heading(figure)}"
    yield ""
    yield f"![Figure {figure.number}: {figure.shows}]({IMAGES}/{figure.file})"
    yield ""
    yield f"**Figure {figure.number}.** {figure.shows}."
    answers = "; ".join(f"{name} **{answer}**" for name, answer in verdicts(rows).items())
    yield f"Does it show what the thesis says? {answers}."
    yield ""
    names = list(dict.fromkeys(name for row in rows for name in row.found))
    yield from table(["", "the thesis says", *names], [_cells(row, names) for row in rows])
    yield ""
    if figure.note is not None:
        yield figure.note(both)
        yield ""


def _cells(row: Row, names: Sequence[str]) -> list[str]:
    said = f"“{row.quotation}”" if row.counted else f"beside it: {row.quotation}"
    return [row.label, f"{said} *{row.criterion}*", *(str(row.found[name]) for name in names)]


def _heading(figure: Figure) -> str:
    return f"Figure {figure.number}"


def _anchor(figure: Figure) -> str:
    """As GitHub makes it of the heading."""
    return _heading(figure).lower().replace(" ", "-").replace(".", "")


def _closing() -> Iterator[str]:
    yield "## How this page was made"
    yield ""
    yield f"    {COMMAND}"
    yield ""
    packages = ", ".join(f"{name} {version(name)}" for name in ("divideropt", "numpy", "scipy", "numba"))
    yield (
        f"Written by the code in `docs/thesisfigures/`, with {packages} on Python {platform.python_version()}. The "
        "same versions on the same machine write the same bytes, drawings included."
    )
