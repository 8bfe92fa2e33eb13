"""How numbers are shown to people: the unit on an axis, the digits in a cell."""

import math
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np

from divideropt.models import Parameter, Quantity
from divideropt.models.dimensions import Dimension
from divideropt.models.divider.scenarios import GATHERED
from divideropt.models.statistic import parted
from divideropt.models.statistic import words_of as statistic_words

_UNITS: Mapping[str, tuple[tuple[float, str, float], ...]] = MappingProxyType(
    {
        "m": ((1e-4, "µm", 1e6), (1.0, "mm", 1e3), (math.inf, "m", 1.0)),
        "m^2": ((math.inf, "mm²", 1e6),),
        "m^3": ((1e-2, "mL", 1e6), (math.inf, "L", 1e3)),
        "m^3/s": ((1e-6, "mL/min", 6e7), (math.inf, "L/min", 6e4)),
        "m^2/s": ((math.inf, "mm²/s", 1e6),),
        "m/s": ((1.0, "mm/s", 1e3), (math.inf, "m/s", 1.0)),
        "Pa": ((5e8, "MPa", 1e-6), (math.inf, "GPa", 1e-9)),
        "s": ((10.0, "ms", 1e3), (math.inf, "s", 1.0)),
        "kg": ((1.0, "g", 1e3), (math.inf, "kg", 1.0)),
        "kg/m^3": ((math.inf, "kg/m³", 1.0),),
        "rad": ((math.inf, "°", 180.0 / math.pi),),
    }
)
"""The platform's unit to what is shown: (below this magnitude, unit, factor), the first that fits. Others stay."""

LEAST, MOST = 1e-2, 1e4
"""A column is in the unit of its typical size while its largest number is from the one to below the other: so one
quantity has one unit on a page, whatever values a figure and a table have of it.
"""

DIGITS = 4
"""Significant digits in tables; a simulated figure means no more."""


_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


@dataclass(frozen=True)
class Shown:
    """A unit for people.

    Attributes:
        unit: Its name, "" if none.
        scale: What to multiply a number in the platform's unit by.
    """

    unit: str
    scale: float


@dataclass(frozen=True)
class Axis:
    """A named column as a figure or a table shows it.

    Attributes:
        name: Name in files and tables.
        words: The name in words; a magnitude says so.
        symbol: Symbol beside the name, "" if it has none.
        description: What it is, in a line.
        shown: The unit shown.
        unit: The platform's unit, "" if it has none.
        magnitude: Whether a signed column is shown by its magnitude.
    """

    name: str
    words: str
    symbol: str
    description: str
    shown: Shown
    unit: str = ""
    magnitude: bool = False

    @property
    def label(self) -> str:
        """Words, symbol and unit: `spool radius r [mm]`."""
        return " ".join(part for part in (self.words, self.symbol, self.bracket) if part)

    @property
    def detail(self) -> str:
        """Symbol and unit: `r [mm]`."""
        return " ".join(part for part in (self.symbol, self.bracket) if part)

    @property
    def bracket(self) -> str:
        """The unit in brackets, "" if there is none."""
        return f"[{self.shown.unit}]" if self.shown.unit else ""

    def scaled(self, value: float) -> float:
        """Convert from the platform's unit to the one shown."""
        return value * self.shown.scale

    def text(self, value: float) -> str:
        """Write a value, given in the platform's unit, without the unit."""
        return number(self.scaled(value))

    def short(self, value: float) -> str:
        """Write a value that was computed with the unit shown, without zeros that say nothing."""
        return f"{trimmed(number(self.scaled(value)))} {self.shown.unit}".rstrip()

    def bound(self, value: float) -> str:
        """Write a value that somebody gave, a bound or a goal, as short as it was given, with the unit shown."""
        return f"{self.scaled(value):.6g} {self.shown.unit}".rstrip().replace("-", "−")


def axis_of(entry: Parameter | Quantity | Dimension, values: Iterable[float]) -> Axis:
    """Choose how a column is shown.

    Args:
        entry: What the column holds.
        values: Values it takes; where they are far from its typical size, the unit is theirs.
    """
    symbol = re.sub(r"(^|,\s*)\(\d+\.\d+\)$", "", entry.symbol).strip()
    symbol = "" if re.search(r"\(\d+\.\d+\)", symbol) else symbol  # a formula of equations' numbers is none
    magnitude = isinstance(entry, Quantity) and entry.signed
    if magnitude and symbol:
        symbol = f"|{symbol}|"
    symbol = symbol if symbol.strip("|") else ""  # of a magnitude that has none
    words, shown = _words_of(entry.name), _unit_of(entry, values)
    return Axis(entry.name, words, symbol, entry.description, shown, entry.unit, magnitude)


