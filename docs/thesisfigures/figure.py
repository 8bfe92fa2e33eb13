"""What a figure is, and what is found of it."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from claims.judgement import Answer, Judgement, all_of
from claims.runs import Runs, Variant

Both = Mapping[str, Runs]
"""The runs of `VARIANTS`, by name."""

VARIANTS = (Variant("conservative"), Variant("listing", settled=False))
"""What every figure of Chapter 3 is drawn for: the physics, corrected, and the author's code as he started it."""

TITLES: Mapping[str, str] = {"conservative": "conservative, settled", "listing, cold": "listing, cold"}
"""What stands above a panel of each."""


@dataclass(frozen=True)
class Row:
    """Something the thesis says of a figure, and whether runs show it.

    Attributes:
        label: Its number in the page of claims; empty where it is judged for the figure alone.
        quotation: What is said, in a few words of its own.
        criterion: When the answer is yes, when in part.
        found: The judgement of every variant, by name.
        counted: Whether it is a statement; else something beside one.
    """

    label: str
    quotation: str
    criterion: str
    found: Mapping[str, Judgement]
    counted: bool = True


@dataclass(frozen=True)
class Figure:
    """A figure of the thesis that a program can draw.

    Attributes:
        number: The thesis's.
        shows: What it shows, after its caption.
        draw: Makes the drawing, an SVG document.
        judge: Judges what is said of it.
        note: Measures and writes what a reader should know besides; None where nothing is to say.
    """

    number: str
    shows: str
    draw: Callable[[Both], str]
    judge: Callable[[Both], Sequence[Row]]
    note: Callable[[Both], str] | None = None

    @property
    def file(self) -> str:
        """Name of its file."""
        return f"figure_{self.number.replace('.', '_')}.svg"


def both_runs() -> Both:
    """Return the runs that all figures share; nothing is simulated yet."""
    return {str(variant): Runs(variant) for variant in VARIANTS}


def verdicts(rows: Sequence[Row]) -> dict[str, Answer]:
    """Say of each variant whether it shows what the thesis says of the figure.

    As `all_of` joins them, over the statements that a run can judge: yes or no where all agree, else in part; not
    judged where none is.
    """
    found = {}
    for name in dict.fromkeys(name for row in rows for name in row.found):
        judged = [row.found[name] for row in rows if row.counted and name in row.found]
        judged = [one for one in judged if one.answer is not Answer.NOT_JUDGED]
        found[name] = all_of(judged).answer if judged else Answer.NOT_JUDGED
    return found
