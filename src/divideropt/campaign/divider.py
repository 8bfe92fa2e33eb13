"""The `model` section of a campaign for the flow divider: parameters, scenario, solver."""

import re
from collections.abc import Iterator, Mapping
from typing import Annotated

from pydantic import AfterValidator, BeforeValidator, Field, PlainSerializer, PlainValidator, WithJsonSchema

from divideropt.campaign import schemas
from divideropt.campaign.fields import POSITIVE, Measure, OneOf, Tables
from divideropt.campaign.scenario import MOST_EVENTS, NamedScenarioConfig, ParameterValues, ScenarioConfig
from divideropt.campaign.sections import Section, collect, mistake, show, together
from divideropt.models import Domain
from divideropt.models.divider.formulations import FORMULATIONS
from divideropt.models.divider.parameters import PARAMETER_SETS, PARAMETERS, parameter_set
from divideropt.models.divider.scenario import Scenario
from divideropt.models.divider.scenarios import BASE, quantities_by_scenario
from divideropt.models.divider.tolerances import (
    DEFAULT_MAX_STEPS,
    DEFAULT_METHOD,
    DEFAULT_RTOL,
    STATE_UNITS,
    default_atol,
)
from divideropt.ode import METHODS, SolverSettings

_LOSSES = {"none": "as section 2.3 assumes", "entrance": "`groove_loss_factor` velocity heads, at both ends"}
_SCENARIO_NAME = re.compile(schemas.scenario_name(), re.ASCII)


MOST_SCENARIOS = 50
"""More are a slip: each simulates every design once more."""


def divider_tables(model: object) -> Tables:
    """Return the names a campaign may use, which hang on its scenarios.

    Args:
        model: The `model` section as written, right or wrong.
    """
    section = model if isinstance(model, Mapping) else {}
    others = section.get("scenarios")
    named = others if isinstance(others, Mapping) else {}
    scenarios = {BASE: section.get("scenario"), **{str(name): raw for name, raw in _few(named).items()}}
    return Tables(PARAMETERS, quantities_by_scenario({name: _measured(raw) for name, raw in scenarios.items()}))


def _measured(scenario: object) -> tuple[int, ...]:
    """The events of a scenario as written that have metrics; of a wrong one all that it seems to have."""
    happens = {key: v for key, v in scenario.items() if key != "set"} if isinstance(scenario, Mapping) else scenario
    try:
        return ScenarioConfig.model_validate(happens or {}).to_scenario().measured_events
    except ValueError:  # has its own mistakes
        events = scenario.get("events") if isinstance(scenario, Mapping) else None
        return tuple(range(1, len(events[:MOST_EVENTS]))) if isinstance(events, list | tuple) else ()


def _few(named: Mapping[str, object]) -> dict[str, object]:
    """Return no more scenarios than there may be, and no more events: each event makes fifteen columns."""
    left, found = MOST_EVENTS, {}
    for name, raw in list(named.items())[:MOST_SCENARIOS]:
        events = raw.get("events") if isinstance(raw, Mapping) else None
        left -= len(events) if isinstance(events, list | tuple) else 1
        if left < 0:
            break
        found[name] = raw
    return found


def _few_scenarios(scenarios: object) -> object:
    """Refuse too many scenarios, or too many events in them together, before each is judged."""
    if isinstance(scenarios, Mapping) and len(_few(scenarios)) < len(scenarios):
        raise ValueError(
            f"there are {len(scenarios)} scenarios here; write at most {MOST_SCENARIOS}, with {MOST_EVENTS} events "
            "together"
        )
    return scenarios


def _named(scenarios: Mapping[str, NamedScenarioConfig]) -> Mapping[str, NamedScenarioConfig]:
    found = [mistake((name,), sentence, at_key=True) for name in scenarios for sentence in _objections_to(name)]
    if found:
        raise together(found)
    return scenarios


def _objections_to(name: str) -> Iterator[str]:
    if name == BASE:
        yield f"{BASE!r} is the name of the scenario above; give this one another"
    elif name in schemas.RESERVED_NAMES or name.startswith("event_"):
        yield f"{show(name)} already means something else; give the scenario another"
    elif not _SCENARIO_NAME.fullmatch(name):
        yield f"{show(name)} cannot name a scenario; use 1 to 32 of a-z, 0-9 and _, a letter first"


