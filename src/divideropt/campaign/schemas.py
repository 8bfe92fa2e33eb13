"""JSON schema of the sections whose keys are the divider's parameters and quantities."""

from collections.abc import Callable, Sequence
from typing import Any

from divideropt.campaign.fields import POSITIVE, Measure, measure_of
from divideropt.models import Parameter, Quantity
from divideropt.models.divider.parameters import PARAMETERS
from divideropt.models.divider.quantities import QUANTITIES
from divideropt.models.divider.scenarios import BASE, GATHERED
from divideropt.models.divider.tolerances import STATE_UNITS
from divideropt.models.statistic import KINDS
from divideropt.models.uncertain import FAILED_SHARE

Schema = dict[str, Any]


def parameters() -> Schema:
    """Values of parameters."""
    return _mapping("Parameters that differ from the set.", {p.name: _value(p) for p in PARAMETERS.values()})


def variables() -> Schema:
    """Ranges of parameters."""
    return _mapping("What varies, and between which bounds.", {p.name: _range(p) for p in PARAMETERS.values()}, 1)


def study() -> Schema:
    """Ranges of parameters in a study."""
    return _mapping("What is studied, and between which ends.", {p.name: _range(p) for p in PARAMETERS.values()})


def objectives() -> Schema:
    """Goals and weights of quantities."""
    return _prefixable(_mapping("What is minimised.", _each(_objective), 1))


def constraints() -> Schema:
    """Bounds of quantities."""
    return _prefixable(_mapping("What a feasible design keeps; bounds are inclusive.", _each(_constraint)))


def uncertain(entries: Schema) -> Schema:
    """Distributions of parameters, each described by its name."""
    return _mapping("What is uncertain of each design, and how.", entries, 1)


def uncertainty_rules() -> Schema:
    """What a campaign without `uncertainty` cannot ask for: statistics, and the share of samples that fail."""
    plain = {"type": "object", "additionalProperties": {"not": _given("statistic")}}
    sections = ("objectives", "constraints", "reference_point")
    unasked = {name: {"properties": {FAILED_SHARE.name: False}} for name in sections}
    without = {
        name: {"allOf": [unasked[name], plain]} if name in sections[:2] else unasked[name] for name in sections
    }
    return {"if": {"not": _given("uncertainty")}, "then": {"properties": without}}


def with_shared_measures(schema: Schema, section: str) -> Schema:
    """Define each kind of measure in a section once, where it would stand there hundreds of times."""
    found: Schema = {}
    definitions = schema["$defs"]
    shared = {section: _refer(definitions[section], found)}
    return {**schema, "$defs": {**definitions, **shared, **found}}


def _refer(node: Any, found: Schema) -> Any:
    """Replace measures by references to their definitions, of which those that are new are added to `found`."""
    if isinstance(node, list):
        return [_refer(part, found) for part in node]
    if not isinstance(node, dict):
        return node
    if "pattern" not in node:
        return {key: _refer(part, found) for key, part in node.items()}
    names = [name for name, measure in found.items() if measure == node] or [f"Measure{len(found) + 1}"]
    found[names[0]] = node
    return {"$ref": f"#/$defs/{names[0]}"}


def reference_point() -> Schema:
    """Values of quantities."""
    description = "Where the hypervolume is measured from: a value for every objective."
    return _prefixable(_mapping(description, _each(_value)))


def tolerances() -> Schema:
    """Absolute tolerances of the states: a mapping by name, or a list of all."""
    states = {name: Measure(unit, POSITIVE).schema() for name, unit in STATE_UNITS.items()}
    listed = {"type": "array", "items": {"type": "string"}, "minItems": len(states), "maxItems": len(states)}
    description = "Absolute tolerances; rtol × a scale of the state where not given."
    return {"description": description, "anyOf": [_mapping("By state.", states), listed]}


def _prefixable(schema: Schema) -> Schema:
    """Let names begin with an event or a scenario, which the schema cannot know: `event_1.settling_time`."""
    return {**schema, "patternProperties": {rf"^([a-z][a-z0-9_]*\.){{1,2}}({'|'.join(QUANTITIES)})$": {}}}


