"""Units at the border: a string such as `6 mm` to a number in the unit the platform computes in.

Inside, everything is SI, but for percentages, which stay numbers in percent. The unit expression passes a
strict grammar before `pint` sees it, since pint evaluates what it is given (`6^800000` would not end).
"""

import re
from decimal import Decimal
from functools import cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from pint import UnitRegistry

NUMBER = r"[+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]{1,3})?"
"""Pattern of a plain decimal number."""

_FACTOR = r"(?:[A-Za-zµμ°%]{1,24}(?:\^-?[1-9])?)"
UNIT = rf"(?:1/{_FACTOR}|{_FACTOR})(?:[*/]{_FACTOR}){{0,5}}"
"""Pattern of a unit of at most six factors, each with at most one digit of power, no parentheses, no numbers."""

LONGEST = 80
"""Characters of a measure."""

LARGEST = 1e50
"""Largest magnitude of a number that is computed with, far beyond what is measured in any unit: sums, squares and
products of some such numbers, and quotients of two, still are numbers."""

LEAST = 1e-50
"""Least magnitude of one that is not 0."""

_TENS = {"": 0, "G": 9, "M": 6, "k": 3, "c": -2, "m": -3, "u": -6, "µ": -6, "μ": -6}
"""Prefixes as powers of ten."""

_BASES = {
    "m": (0, (1, 0, 0)),
    "g": (-3, (0, 1, 0)),
    "s": (0, (0, 0, 1)),
    "Pa": (0, (-1, 1, -2)),
    "bar": (5, (-1, 1, -2)),
    "N": (0, (1, 1, -2)),
    "L": (-3, (3, 0, 0)),
    "l": (-3, (3, 0, 0)),
}
"""Units as powers of ten of SI units, and their exponents of metre, kilogram and second."""

_KNOWN = {tens + name: (_TENS[tens] + ten, 0, kind) for name, (ten, kind) in _BASES.items() for tens in _TENS}
_KNOWN |= {"%": (-2, 0, (0, 0, 0)), "min": (0, 1, (0, 0, 1))}
"""The same with prefixes; between the two, how many sixties there are in it."""

_MEASURE = re.compile(rf"\s*({NUMBER})\s*({UNIT})?\s*", re.ASCII)
_PLAIN = re.compile(rf"\s*{NUMBER}\s*", re.ASCII)
_PART = re.compile(r"([*/]?)([A-Za-zµμ°%]+)(?:\^(-?[1-9]))?", re.ASCII)


def parse_measure(value: object, unit: str) -> float:
    """Read a number with its unit.

    Args:
        value: A string such as `6 mm`, `1e-3 m^3/s`, `0.5 %`; a bare number only where `unit` is "".
        unit: The unit to convert to, as the platform names it: "m", "Pa", "m^3", "1/s", "%", or "" for a
            number without dimension.

    Returns:
        The number in `unit`.

    Raises:
        ValueError: In one sentence, what is wrong with the value and what would be right.
    """
    if isinstance(value, bool) or not isinstance(value, str | int | float):
        raise ValueError(f"{value!r} is not {_wanted(unit)}")
    if isinstance(value, int):
        value = str(value)  # which may be too large for a float
    if isinstance(value, float):
        return _bare(value, unit)
    match = _MEASURE.fullmatch(value) if len(value) <= LONGEST else None
    if match is None:
        raise ValueError(f"{value[:LONGEST]!r} is not {_wanted(unit)}")
    number, given = match[1], match[2]
    if given is None:
        return _bare(float(number), unit)
    if given == unit:
        return _computable(float(number), unit)
    return _computable(float(Decimal(number) * _factor(given, unit)), unit)


def parse_number(text: str) -> float:
    """Read a plain decimal number: no unit, no `1_000`, no `nan`, no digits but 0 to 9.

    Raises:
        ValueError: It is no such number, or too large to be computed with.
    """
    if len(text) > LONGEST or not _PLAIN.fullmatch(text):
        raise ValueError(f"{text[:LONGEST]!r} is not a number")
    return _bounded(float(text), "")


def format_measure(value: float, unit: str) -> str:
    """Write a number so that `parse_measure` reads the same bits again: `0.006 m`."""
    return f"{value!r} {unit}".rstrip()


def _bare(number: float, unit: str) -> float:
    if unit:
        raise ValueError(f"{number:g} has no unit; write {number:g} {unit}, or the same in any unit of that kind")
    return _computable(number, "")


def _computable(number: float, unit: str) -> float:
    if number and abs(number) < LEAST:
        raise ValueError(
            f"{_written(number, unit)} is too small to be computed with; the least magnitude is "
            f"{_written(LEAST, unit)}, or 0; check the exponent and the unit"
        )
    return _bounded(number, unit)


def _bounded(number: float, unit: str) -> float:
    if number - number != 0.0:
        raise ValueError(f"{number} is not a finite number")
    if abs(number) > LARGEST:
        raise ValueError(
            f"{_written(number, unit)} is too large to be computed with; the largest magnitude is "
            f"{_written(LARGEST, unit)}; check the exponent and the unit"
        )
    return number


def _written(number: float, unit: str) -> str:
    return f"{number:g} {unit}".rstrip()


def _wanted(unit: str) -> str:
    return f"a number with a unit, such as 1 {unit}" if unit else "a number"


@cache
def _factor(given: str, wanted: str) -> Decimal:
    """Return what to multiply a number in `given` by to have it in `wanted`; decimal, so that 3 um is 3e-6."""
    ours, theirs = _ten(given), _ten(wanted)
    if ours is not None and theirs is not None and ours[2] == theirs[2]:
        return Decimal(1).scaleb(ours[0] - theirs[0]) * Decimal(60) ** (ours[1] - theirs[1])
    import pint  # noqa: PLC0415 (late: it takes half a second, and few units need it)

    registry = _registry()
    try:
        return Decimal(registry.Quantity(Decimal(1), _pint_name(given)).to(_pint_name(wanted)).magnitude)
    except pint.UndefinedUnitError:
        raise ValueError(f"the unit {given!r} is not known; here {_wanted(wanted)}") from None
    except (pint.PintError, AssertionError, ArithmeticError, TypeError):  # a logarithmic or offset unit
        raise ValueError(f"the unit {given!r} is of another kind; here {_wanted(wanted)}") from None


def _ten(unit: str) -> tuple[int, int, list[int]] | None:
    """Read a unit of tens and sixties of SI units: the powers of both, and its dimensions; None for any other."""
    power, sixties, dimensions = 0, 0, [0, 0, 0]
    for operator, name, exponent in _PART.findall(unit.removeprefix("1")):
        if name not in _KNOWN:
            return None
        times = int(exponent or 1) * (-1 if operator == "/" else 1)
        ten, sixty, kind = _KNOWN[name]
        power += times * ten
        sixties += times * sixty
        dimensions = [d + times * k for d, k in zip(dimensions, kind, strict=True)]
    return power, sixties, dimensions


@cache
def _registry() -> "UnitRegistry[Decimal]":
    import pint  # noqa: PLC0415

    return pint.UnitRegistry(non_int_type=Decimal)


def _pint_name(unit: str) -> str:
    return re.sub(r"^1/", "1 / ", unit.replace("%", "percent")) or "dimensionless"
