"""A House of Quality as a table, and what follows from it in a sentence or two."""

from collections.abc import Mapping
from dataclasses import dataclass

from divideropt.analysis.house_of_quality import WORTHWHILE, Criterion, House

UNWRITTEN = "–"
"""Where there is no number."""


@dataclass(frozen=True)
class HouseCell:
    """A score, the author's beside it ("" where he has none), and the difference ("" where there is none)."""

    score: str
    author: str
    difference: str


@dataclass(frozen=True)
class HouseRow:
    """A row of the table: its name, its weight, whether it is a judgement and no simulation, a cell a variable."""

    words: str
    weight: str
    judgement: bool
    cells: tuple[HouseCell, ...]


def house_rows(house: House) -> tuple[HouseRow, ...]:
    """Word the rows of a house."""
    count = len(house.variables)
    return tuple(HouseRow(row.words, row.importance, row.quantity is None, _cells(row, count)) for row in house.rows)


def house_sentence(house: House, words: Mapping[str, str]) -> str:
    """Word what follows from the house.

    Args:
        house: The house.
        words: How each variable is called.
    """
    if house.importance is None:
        return "No objective has indices, so nothing follows on which variables are worth optimising."
    value = dict(zip(house.variables, house.importance, strict=True))
    worth = house.worthwhile
    rest = [name for name in house.variables if name not in worth]
    listed = ", ".join(f"{words[name]} ({value[name]:.2f})" for name in worth)
    parts = [f"Worth optimising: {listed}." if worth else "By this rule no variable is worth optimising."]
    if rest:
        others = ", ".join(f"{words[name]} ({value[name]:.2f})" for name in rest)
        parts.append(f"Below {WORTHWHILE:g}, and as well left where it suits: {others}.")
    else:
        parts.append("None is left out.")
    differences = house.differences
    if differences:
        equal = sum(d == 0 for d in differences)
        near = sum(abs(d) == 1 for d in differences)
        far = len(differences) - equal - near
        parts.append(
            f"Of {len(differences)} numbers {equal} are the author's, {near} differ by one and {far} by more."
        )
        parts.append(_author_sentence(house, words))
    return " ".join(part for part in parts if part)


def _author_sentence(house: House, words: Mapping[str, str]) -> str:
    """Say whether the author's own numbers, by the same rule, choose other variables."""
    his = dict(zip(house.variables, house.author_importance or (), strict=True))
    judged = [name for name in house.variables if his[name] is not None]
    other = [name for name in judged if ((his[name] or 0.0) >= WORTHWHILE) != (name in house.worthwhile)]
    if not other:
        return "His numbers, by the same rule, choose the same variables."
    listed = ", ".join(f"{words[name]} ({his[name]:.2f})" for name in other)
    return f"By the same rule his numbers judge otherwise of {listed}."


def _cells(row: Criterion, count: int) -> tuple[HouseCell, ...]:
    cells = []
    for mine, his in zip(row.scores or (None,) * count, row.author or (None,) * count, strict=True):
        gap = 0 if mine is None or his is None else mine - his
        cells.append(
            HouseCell(
                UNWRITTEN if mine is None else str(mine),
                "" if his is None else str(his),
                f"{gap:+d}".replace("-", "−") if gap else "",
            )
        )
    return tuple(cells)
