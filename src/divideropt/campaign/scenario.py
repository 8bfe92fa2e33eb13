"""The `scenario` of a campaign for the flow divider: what happens to the valve, and when."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import pairwise
from types import MappingProxyType
from typing import Annotated, Any

from pydantic import ConfigDict, Field, PlainValidator, WithJsonSchema, model_validator
from pydantic_core import InitErrorDetails

from divideropt.campaign import schemas
from divideropt.campaign.fields import POSITIVE, Measure, OneOf, by_name, measure_of
from divideropt.campaign.sections import Section, mistake, together
from divideropt.models import Domain
from divideropt.models.divider.scenario import INSTANT, Event, Scenario, load_step

Pressure = Annotated[float, Measure("Pa", POSITIVE)]
Flow = Annotated[float, Measure("m^3/s", POSITIVE)]
Position = Annotated[float, Measure("", Domain(0.0, 1.0, open_lower=True, open_upper=True))]
Time = Annotated[float, Measure("s", POSITIVE)]
Instant = Annotated[float, Measure("s", Domain(0.0))]
Load = Annotated[int, Field(strict=True, ge=1, le=2)]

_STARTS = MappingProxyType({"settled": "at the equilibrium before the first event", "cold": "all states zero"})
MOST_EVENTS = 100
"""More in one scenario is a slip; each makes fifteen columns."""

_DEFAULT_END = 1.0
_BY_START = ("step", "horizon", "end")
"""What a scenario has or has not by its start and its events."""

_CHANGES = ("load", "load_pressures", "source_flow", "spool_position")


class StepConfig(Section):
    """The load step: a scenario of one event."""

    load: Load = 1
    """Which load steps."""
    to: Pressure = 15e6
    """Its steady pressure after the step."""
    at: Time | None = None
    """When, for a cold start; a settled one begins with the step."""


class EventConfig(Section):
    """Inputs change, at once or evenly over a time."""

    model_config = ConfigDict(json_schema_extra=schemas.event_rules(_CHANGES))

    at: Instant | None = None
    """When it begins; the first event of a settled start does so at 0 where not given."""
    over: Instant = 0.0
    """How long it takes; 0 s is a step."""
    load: Load | None = None
    """Which load changes; with `to`."""
    to: Pressure | None = None
    """Its pressure afterwards, when half the scenario's source flow passes."""
    load_pressures: tuple[Pressure, Pressure] | None = None
    """Of both loads afterwards, in place of `load` and `to`."""
    source_flow: Flow | None = None
    """Qs afterwards."""
    spool_position: Position | None = None
    """φ/φ0 afterwards."""

    def to_event(self) -> Event:
        """Return what the model simulates."""
        pressures: tuple[float | None, float | None] = self.load_pressures or (None, None)
        if self.load is not None:
            pressures = (self.to, None) if self.load == 1 else (None, self.to)
        return Event(self.at or 0.0, self.over, self.source_flow, self.spool_position, pressures)

    @classmethod
    def rules(cls, raw: Mapping[str, Any]) -> Iterator[InitErrorDetails]:
        """Say what an event lacks."""
        if not any(raw.get(name) is not None for name in _CHANGES):
            yield mistake((), f"the event changes nothing; give one of {', '.join(_CHANGES)}")
        if (raw.get("load") is None) != (raw.get("to") is None):
            yield mistake((), "`load` says which load changes and `to` to what pressure; give both, or neither")
        if raw.get("load") is not None and raw.get("load_pressures") is not None:
            sentence = "`load` and `load_pressures` both say what the loads do; delete one of the two"
            yield mistake(("load_pressures",), sentence, at_key=True)


class ScenarioConfig(Section):
    """What happens to the valve (section 3.1 of the thesis)."""

    model_config = ConfigDict(json_schema_extra=schemas.scenario_rules())

    source_flow: Flow = 1e-3
    """Qs; the load orifices are sized for half of it."""
    spool_position: Position = 0.5
    """φ/φ0, the angle that sets the ratio."""
    load_pressures: tuple[Pressure, Pressure] = (10e6, 10e6)
    """Steady load pressures before the first event, by which the load orifices are sized."""
    events: Annotated[tuple[EventConfig, ...], Field(max_length=MOST_EVENTS)] = ()
    """Any events, in the order of time, in place of `step`."""
    step: StepConfig | None = Field(default_factory=lambda data: None if data.get("events") else StepConfig())
    """The load step, a scenario of one event."""
    start: Annotated[str, OneOf("start", _STARTS)] = "settled"
    """`settled`: at the equilibrium before the first event; `cold`: all states zero."""
    horizon: Time | None = Field(default_factory=lambda data: _end_if(data, "settled"))
    """How long a settled start is simulated, from the last event on; 1 s where not given."""
    end: Time | None = Field(default_factory=lambda data: _end_if(data, "cold"))
    """When the simulation of a cold start ends; 1 s where not given."""
    accumulation_time: Time = 0.2
    """t_cum of (3.8), (3.11), (3.12)."""

    def to_scenario(self) -> Scenario:
        """Return what the model simulates."""
        step = self.step or StepConfig()
        events = tuple(event.to_event() for event in self.events)
        events = events or (load_step(step.load, step.to, step.at or 0.0),)
        settled = self.start == "settled"
        lasting = (self.horizon if settled else self.end) or _DEFAULT_END
        return Scenario(
            source_flow=self.source_flow,
            spool_position=self.spool_position,
            load_pressures=self.load_pressures,
            events=events,
            settled=settled,
            end_time=events[-1].at + lasting if settled else lasting,
            accumulation_time=self.accumulation_time,
        )

    @model_validator(mode="before")
    @classmethod
    def _prepared(cls, raw: Any) -> Any:
        """Refuse too many events before each is judged, and take an explicit null for what is not given."""
        if not isinstance(raw, Mapping):
            return raw
        if "set" in raw and "set" not in cls.model_fields:
            sentence = "only one of `model.scenarios` sets parameters of its own; write these in `model.set`"
            raise together([mistake(("set",), sentence, at_key=True)])
        events = raw.get("events")
        if isinstance(events, list | tuple) and len(events) > MOST_EVENTS:
            sentence = f"the list has {len(events)} values; write at most {MOST_EVENTS}"
            raise together([mistake(("events",), sentence)])
        return {key: value for key, value in raw.items() if value is not None or key not in _BY_START}

    @classmethod
    def rules(cls, raw: Mapping[str, Any]) -> Iterator[InitErrorDetails]:
        """Say which times go with which start and with each other."""
        cold = raw.get("start") == "cold"
        if cold and raw.get("horizon") is not None:
            yield mistake(("horizon",), "a cold start runs to its `end`; rename `horizon`", at_key=True)
        if not cold and raw.get("end") is not None:
            yield mistake(("end",), "a settled start lasts its `horizon`; rename `end`", at_key=True)
        events = raw.get("events")
        if isinstance(events, list | tuple) and len(events) > MOST_EVENTS:  # has its own mistake
            return
        if isinstance(events, list | tuple) and events:
            if raw.get("step") is not None:
                sentence = "`step` and `events` both say what happens; delete one of the two"
                yield mistake(("step",), sentence, at_key=True)
            yield from _lacking_times(events, cold)
        else:
            yield from _step_rules(raw, cold)
        try:
            timeline = _timeline(raw)
        except ValueError:  # has its own mistake
            return
        yield from _order_rules(timeline)
        yield from _end_rules(raw, timeline[-1], cold)


