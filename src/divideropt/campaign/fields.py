"""Fields of a campaign's sections: measures and names, as read, as written back, as the schema has them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

from pydantic import GetCoreSchemaHandler, GetJsonSchemaHandler, ValidationInfo
from pydantic_core import CoreSchema, core_schema

from divideropt.campaign.sections import V, collect, show, unknown
from divideropt.models import Domain, Parameter, Quantity
from divideropt.units import LONGEST, NUMBER, UNIT, format_measure, parse_measure

POSITIVE = Domain(lower=0.0, open_lower=True)
FINITE = Domain()

_BARE = rf"^\s*{NUMBER}\s*(?:{UNIT})?\s*$"
_WITH_UNIT = rf"^\s*{NUMBER}\s*{UNIT}\s*$"


@dataclass(frozen=True)
class Measure:
    """A number with a unit in the file, a float in that unit inside.

    Attributes:
        unit: The unit inside; "" for a number without dimension.
        domain: What is permitted, in `unit`.
    """

    unit: str = ""
    domain: Domain = FINITE

    def read(self, value: object) -> float:
        """Read a value as the file has it; raises ValueError with a sentence."""
        finite = not isinstance(value, float) or value - value == 0.0
        if isinstance(value, bool) or not isinstance(value, str | int | float) or not finite:
            raise ValueError(f"{show(value)} is not {self._wanted()}")
        try:
            number = parse_measure(value, self.unit)
        except (ArithmeticError, TypeError, AssertionError):
            # pint has logarithmic and offset units (dB, degC), which it cannot multiply by
            raise ValueError(f"{show(value)} has a unit that is no factor; write {self._wanted()}") from None
        if not self.domain.contains(number):
            limit = f"{self.domain} {self.unit}".rstrip()
            raise ValueError(f"{show(value)} is out of range; what is permitted is {limit}")
        return number

    def write(self, value: float) -> str | float:
        """Write it so that `read` gives the same bits again."""
        return format_measure(value, self.unit) if self.unit else value

    def schema(self, description: str = "") -> dict[str, Any]:
        """Describe in JSON schema what `read` accepts."""
        words = [description] if description else []
        if not self.unit:
            return {
                "type": ["number", "string"],
                "pattern": _BARE,
                "maxLength": LONGEST,
                "description": ", ".join([*words, "without unit"]),
                **self._limits(),
            }
        unit = f'in {self.unit} or any unit of that kind, such as "1 {self.unit}"'
        described = {"description": ", ".join([*words, unit])}
        return {"type": "string", "pattern": _WITH_UNIT, "maxLength": LONGEST, **described}

    def _limits(self) -> dict[str, float]:
        lower = "exclusiveMinimum" if self.domain.open_lower else "minimum"
        upper = "exclusiveMaximum" if self.domain.open_upper else "maximum"
        limits = {lower: self.domain.lower, upper: self.domain.upper}
        return {key: limit for key, limit in limits.items() if limit - limit == 0.0}

    def _wanted(self) -> str:
        return f"a number with a unit, such as 1 {self.unit}" if self.unit else "a finite number without a unit"

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Let pydantic read with `read` and dump with `write`."""
        writing = core_schema.plain_serializer_function_ser_schema(self.write, when_used="json")
        return core_schema.no_info_plain_validator_function(self.read, serialization=writing)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Let pydantic describe it by `schema`."""
        return self.schema()


class GivenMeasure:
    """A measure whose unit hangs on the name it is given for: the validation's context is that `Measure`."""

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Let pydantic read with the context."""
        return core_schema.with_info_plain_validator_function(lambda value, info: info.context.read(value))


@dataclass(frozen=True)
class OneOf:
    """A name out of several.

    Attributes:
        what: What the name is of: "formulation", "solver", …
        names: The names there are, as keys.
    """

    what: str
    names: Mapping[str, object] = field(hash=False)

    def read(self, value: object) -> str:
        """Read a value as the file has it; raises ValueError with a sentence."""
        if not isinstance(value, str) or value not in self.names:
            raise ValueError(unknown(self.what, value if isinstance(value, str) else show(value), self.names))
        return value

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        """Let pydantic read with `read`."""
        return core_schema.no_info_plain_validator_function(self.read)

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        """Let pydantic describe it as an enumeration."""
        return {"enum": list(self.names)}


@dataclass(frozen=True)
class Tables:
    """The names a campaign may use, which hang on its model: the context of its validation.

    Attributes:
        parameters: The model's parameters; None without a model, when no name can be judged.
        quantities: The model's quantities, or None likewise.
    """

    parameters: Mapping[str, Parameter] | None = None
    quantities: Mapping[str, Quantity] | None = None


def measure_of(entry: Parameter | Quantity) -> Measure:
    """Return the measure in which a parameter, within its domain, or a quantity is given."""
    return Measure(entry.unit, entry.domain if isinstance(entry, Parameter) else FINITE)


def by_name(
    table: Literal["parameters", "quantities"], read: Callable[[Any, object], V], least: int = 0
) -> Callable[[Any, ValidationInfo], dict[str, V]]:
    """Make a validator of a mapping from a model's names.

    Args:
        table: Whose names.
        read: Reads an entry, given the parameter or quantity and what is written; raises ValueError.
        least: How many entries are needed.

    Returns:
        For pydantic's `PlainValidator`; the validation's context is `Tables`.
    """

    def validate(value: Any, info: ValidationInfo) -> dict[str, V]:
        known = getattr(info.context, table)
        if known is None:
            return {}
        what = {"parameters": "parameter", "quantities": "quantity"}[table]
        made = collect(value, known, what, lambda name, raw: read(known[name], raw))
        if len(made) < least:
            raise ValueError(f"there is no {what} here; name at least {least}")
        return made

    return validate
