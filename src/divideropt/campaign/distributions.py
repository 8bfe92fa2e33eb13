"""The distribution of an uncertain parameter: as read, as written back, as the schema has it."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic_core import InitErrorDetails

from divideropt.campaign.fields import POSITIVE, Measure, measure_of
from divideropt.campaign.sections import collect, mistake, show, together
from divideropt.models import Domain, Parameter
from divideropt.models.distributions import Distribution, LogUniform, Normal, Triangular, Uniform
from divideropt.models.uncertain import Source
from divideropt.models.viscosity import THESIS_OIL, Walther
from divideropt.units import LONGEST, NUMBER, parse_number


def read_source(parameter: Parameter, raw: object) -> Source:
    """Read what a campaign says of one uncertain parameter.

    Args:
        parameter: Which one.
        raw: As written: `{uniform: [a, b]}`, `{offset: {normal: {mean: a, sd: b}}}`, `{temperature: {…}}`.

    Returns:
        The parameter's source of uncertainty.

    Raises:
        ValueError: What is wrong, in a sentence; or a ValidationError with several of them.
    """
    known = (*_KINDS, *_CHANGES, *(_OF_OIL if _is_viscosity(parameter) else ()))
    made = collect(raw, known, "distribution", lambda key, given: _part(parameter, key, given))
    oil = made.pop("points", None)
    _check_one(made)
    ((key, distribution),) = made.items()
    if key == "temperature":
        return Source(parameter.name, distribution, oil=oil or THESIS_OIL)
    if oil is not None:
        raise together([mistake(("points",), "points are of a viscosity by temperature; delete them", at_key=True)])
    return Source(parameter.name, distribution, key if key in _CHANGES else "value")


def written_source(parameter: Parameter, source: Source) -> dict[str, Any]:
    """Write one so that `read_source` makes an equal one again."""
    if source.oil is not None:
        points = [[CELSIUS.write(t), measure_of(parameter).write(v)] for t, v in (source.oil.cold, source.oil.warm)]
        return {"temperature": _written(source.distribution, CELSIUS), "points": points}
    if source.acting == "value":
        return _written(source.distribution, measure_of(parameter))
    return {source.acting: _written(source.distribution, _CHANGES[source.acting](parameter))}


def source_schema(parameter: Parameter) -> dict[str, Any]:
    """Describe in JSON schema what `read_source` accepts."""
    changes = {key: _one_of_the_kinds(measure(parameter)) for key, measure in _CHANGES.items()}
    schema = _one_of_the_kinds(measure_of(parameter))
    schema["properties"] |= changes
    if _is_viscosity(parameter):
        point = {"type": "array", "prefixItems": [CELSIUS.schema(), measure_of(parameter).schema()], **_exactly(2)}
        points = {"type": "array", "items": point, **_exactly(2)}
        schema["properties"] |= {"temperature": _one_of_the_kinds(CELSIUS), "points": points}
        schema |= {"maxProperties": 2, "dependentRequired": {"points": ["temperature"]}}
        schema |= {"if": {"not": {"required": ["points"]}}, "then": {"maxProperties": 1}}
    return {**schema, "description": f"{parameter.description} ({parameter.symbol})"}


class Degrees(Measure):
    """A temperature or a difference of two; its own reader, since what is between °C and K is no factor."""

    def read(self, value: object) -> float:
        """Read a value as the file has it; raises ValueError with a sentence."""
        match = _DEGREES.fullmatch(value) if isinstance(value, str) and len(value) <= LONGEST else None
        if match is None or match[2] != self.unit:
            raise ValueError(f"{show(value)} is not a number of {self.unit}; write one such as 40 {self.unit}")
        number = parse_number(match[1])
        if not self.domain.contains(number):
            raise ValueError(f"{show(value)} is out of range; what is permitted is {self.domain} {self.unit}")
        return number

    def schema(self, description: str = "") -> dict[str, Any]:
        """Describe in JSON schema what `read` accepts."""
        pattern = rf"^\s*{NUMBER}\s*{self.unit}\s*$"
        return {"type": "string", "pattern": pattern, "maxLength": LONGEST, "description": f"in {self.unit}"}


_DEGREES = re.compile(rf"\s*({NUMBER})\s*(°C|K)\s*", re.ASCII)

CELSIUS = Degrees("°C", Domain(-60.0, 200.0))
"""Temperatures at which an oil is one."""

_KELVIN = Degrees("K", POSITIVE)

_CHANGES: Mapping[str, Callable[[Parameter], Measure]] = {
    "offset": lambda parameter: Measure(parameter.unit),
    "factor": lambda _: Measure("", Domain(0.0)),
}
"""What changes a design's own value, and in what it is given."""

_OF_OIL = ("temperature", "points")

_THINNEST = Domain(2e-6)
"""Viscosity from which on the law holds [m²/s]."""


def _is_viscosity(parameter: Parameter) -> bool:
    return (parameter.name, parameter.unit) == ("kinematic_viscosity", "m^2/s")


def _part(parameter: Parameter, key: str, raw: object) -> Any:
    """Read what stands under one key of a parameter."""
    if key in _CHANGES:
        return _distribution(raw, _CHANGES[key](parameter))
    if key == "temperature":
        return _distribution(raw, CELSIUS)
    if key == "points":
        return _oil(raw)
    return _KINDS[key].read(raw, measure_of(parameter))


def _distribution(raw: object, measure: Measure) -> Distribution:
    made = collect(raw, _KINDS, "distribution", lambda kind, given: _KINDS[kind].read(given, measure))
    _check_one(made)
    (distribution,) = made.values()
    return distribution