ParameterValues = Annotated[
    Mapping[str, float],
    PlainValidator(by_name("parameters", lambda parameter, raw: measure_of(parameter).read(raw))),
    WithJsonSchema(schemas.parameters()),
]
"""Parameters by name, each in its unit."""


class NamedScenarioConfig(ScenarioConfig):
    """One of several scenarios, in which the valve may meet another oil."""

    set: ParameterValues = Field(default_factory=dict)
    """Parameters that differ in this scenario from those of every other."""


def _step_rules(raw: Mapping[str, Any], cold: bool) -> Iterator[InitErrorDetails]:
    step = raw.get("step") or {}
    at = step.get("at") if isinstance(step, Mapping) else None
    if cold and at is None:
        yield mistake(("step", "at"), "a cold start needs the time of the step; add `at: 50 ms` to the step")
    if at is not None and raw.get("start", "settled") == "settled":
        sentence = "a settled start begins with the step; delete `at`, or write start: cold"
        yield mistake(("step", "at"), sentence, at_key=True)


def _lacking_times(events: Sequence[object], cold: bool) -> Iterator[InitErrorDetails]:
    for i, event in enumerate(events):
        if isinstance(event, Mapping) and event.get("at") is None and (cold or i > 0):
            yield mistake(("events", i), "the event has no time; add `at`, such as `at: 50 ms`")


def _timeline(raw: Mapping[str, Any]) -> list[tuple[float, float]]:
    """Begin and duration of each event [s], as written; raises ValueError where something is not readable."""
    second = Measure("s")
    events = raw.get("events") or [raw.get("step") or {}]
    if not isinstance(events, list | tuple) or not all(isinstance(event, Mapping) for event in events):
        raise ValueError("not a list of events")
    if any(event.get("at") is None for event in events[1:]):
        raise ValueError("an event without a time")
    return [(second.read(event.get("at") or "0 s"), second.read(event.get("over") or "0 s")) for event in events]


def _order_rules(timeline: Sequence[tuple[float, float]]) -> Iterator[InitErrorDetails]:
    for i, ((before, over), (at, _)) in enumerate(pairwise(timeline), start=1):
        if at <= before:
            sentence = f"the event at {at:g} s does not come after the one at {before:g} s; put events in order"
            yield mistake(("events", i, "at"), f"{sentence}, and what happens at once into one event")
        elif before + over - at > INSTANT * max(at, before + over):
            sentence = f"the event at {at:g} s begins before the one at {before:g} s is over, at {before + over:g} s"
            yield mistake(("events", i, "at"), f"{sentence}; let it begin later")


def _end_rules(raw: Mapping[str, Any], last: tuple[float, float], cold: bool) -> Iterator[InitErrorDetails]:
    """Say what comes after the end."""
    key = "end" if cold else "horizon"
    at, over = last
    try:
        given = _DEFAULT_END if raw.get(key) is None else Measure("s").read(raw[key])
        needed = Measure("s").read(raw.get("accumulation_time", "0.2 s"))
    except ValueError:  # has its own mistake
        return
    several = bool(raw.get("events"))
    what, end = "last event" if several else "step", given if cold else at + given
    if end - at - over <= INSTANT * end:
        where = (key,) if raw.get(key) is not None or several else ("step", "at")
        over_words = f", which takes {over:g} s" if over else ""
        sentence = f"the simulation ends at {end:g} s, not after the {what} at {at:g} s{over_words}"
        yield mistake(where, f"{sentence}; end it later")
    elif at + needed - end > INSTANT * end:
        where = ("accumulation_time",) if "accumulation_time" in raw else (key,)
        sentence = (
            f"the simulation ends {end - at:g} s after the {what}, before the accumulation time of {needed:g} s"
        )
        yield mistake(where, f"{sentence}; simulate longer, or accumulate for less")


def _end_if(data: Mapping[str, Any], start: str) -> float | None:
    return _DEFAULT_END if data.get("start") == start else None
