"""Which statements of the page of claims are about a figure, and the judgements of figures nothing is said of."""

import re
from collections.abc import Callable, Sequence

from claims.judgement import Statement
from claims.sensitivity_section import CHAPTERS
from claims.trends import TRENDS, Trend

from thesisfigures.figure import Both, Row

Judge = Callable[[Both], Sequence[Row]]

IN_RIG = ("conservative", "listing")
"""What the twins of Chapter 4 are judged for: they start at rest, as the rig did, so a cold start has no place."""

COUNTED = [statement for chapter in CHAPTERS for statement in chapter.statements if statement.counted]
"""The statements of section 3.4 in the order in which the page of claims numbers them."""


def figures_at(place: str) -> set[str]:
    """Return the figures that a place names, as Figs. 3.18–3.21; none where it is the text above or below one."""
    if not place.startswith(("Fig. ", "Figs. ")):
        return set()
    found = set()
    for chapter, first, last in re.findall(r"(\d)\.(\d+)(?:–\d\.(\d+))?", place):
        found |= {f"{chapter}.{number}" for number in range(int(first), int(last or first) + 1)}
    return found


def said_in_3_4(number: str, own: Sequence[Statement] = ()) -> Judge:
    """Judge what section 3.4 says of a figure.

    Args:
        number: The figure's.
        own: Statements of ours, for what the page of claims does not have.
    """
    about = [one for chapter in CHAPTERS for one in chapter.statements if number in figures_at(one.place)]

    def judge(both: Both) -> list[Row]:
        return [
            Row(
                f"A{COUNTED.index(one) + 1}" if one in COUNTED else "",
                one.quotation,
                one.criterion,
                {name: one.judged(runs) for name, runs in both.items()},
                one.counted,
            )
            for one in (*about, *own)
        ]

    return judge


def said_in_4(number: str, own: Sequence[Trend] = (), also: Sequence[str] = ()) -> Judge:
    """Judge what Chapter 4 says of a figure.

    Args:
        number: The figure's.
        own: Trends of ours, for what the page of claims does not have.
        also: Places whose trends are about it, too.
    """
    about = [one for one in TRENDS if number in figures_at(one.place) or one.place in also]

    def judge(both: Both) -> list[Row]:
        return [
            Row(
                f"B{TRENDS.index(one) + 1}" if one in TRENDS else "",
                one.quotation,
                one.criterion,
                {name: one.judged(name) for name in IN_RIG},
            )
            for one in (*about, *own)
        ]

    return judge