def _check_one(made: Mapping[str, object]) -> None:
    if not made:
        raise ValueError("there is no distribution here; write one, such as {uniform: [low, high]}")
    if len(made) > 1:
        first, second = list(made)[:2]
        raise together([mistake((second,), f"there is {first} already; delete one of the two", at_key=True)])


def _oil(raw: object) -> Walther:
    """Read two points of a viscosity by temperature, in any order."""
    (t1, v1), (t2, v2) = sorted(_listed(raw, ["point", "point"], _point))
    if t1 == t2:
        raise ValueError(f"both points are at {t1:g} °C; give two temperatures")
    if v1 <= v2:
        raise ValueError("the viscosity does not fall as the temperature rises; exchange the two viscosities")
    return Walther((t1, v1), (t2, v2))


def _point(raw: object) -> tuple[float, float]:
    measures = (CELSIUS, Measure("m^2/s", _THINNEST))
    if not isinstance(raw, list | tuple) or len(raw) != 2:
        raise ValueError(f"{show(raw)} is no point; write a temperature and a viscosity, [40 °C, 32 mm^2/s]")
    made = collect(dict(enumerate(raw)), (0, 1), "value", lambda i, given: measures[i].read(given))
    return made[0], made[1]


def _listed(raw: object, names: list[str], read: Callable[[object], Any]) -> list[Any]:
    """Read a list of so many values."""
    if not isinstance(raw, list | tuple) or len(raw) != len(names):
        raise ValueError(f"{show(raw)} is not {len(names)} values; write [{', '.join(names)}]")
    places = range(len(names))
    return list(collect(dict(enumerate(raw)), places, "value", lambda _, given: read(given)).values())


def _check_order(raw: Any, low: float, high: float) -> None:
    if low >= high:
        raise ValueError(f"{show(raw[0])} is not below {show(raw[-1])}; exchange or widen them")


def _uniform(raw: object, measure: Measure) -> Uniform:
    low, high = _listed(raw, ["low", "high"], measure.read)
    _check_order(raw, low, high)
    return Uniform(low, high)


def _loguniform(raw: object, measure: Measure) -> LogUniform:
    low, high = _listed(raw, ["low", "high"], measure.read)
    _check_order(raw, low, high)
    if low <= 0.0:
        raise ValueError(f"the lower end is {low:g}, which has no logarithm; give one above 0, or write uniform")
    return LogUniform(low, high)


def _triangular(raw: object, measure: Measure) -> Triangular:
    low, mode, high = _listed(raw, ["low", "mode", "high"], measure.read)
    _check_order(raw, low, high)
    if not low <= mode <= high:
        raise ValueError("the mode, in the middle, is not between the ends; write [low, mode, high]")
    return Triangular(low, mode, high)


def _normal(raw: object, measure: Measure) -> Normal:
    measures = {"mean": measure, "sd": _spread_of(measure)}
    made = collect(raw, measures, "key", lambda key, given: measures[key].read(given))
    lacking: list[InitErrorDetails] = [
        mistake((), f"{key!r} is missing; add it", at_key=True) for key in measures if key not in made
    ]
    if lacking:
        raise together(lacking)
    return Normal(made["mean"], made["sd"], measure.domain)


def _spread_of(measure: Measure) -> Measure:
    """The measure of a standard deviation of what is given in another."""
    return _KELVIN if isinstance(measure, Degrees) else Measure(measure.unit, POSITIVE)


@dataclass(frozen=True)
class _Kind:
    """A kind of distribution.

    Attributes:
        made: What it is inside.
        read: Reads it, its values given in a measure.
        write: Writes it back.
        schema: Describes it.
    """

    made: type
    read: Callable[[object, Measure], Distribution]
    write: Callable[[Any, Measure], Any]
    schema: Callable[[Measure], dict[str, Any]]


def _exactly(count: int) -> dict[str, Any]:
    return {"minItems": count, "maxItems": count}


def _values(count: int, words: str) -> Callable[[Measure], dict[str, Any]]:
    return lambda measure: {"type": "array", "description": words, "items": measure.schema(), **_exactly(count)}


def _normal_schema(measure: Measure) -> dict[str, Any]:
    return {
        "type": "object",
        "description": "cut off at 3 standard deviations and at the ends of what is permitted",
        "properties": {"mean": measure.schema(), "sd": _spread_of(measure).schema()},
        "required": ["mean", "sd"],
        "additionalProperties": False,
    }


_KINDS: Mapping[str, _Kind] = {
    "uniform": _Kind(Uniform, _uniform, lambda d, m: [m.write(d.lower), m.write(d.upper)], _values(2, "[low, high]")),
    "loguniform": _Kind(
        LogUniform, _loguniform, lambda d, m: [m.write(d.lower), m.write(d.upper)], _values(2, "[low, high]")
    ),
    "triangular": _Kind(
        Triangular,
        _triangular,
        lambda d, m: [m.write(d.lower), m.write(d.mode), m.write(d.upper)],
        _values(3, "[low, mode, high]"),
    ),
    "normal": _Kind(
        Normal, _normal, lambda d, m: {"mean": m.write(d.mean), "sd": _spread_of(m).write(d.sd)}, _normal_schema
    ),
}


def _written(distribution: Distribution, measure: Measure) -> dict[str, Any]:
    (found,) = ((name, kind) for name, kind in _KINDS.items() if isinstance(distribution, kind.made))
    return {found[0]: found[1].write(distribution, measure)}


def _one_of_the_kinds(measure: Measure) -> dict[str, Any]:
    return {
        "type": "object",
        "properties": {name: kind.schema(measure) for name, kind in _KINDS.items()},
        "additionalProperties": False,
        "minProperties": 1,
        "maxProperties": 1,
    }