def _unit_of(entry: Parameter | Quantity | Dimension, values: Iterable[float]) -> Shown:
    """Choose a column's unit: by its typical size, unless the values are far from it or it has none."""
    if isinstance(entry, Dimension):
        return shown_as(entry.unit, values)
    found = list(values)
    usual = shown_as(entry.unit, [entry.scale if isinstance(entry, Quantity) else entry.default])
    largest = max((abs(value) for value in found if math.isfinite(value)), default=0.0) * usual.scale
    return usual if largest == 0.0 or LEAST <= largest < MOST else shown_as(entry.unit, found)


def _words_of(name: str) -> str:
    """Word a column's name: the `95th percentile of settling time`, the `worst settling time`."""
    statistic = parted(name)
    if statistic is None:
        gathered, _, quantity = name.partition(".")
        return (f"{gathered} {quantity}" if gathered in GATHERED else name).replace("_", " ")
    kind, quantity = statistic
    return f"{statistic_words(kind)} of {_words_of(quantity)}"


def labels_of(axes: Sequence[Axis]) -> list[str]:
    """Short labels, all different: a figure puts two of one label in one place. Symbols, else words, else names."""
    symbols, words = [axis.symbol or axis.words for axis in axes], [axis.words for axis in axes]
    return next((found for found in (symbols, words) if len(set(found)) == len(axes)), [axis.name for axis in axes])


def shown_as(unit: str, values: Iterable[float]) -> Shown:
    """Choose the unit shown for values given in the platform's unit."""
    found = np.abs(np.fromiter(values, dtype=np.float64))
    largest = float(np.max(found[np.isfinite(found)], initial=0.0))
    for limit, name, scale in _UNITS.get(unit, ()):
        if largest < limit:
            return Shown(name, scale)
    return Shown(unit, 1.0)


def number(value: float, digits: int = DIGITS) -> str:
    """Write a number with so many significant digits, a true minus sign, and no exponent where none is needed.

    An exponent is a multiple of 3, as engineers write it: 250.0·10⁻⁹.
    """
    if not math.isfinite(value):
        return "–"
    if value == 0.0:
        return "0"
    short = float(f"{value:.{digits - 1}e}")
    exponent = math.floor(math.log10(abs(short)))
    if -4 <= exponent < 6:
        return f"{value:.{max(0, digits - 1 - exponent)}f}".replace("-", "−")
    whole = 3 * (exponent // 3)
    mantissa = f"{short / 10.0**whole:.{max(0, digits - 1 - (exponent - whole))}f}"
    return f"{mantissa}·10{str(whole).translate(_RAISED)}".replace("-", "−")


def trimmed(text: str) -> str:
    """Take the zeros that say nothing off the end of a number that `number` wrote."""
    return text.rstrip("0").rstrip(".") if "." in text and "·" not in text else text


def rounded(value: float, digits: int = 5) -> float:
    """Round to significant digits, for numbers that are only drawn."""
    return float(f"{value:.{digits - 1}e}")


def grouped(count: int) -> str:
    """Write a count, its thousands apart from five digits on."""
    return f"{count:,}".replace(",", "\u202f") if count >= 10_000 else str(count)


def brief(count: int) -> str:
    """Write a count where there is little room, `29.8k`."""
    size, letter = next(((s, c) for s, c in ((10**6, "M"), (10**3, "k")) if count >= 10 * s), (1, ""))
    return f"{count / size:.3g}{letter}" if letter else str(count)


def share(part: int, whole: int) -> str:
    """Write a share in percent with two digits; one of none or of all only where it is so."""
    if part in (0, whole):
        return "0 %" if part == 0 else "100 %"
    percent = 100.0 * part / whole
    if percent < 0.1:
        return "< 0.1 %"
    if percent > 99.9:
        return "> 99.9 %"
    return f"{percent:.0f} %" if 10.0 <= percent <= 99.0 else f"{percent:.1f} %"
