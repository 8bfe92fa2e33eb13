"""Tables in Markdown."""

import math
from collections.abc import Iterable, Sequence

from modelpages.axis import RAISED


def table(header: Sequence[str], rows: Iterable[Sequence[str]], numbers_from: int | None = None) -> str:
    """Write a table.

    Args:
        header: Of each column.
        rows: Cells of each row.
        numbers_from: First column that holds numbers, which stand right; None where none does.
    """
    first = len(header) if numbers_from is None else numbers_from
    rule = ["---:" if i >= first else "---" for i in range(len(header))]
    return "\n".join("| " + " | ".join(cells) + " |" for cells in [header, rule, *rows])


def fixed(value: float, digits: int) -> str:
    """Write a number with so many digits after the point; a dash where there is none."""
    return "–" if math.isnan(value) else f"{value:.{digits}f}".replace("-", "−")


def power(value: float, digits: int = 1, nothing: float = 0.0) -> str:
    """Write a number with a power of ten; 0 where its size is not above `nothing`."""
    if math.isnan(value):
        return "–"
    if abs(value) <= nothing:
        return "0"
    mantissa, exponent = f"{value:.{digits}e}".split("e")
    return f"{mantissa}·10{str(int(exponent)).translate(RAISED)}".replace("-", "−")