def event_rules(changes: Sequence[str]) -> Schema:
    """What an event needs besides its fields: a change, and of a load, which and to what."""
    both = {"allOf": [_given("load"), _given("load_pressures")]}
    return {
        "anyOf": [_given(name) for name in changes],
        "allOf": [
            {"if": _given("load"), "then": _given("to")},
            {"if": _given("to"), "then": _given("load")},
            {"not": both},
        ],
    }


def scenario_rules() -> Schema:
    """Which fields of a scenario go with which start and with each other."""
    events = {"type": "object", "required": ["events"], "properties": {"events": {"minItems": 1}}}
    timed = {"type": "object", "required": ["step"], "properties": {"step": _given("at")}}
    cold = {"type": "object", "required": ["start"], "properties": {"start": {"const": "cold"}}}
    return {
        "allOf": [{"not": {"allOf": [_given("step"), events]}}],
        "if": cold,
        "then": {"not": _given("horizon"), "anyOf": [events, timed]},
        "else": {"not": {"anyOf": [_given("end"), timed]}},
    }


def _given(name: str) -> Schema:
    """Whether a field is there, and not null."""
    return {"type": "object", "required": [name], "properties": {name: {"not": {"type": "null"}}}}


EVERY = "all"
"""Stands for every scenario of a campaign, under `worst_of`."""

RESERVED_NAMES = (*GATHERED, EVERY)
"""What no scenario is called: what a column's name may begin with already, and what stands for every scenario."""


def scenario_name() -> str:
    """Pattern of a scenario's name."""
    others = "|".join([BASE, *RESERVED_NAMES])
    return rf"^(?!({others})$|event_)[a-z][a-z0-9_]{{0,31}}$"


def _each(describe: Callable[[Quantity], Schema]) -> Schema:
    return {q.name: describe(q) for q in (*QUANTITIES.values(), FAILED_SHARE)}


def _mapping(description: str, properties: Schema, least: int = 0) -> Schema:
    return {
        "type": "object",
        "description": description,
        "properties": properties,
        "additionalProperties": False,
        "minProperties": least,
    }


def _value(entry: Parameter | Quantity) -> Schema:
    return measure_of(entry).schema(f"{entry.description} ({entry.symbol})" if entry.symbol else entry.description)


def _range(parameter: Parameter) -> Schema:
    value = _value(parameter)
    return {
        "type": "array",
        "description": f"[lower, upper]; {value.pop('description')}",
        "items": value,
        "minItems": 2,
        "maxItems": 2,
    }


def _objective(quantity: Quantity) -> Schema:
    weight = Measure("", POSITIVE).schema("w of (3.24)")
    section = _mapping(
        quantity.description, {"goal": _or_null(_value(quantity)), "weight": weight, **_gathering(quantity)}
    )
    return {**section, "type": ["object", "null"]}


def _constraint(quantity: Quantity) -> Schema:
    bound = _or_null(_value(quantity))
    return _mapping(quantity.description, {"min": bound, "max": bound, **_gathering(quantity)}, 1)


def _gathering(quantity: Quantity) -> Schema:
    """Over what a quantity is taken: scenarios, samples; the share of samples that fail is over these already."""
    return {} if quantity is FAILED_SHARE else {"worst_of": _worst_of(), "statistic": _or_null(_statistic())}


def _statistic() -> Schema:
    words = "Of the samples of `uncertainty`: mean, sd, or a percentile such as p95."
    return {"type": "string", "pattern": rf"^({KINDS})$", "description": words}


def _worst_of() -> Schema:
    description = f"Scenarios of which the worst counts: names of `model.scenarios`, or `scenario`; or `{EVERY}`."
    return {
        "description": description,
        "anyOf": [{"const": EVERY}, {"type": "array", "items": {"type": "string"}}],
    }


def _or_null(schema: Schema) -> Schema:
    kinds = schema["type"] if isinstance(schema["type"], list) else [schema["type"]]
    return {**schema, "type": [*kinds, "null"]}
