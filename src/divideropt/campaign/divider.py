"""The `model` section of a campaign for the flow divider: parameters, scenario, solver."""

from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Annotated, Any

from pydantic import Field, PlainSerializer, PlainValidator, WithJsonSchema
from pydantic_core import InitErrorDetails

from divideropt.campaign import schemas
from divideropt.campaign.fields import POSITIVE, Measure, OneOf, Tables, by_name, measure_of
from divideropt.campaign.sections import Section, collect, mistake, show
from divideropt.models import Domain
from divideropt.models.divider.formulations import FORMULATIONS
from divideropt.models.divider.parameters import PARAMETER_SETS, PARAMETERS, parameter_set
from divideropt.models.divider.quantities import QUANTITIES
from divideropt.models.divider.scenario import Scenario
from divideropt.models.divider.tolerances import (
    DEFAULT_MAX_STEPS,
    DEFAULT_METHOD,
    DEFAULT_RTOL,
    STATE_UNITS,
    default_atol,
)
from divideropt.ode import METHODS, SolverSettings

Pressure = Annotated[float, Measure("Pa", POSITIVE)]
Time = Annotated[float, Measure("s", POSITIVE)]

DIVIDER_TABLES = Tables(PARAMETERS, QUANTITIES)
"""The names a campaign for the divider may use."""

_STARTS = MappingProxyType({"settled": "at the equilibrium before the step", "cold": "all states zero"})
_DEFAULT_END = 1.0


class StepConfig(Section):
    """The load step."""

    load: Annotated[int, Field(strict=True, ge=1, le=2)] = 1
    """Which load steps."""
    to: Pressure = 15e6
    """Its steady pressure after the step."""
    at: Time | None = None
    """When, for a cold start; a settled one begins with the step."""


class ScenarioConfig(Section):
    """What happens to the valve (section 3.1 of the thesis)."""

    source_flow: Annotated[float, Measure("m^3/s", POSITIVE)] = 1e-3
    """Qs."""
    spool_position: Annotated[float, Measure("", Domain(0.0, 1.0, open_lower=True, open_upper=True))] = 0.5
    """φ/φ0, the angle that sets the ratio."""
    load_pressures: tuple[Pressure, Pressure] = (10e6, 10e6)
    """Steady load pressures before the step, by which the load orifices are sized."""
    step: StepConfig = StepConfig()
    """The load step."""
    start: Annotated[str, OneOf("start", _STARTS)] = "settled"
    """`settled`: at the equilibrium before the step; `cold`: all states zero."""
    horizon: Time | None = Field(default_factory=lambda data: _end_if(data, "settled"))
    """How long a settled start is simulated, from the step on; 1 s where not given."""
    end: Time | None = Field(default_factory=lambda data: _end_if(data, "cold"))
    """When the simulation of a cold start ends; 1 s where not given."""
    accumulation_time: Time = 0.2
    """t_cum of (3.8), (3.11), (3.12)."""

    def to_scenario(self) -> Scenario:
        """Return what the model simulates."""
        return Scenario(
            source_flow=self.source_flow,
            spool_position=self.spool_position,
            load_pressures=self.load_pressures,
            step_load=self.step.load,
            step_pressure=self.step.to,
            settled=self.start == "settled",
            step_time=self.step.at or 0.0,
            end_time=self.horizon or self.end or _DEFAULT_END,
            accumulation_time=self.accumulation_time,
        )

    @classmethod
    def rules(cls, raw: Mapping[str, Any]) -> Iterator[InitErrorDetails]:
        """Say which times go with which start."""
        yield from _accumulated_by_the_end(raw)
        step = raw.get("step") or {}
        at = step.get("at") if isinstance(step, Mapping) else None
        if raw.get("start", "settled") == "settled":
            if at is not None:
                sentence = "a settled start begins with the step; delete `at`, or write start: cold"
                yield mistake(("step", "at"), sentence, at_key=True)
            if raw.get("end") is not None:
                yield mistake(("end",), "a settled start lasts its `horizon`; rename `end`", at_key=True)
        elif raw["start"] == "cold":
            if at is None:
                yield mistake(("step", "at"), "a cold start needs the time of the step; add `at: 50 ms` to the step")
            if raw.get("horizon") is not None:
                yield mistake(("horizon",), "a cold start runs to its `end`; rename `horizon`", at_key=True)
            yield from _end_after_step(raw.get("end"), at)


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
    set: Annotated[
        Mapping[str, float],
        PlainValidator(by_name("parameters", lambda parameter, raw: measure_of(parameter).read(raw))),
        WithJsonSchema(schemas.parameters()),
    ] = Field(default_factory=dict)
    """Parameters that differ from the set."""
    scenario: ScenarioConfig = Field(default_factory=ScenarioConfig)
    """What happens to the valve."""
    solver: SolverConfig = Field(default_factory=SolverConfig)
    """How the response is integrated."""

    def base_parameters(self) -> dict[str, float]:
        """Return every parameter by name, SI, as each design has it but for the variables."""
        return parameter_set(self.parameters) | dict(self.set)

    def tables(self) -> Tables:
        """Return the model's parameters and quantities by name."""
        return DIVIDER_TABLES


def _end_if(data: Mapping[str, Any], start: str) -> float | None:
    return _DEFAULT_END if data.get("start") == start else None


def _accumulated_by_the_end(raw: Mapping[str, Any]) -> Iterator[InitErrorDetails]:
    step = raw.get("step") or {}
    cold = raw.get("start") == "cold"
    at = step.get("at") if cold and isinstance(step, Mapping) else None
    end = raw.get("end" if cold else "horizon")
    try:
        begin = 0.0 if at is None else Measure("s").read(at)
        last = _DEFAULT_END if end is None else Measure("s").read(end)
        needed = Measure("s").read(raw.get("accumulation_time", "0.2 s"))
    except ValueError:  # has its own mistake
        return
    if begin < last < (begin + needed) * (1 - 1e-9):
        where = "accumulation_time" if "accumulation_time" in raw else "end" if cold else "horizon"
        sentence = (
            f"the simulation ends {last - begin:g} s after the step, before the accumulation time of {needed:g} s"
        )
        yield mistake((where,), f"{sentence}; simulate longer, or accumulate for less")


def _end_after_step(end: object, at: object) -> Iterator[InitErrorDetails]:
    try:
        last = _DEFAULT_END if end is None else Measure("s").read(end)
        step = Measure("s").read(at)
    except ValueError:  # has its own mistake
        return
    if last <= step:
        where = ("step", "at") if end is None else ("end",)
        yield mistake(where, f"the simulation ends at {last:g} s, not after the step at {step:g} s; end it later")


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
