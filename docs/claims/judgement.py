"""What is said of a statement, and what a statement is."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum

from claims.runs import Runs


class Answer(StrEnum):
    """Whether a formulation shows what the thesis says."""

    YES = "yes"
    IN_PART = "in part"
    NO = "no"
    NOT_JUDGED = "not judged"


@dataclass(frozen=True)
class Judgement:
    """An answer and what it rests on.

    Attributes:
        answer: The answer.
        figures: The numbers, in words.
    """

    answer: Answer
    figures: str

    def __str__(self) -> str:
        """As a cell of a table."""
        return f"**{self.answer}**: {self.figures}" if self.figures else f"**{self.answer}**"


@dataclass(frozen=True)
class Statement:
    """Something the thesis says that a run can show or deny.

    Attributes:
        quotation: In a few words of its own.
        place: Figure, table or section.
        criterion: When the answer is yes, when in part; why there is none, where nothing judges it.
        judge: Gives the answer of one variant; None where the model cannot.
        counted: Whether it is a statement; else something beside one, without a number, that a run can check.
    """

    quotation: str
    place: str
    criterion: str
    judge: Callable[[Runs], Judgement] | None = None
    counted: bool = True

    def judged(self, runs: Runs) -> Judgement:
        """Judge it by the runs of one variant."""
        return Judgement(Answer.NOT_JUDGED, "") if self.judge is None else self.judge(runs)


@dataclass(frozen=True)
class Chapter:
    """Statements that share a sweep.

    Attributes:
        title: What is varied.
        sweep: Over which range, and how finely.
        statements: In the thesis's order.
        note: Measures and writes what a reader of the thesis should know besides; None where nothing is to say.
    """

    title: str
    sweep: str
    statements: tuple[Statement, ...]
    note: Callable[[], str] | None = None


@dataclass(frozen=True)
class Judged:
    """A counted statement with what was found.

    Attributes:
        label: Its number in the page, as A7.
        quotation: As in the statement.
        found: The judgement of every variant or formulation, by name.
    """

    label: str
    quotation: str
    found: Mapping[str, Judgement]


def named(judged: Sequence[Judged], beginning: str) -> Judged:
    """Return the one whose quotation begins so; LookupError if it is not one."""
    fitting = [one for one in judged if one.quotation.startswith(beginning)]
    if len(fitting) != 1:
        raise LookupError(f"{len(fitting)} statements begin with “{beginning}”, not one: quote more, or what is said")
    return fitting[0]


def all_of(parts: Sequence[Judgement]) -> Judgement:
    """Join judgements: yes if all are yes, no if all are no, not judged if one is not, else in part."""
    answers = {part.answer for part in parts}
    figures = "; ".join(part.figures for part in parts)
    if Answer.NOT_JUDGED in answers:
        return Judgement(Answer.NOT_JUDGED, figures)
    return Judgement(answers.pop() if len(answers) == 1 else Answer.IN_PART, figures)
