"""What happens to the valve: events on its inputs, and the phases between which they divide the time."""

from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

INSTANT = 1e-9
"""Times that differ by less than this part of the whole are one: 0.1 s + 0.2 s is 0.3 s."""


@dataclass(frozen=True)
class Inputs:
    """What is given from outside.

    Attributes:
        source_flow: Qs [m^3/s].
        spool_position: φ/φ0.
        load_pressures: Pressures [Pa] that the load orifices make when half the scenario's source flow passes.
    """

    source_flow: float
    spool_position: float
    load_pressures: tuple[float, float]


@dataclass(frozen=True)
class Event:
    """Some inputs change, at once or evenly over a time.

    Attributes:
        at: When it begins [s].
        over: How long it takes [s]; 0 is a step.
        source_flow: Qs from then on [m^3/s], or None where it stays.
        spool_position: φ/φ0 from then on, or None.
        load_pressures: Of either load from then on [Pa], or None.
    """

    at: float = 0.0
    over: float = 0.0
    source_flow: float | None = None
    spool_position: float | None = None
    load_pressures: tuple[float | None, float | None] = (None, None)

    def applied_to(self, inputs: Inputs) -> Inputs:
        """Return the inputs after it."""
        first, second = (
            old if new is None else new for old, new in zip(inputs.load_pressures, self.load_pressures, strict=True)
        )
        return Inputs(
            inputs.source_flow if self.source_flow is None else self.source_flow,
            inputs.spool_position if self.spool_position is None else self.spool_position,
            (first, second),
        )


def load_step(load: int, to: float, at: float = 0.0, over: float = 0.0) -> Event:
    """Return the event in which one load goes to another pressure.

    Args:
        load: Which, 1 or 2.
        to: Its pressure [Pa] when half the scenario's source flow passes.
        at: When [s].
        over: How long it takes [s].
    """
    return Event(at, over, load_pressures=(to, None) if load == 1 else (None, to))


@dataclass(frozen=True)
class Span:
    """A stretch of time over which the inputs stay, or go evenly from one value to another.

    Attributes:
        begin: First time [s].
        end: Last time [s].
        inputs: At the beginning.
        final_inputs: At the end.
        event: Which event it follows, from 0; -1 before the first.
    """

    begin: float
    end: float
    inputs: Inputs
    final_inputs: Inputs
    event: int

    @property
    def moving(self) -> bool:
        """Whether the inputs change over it."""
        return self.inputs != self.final_inputs


@dataclass(frozen=True)
class Scenario:
    """Events in a row, from rest at an equilibrium or from an empty valve.

    Attributes:
        source_flow: Qs before the first event [m^3/s]; the load orifices are sized for half of it.
        spool_position: φ/φ0 before it, strictly between 0 and 1.
        load_pressures: Steady load pressures before it [Pa].
        events: In the order of time, each over before the next begins; at least one.
        settled: Whether to start at the equilibrium before the first event; else from all states zero at t = 0.
        end_time: When the simulation ends [s].
        accumulation_time: t_cum of (3.8), (3.11), (3.12) [s].
    """

    source_flow: float = 1e-3
    spool_position: float = 0.5
    load_pressures: tuple[float, float] = (10e6, 10e6)
    events: tuple[Event, ...] = (load_step(1, 15e6),)
    settled: bool = True
    end_time: float = 1.0
    accumulation_time: float = 0.2

    def __post_init__(self) -> None:
        """Refuse events that overlap or come too late."""
        if not self.events:
            raise ValueError("the scenario has no event; give one, such as load_step(1, 15e6)")
        begins = [*(event.at for event in self.events), self.end_time]
        spare = [after - event.at - event.over for event, after in zip(self.events, begins[1:], strict=True)]
        overlap = any(time < -INSTANT * self.end_time for time in spare)
        unfinished = spare[-1] <= INSTANT * self.end_time
        if begins[0] < 0.0 or overlap or unfinished or any(late <= early for early, late in pairwise(begins)):
            raise ValueError("events must follow each other, each over before the next begins, and before the end")

    @property
    def initial(self) -> Inputs:
        """The inputs before the first event."""
        return Inputs(self.source_flow, self.spool_position, self.load_pressures)

    @cached_property
    def measured_events(self) -> tuple[int, ...]:
        """The events before the last, from 1, after which the inputs stay a while: those that have metrics."""
        earlier = range(len(self.events) - 1)
        return tuple(span.event + 1 for span in self.spans() if span.event in earlier and not span.moving)

    @property
    def last_event_time(self) -> float:
        """When the last event begins [s]."""
        return self.events[-1].at

    def spans(self) -> tuple[Span, ...]:
        """Divide the time: before the first event, then the way and the stay of each event in turn."""
        return self._spans

    @cached_property
    def _spans(self) -> tuple[Span, ...]:
        inputs = self.initial
        spans = [Span(0.0, self.events[0].at, inputs, inputs, -1)]
        ends = [event.at for event in self.events[1:]] + [self.end_time]
        for number, (event, end) in enumerate(zip(self.events, ends, strict=True)):
            arrived, after = event.at + event.over, event.applied_to(inputs)
            stays = end - arrived > INSTANT * self.end_time
            if event.over > 0.0:
                spans.append(Span(event.at, arrived if stays else end, inputs, after, number))
            if stays:
                spans.append(Span(arrived, end, after, after, number))
            inputs = after
        return tuple(spans)
