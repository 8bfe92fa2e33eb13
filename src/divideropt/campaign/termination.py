"""The `termination` of a strategy: by which rules its runs end before their budget is spent."""

from collections.abc import Iterator, Mapping
from typing import Annotated, Any, Self

from pydantic import Field, model_validator
from pydantic_core import InitErrorDetails

from divideropt.campaign.fields import Measure
from divideropt.campaign.sections import Section, mistake
from divideropt.models import Domain

PERCENT = Domain(0.0, 100.0, open_lower=True)


class StagnationConfig(Section):
    """Ends a run whose hypervolume has all but ceased to grow."""

    window: Annotated[int, Field(strict=True, ge=10, le=10**9)]
    """Over so many evaluations the growth is measured."""
    gain: Annotated[float, Measure("%", PERCENT)]
    """The growth below which the run ends, as a share of the hypervolume at the window's beginning."""


class TerminationConfig(Section):
    """When a run ends; the first rule that holds after a batch ends it."""

    goals: Annotated[bool, Field(strict=True)] = False
    """Whether to end with the first feasible design of which every objective is at its goal or below."""
    stagnation: StagnationConfig | None = None
    """Ends a run whose hypervolume has all but ceased to grow."""

    @model_validator(mode="after")
    def _some_rule(self) -> Self:
        if not self.goals and self.stagnation is None:
            raise ValueError("there is no rule here; write goals: true or stagnation: {…}, or delete `termination`")
        return self

    def as_written(self) -> dict[str, Any]:
        """Return the rules as a campaign's file has them."""
        written: dict[str, Any] = self.model_dump(mode="json", exclude_none=True)
        return written


def termination_schema() -> dict[str, Any]:
    """Describe it in JSON schema, without references."""
    schema = TerminationConfig.model_json_schema()
    del schema["$defs"]
    stagnation = StagnationConfig.model_json_schema()
    schema["properties"]["stagnation"] = {**stagnation, "type": ["object", "null"]}
    return {**schema, "type": ["object", "null"]}


def termination_rules(raw: Mapping[str, Any]) -> Iterator[InitErrorDetails]:
    """Say what the rules of a campaign, as written, need and lack: a reference point, goals."""
    plans = _section(raw.get("strategies"))
    rules = {name: _section(_section(plan).get("termination")) for name, plan in plans.items()}
    for name, rule in rules.items():
        if rule.get("stagnation") and not raw.get("reference_point"):
            sentence = (
                "the campaign has no reference point from which a hypervolume is measured; add reference_point, "
                "a value for every objective, or delete `stagnation`"
            )
            yield mistake(("strategies", name, "termination", "stagnation"), sentence, at_key=True)
    reaching = ", ".join(name for name, rule in rules.items() if rule.get("goals") is True)
    for name, objective in _section(raw.get("objectives")).items():
        if reaching and _section(objective).get("goal") is None:
            sentence = f"{name} has no goal, which {reaching} is to reach (termination); give one, {{goal: …}}"
            yield mistake(("objectives", name), sentence, at_key=True)


def _section(value: object) -> Mapping[str, Any]:
    return value if isinstance(value, Mapping) else {}
