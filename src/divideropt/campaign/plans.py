"""The `strategies` section: which methods run, with which options and seeds."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated, Any, cast

from pydantic import AfterValidator, Field, TypeAdapter, ValidationError

from divideropt.campaign.reader import MOST_MISTAKES
from divideropt.campaign.sections import collect, mistake, relay, show, together, unknown
from divideropt.campaign.termination import TerminationConfig, termination_schema
from divideropt.strategies import METHODS, SAMPLINGS, STRATEGIES, Strategy

LARGEST_SEED = 2**32 - 1
"""What NumPy's oldest generators take."""


@dataclass(frozen=True)
class StrategyPlan:
    """A strategy as a campaign wants it run.

    Attributes:
        name: A key of `METHODS`.
        options: The strategy with its options.
        seeds: One run each, in this order.
        termination: By which rules they end before their budget is spent; None by none.
    """

    name: str
    options: Strategy
    seeds: tuple[int, ...]
    termination: TerminationConfig | None = None

    @property
    def window(self) -> int | None:
        """Evaluations over which its termination looks for stagnation, None where it does not."""
        stagnation = None if self.termination is None else self.termination.stagnation
        return None if stagnation is None else stagnation.window

    def as_written(self) -> dict[str, Any]:
        """Return options, seeds and termination as a campaign's file has them."""
        options = dataclasses.asdict(cast(Any, self.options))
        ending = {} if self.termination is None else {"termination": self.termination.as_written()}
        given = {key: value for key, value in options.items() if value is not None}
        return given | {"seeds": list(self.seeds)} | ending


def read_plans(value: object) -> tuple[StrategyPlan, ...]:
    """Read the section; raises ValueError or ValidationError with every mistake."""
    plans = tuple(collect(value, METHODS, "strategy", _plan).values())
    if not plans:
        raise ValueError(f"there is no strategy here; name at least one of {', '.join(STRATEGIES)}")
    return plans


def plans_schema() -> dict[str, Any]:
    """Describe the section in JSON schema."""
    return {
        "type": "object",
        "description": "Which methods run, by name.",
        "properties": {name: _plan_schema(strategy) for name, strategy in METHODS.items()},
        "additionalProperties": False,
        "minProperties": 1,
    }


def needs_goals(name: str) -> bool:
    """Whether a strategy of that name makes one objective of several, by their goals."""
    return "aggregate" in _option_names(METHODS[name]) if name in METHODS else False


def is_study(strategies: Mapping[str, object]) -> bool:
    """Whether strategies, by name, only lay designs out, as those of a sensitivity study do.

    Then a variable may have a value in `model.set` too: that from which the others are varied.
    """
    return bool(strategies) and all(name in SAMPLINGS for name in strategies)


_BESIDES = ("seeds", "termination")
"""What any strategy has besides its options."""


def _distinct(seeds: tuple[int, ...]) -> tuple[int, ...]:
    if not seeds:
        raise ValueError("the list is empty, so the strategy would not run; write a seed, or delete the strategy")
    first = {seed: i for i, seed in reversed(list(enumerate(seeds)))}
    found = [
        mistake((i,), f"the seed {seed} is here a second time, and would only repeat a run; delete it")
        for i, seed in enumerate(seeds)
        if i > first[seed]
    ]
    if found:
        raise together(found)
    return seeds


_Seed = Annotated[int, Field(strict=True, ge=0, le=LARGEST_SEED)]
_SEEDS: TypeAdapter[tuple[int, ...]] = TypeAdapter(Annotated[tuple[_Seed, ...], AfterValidator(_distinct)])


def _plan(name: str, raw: object) -> StrategyPlan:
    if raw is not None and not isinstance(raw, Mapping):
        raise ValueError(f"{show(raw)} is not a mapping; write options in braces, such as {name}: {{seeds: [1]}}")
    given = dict(raw or {})
    known = _option_names(METHODS[name])
    found = [
        mistake((key,), unknown("option", key, [*known, *_BESIDES]), at_key=True)
        for key in list(given)[:MOST_MISTAKES]
        if key not in known and key not in _BESIDES
    ]
    seeds: tuple[int, ...] = ()
    options: Any = None
    try:
        seeds = _SEEDS.validate_python(given.get("seeds", [1]))
    except ValidationError as error:
        found += relay(error, ("seeds",))
    try:
        options = cast(Any, METHODS[name])(**{key: given[key] for key in known if key in given})
    except ValidationError as error:
        found += relay(error)
    termination: TerminationConfig | None = None
    try:
        if given.get("termination") is not None:
            termination = TerminationConfig.model_validate(given["termination"])
    except ValidationError as error:
        found += relay(error, ("termination",))
    if found:
        raise together(found)
    return StrategyPlan(name, options, seeds, termination)


def _option_names(strategy: type[Strategy]) -> list[str]:
    return [option.name for option in dataclasses.fields(cast(Any, strategy))]


def _plan_schema(strategy: type[Strategy]) -> dict[str, Any]:
    schema = TypeAdapter(strategy).json_schema()
    seeds = _SEEDS.json_schema() | {
        "description": "One run each.",
        "minItems": 1,
        "uniqueItems": True,
        "default": [1],
    }
    properties = {**schema.get("properties", {}), "seeds": seeds, "termination": termination_schema()}
    return {**schema, "type": ["object", "null"], "properties": properties, "additionalProperties": False}