class SolverConfig(Section):
    """How the response is integrated."""

    method: Annotated[str, OneOf("solver", METHODS)] = DEFAULT_METHOD
    """Name of the solver."""
    rtol: Annotated[float, Measure("", Domain(1e-13, 1e-1))] = DEFAULT_RTOL
    """Relative tolerance."""
    atol: Annotated[
        tuple[float, ...],
        PlainValidator(lambda value, info: _atol(value, info.data.get("rtol", DEFAULT_RTOL))),
        PlainSerializer(lambda value: _written_atol(value), when_used="json"),  # noqa: PLW0108 (stands below)
        WithJsonSchema(schemas.tolerances()),
    ] = Field(default_factory=lambda data: default_atol(data["rtol"]))
    """Absolute tolerance of each state."""
    max_steps: Annotated[int, Field(strict=True, ge=1, le=10**9)] = DEFAULT_MAX_STEPS
    """Budget of accepted steps between two events."""

    def to_settings(self) -> SolverSettings:
        """Return what the solver reads."""
        return SolverSettings(self.method, self.rtol, self.atol, self.max_steps)


class DividerConfig(Section):
    """The adjustable-ratio flow divider of the thesis."""

    kind: Annotated[str, OneOf("model", {"divider": "the flow divider"})]
    """Which model; `package.module:Class` names one of your own."""
    formulation: Annotated[str, OneOf("formulation", FORMULATIONS)] = "conservative"
    """Which reading of the thesis's equations."""
    parameters: Annotated[str, OneOf("parameter set", PARAMETER_SETS)] = "thesis_base"
    """The parameter set to begin with."""
    set: ParameterValues = Field(default_factory=dict)
    """Parameters that differ from the set."""
    groove_loss: Annotated[str, OneOf("groove loss", _LOSSES)] = "none"
    """What a pilot groove's entrance and exit take off its pressure drop."""
    scenario: ScenarioConfig = Field(default_factory=ScenarioConfig)
    """What happens to the valve."""
    scenarios: Annotated[
        Mapping[str, NamedScenarioConfig],
        BeforeValidator(_few_scenarios),
        AfterValidator(_named),
        Field(
            json_schema_extra={"propertyNames": {"pattern": schemas.scenario_name()}, "maxProperties": MOST_SCENARIOS}
        ),
    ] = Field(default_factory=dict)
    """What else happens to each design, by names for `worst_of`; each complete in itself."""
    solver: SolverConfig = Field(default_factory=SolverConfig)
    """How the response is integrated."""

    @property
    def deadline(self) -> None:
        """None: a simulation ends by its budget of steps, `solver.max_steps`."""

    def base_parameters(self) -> dict[str, float]:
        """Return every parameter by name, SI, as each design has it but for the variables."""
        return parameter_set(self.parameters) | dict(self.set)

    def changes(self) -> dict[str, dict[str, float]]:
        """Return what each scenario sets, by its name and the parameter's, SI; only of those that set something."""
        return {name: dict(scenario.set) for name, scenario in self.scenarios.items() if scenario.set}

    def tables(self) -> Tables:
        """Return the model's parameters and quantities by name."""
        events = {name: scenario.measured_events for name, scenario in self.all_scenarios().items()}
        return Tables(PARAMETERS, quantities_by_scenario(events))

    def all_scenarios(self) -> dict[str, Scenario]:
        """Return every scenario by name, that of `scenario` first."""
        return {name: s.to_scenario() for name, s in {BASE: self.scenario, **self.scenarios}.items()}


def _atol(value: object, rtol: float) -> tuple[float, ...]:
    if isinstance(value, list | tuple):
        if len(value) != len(STATE_UNITS):
            raise ValueError(f"the list has {len(value)} tolerances; write {len(STATE_UNITS)}, one a state")
        units = list(STATE_UNITS.values())
        by_index = dict(enumerate(value))
        return tuple(
            collect(by_index, by_index, "state", lambda i, raw: Measure(units[i], POSITIVE).read(raw)).values()
        )
    if not isinstance(value, Mapping):
        raise ValueError(f"{show(value)} is neither a list of tolerances nor a mapping; write {{x: 1e-8 m}}, say")
    given = collect(value, STATE_UNITS, "state", lambda name, raw: Measure(STATE_UNITS[name], POSITIVE).read(raw))
    return tuple(given.get(name, tolerance) for name, tolerance in zip(STATE_UNITS, default_atol(rtol), strict=True))


def _written_atol(value: tuple[float, ...]) -> dict[str, str | float]:
    return {
        name: Measure(unit).write(number) for (name, unit), number in zip(STATE_UNITS.items(), value, strict=True)
    }
