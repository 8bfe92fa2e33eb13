"""Every quantity of a response, and the verdict on it.

The last event's quantities have plain names; those of an earlier one are prefixed `event_1.`, `event_2.` and so on,
and are not defined where the next event comes before the flows have settled.
"""

from functools import cache
from typing import cast

import numpy as np

from divideropt.models.base import FloatArray, Verdict
from divideropt.models.divider.course import course_of
from divideropt.models.divider.metric_kernels import measure_course
from divideropt.models.divider.quantities import EVENT_QUANTITIES, quantities_of
from divideropt.models.divider.record import Records, blank
from divideropt.models.divider.response import Response
from divideropt.models.divider.result_record import BY_EVENT, JUDGEMENT, WHOLE, WHOLE_QUANTITIES
from divideropt.models.divider.scenario import Scenario
from divideropt.models.divider.verdict_kernels import judge_course
from divideropt.models.divider.verdicts import verdict_on


def measure(response: Response) -> tuple[FloatArray, Verdict]:
    """Measure a response.

    Args:
        response: One design's response.

    Returns:
        The quantities in the order of `quantities_of(events)`, NaN where one is not defined, and the verdict.
    """
    course, found = course_of(response), Findings(response.scenario, 1)
    measure_course(course, found.whole, found.by_event, 0)
    judge_course(course, found.whole, found.by_event, found.judgements, 0)
    return found.quantities()[0], verdict_on(response, found.judgements[0])


class Findings:
    """Where compiled functions put what they find in n responses to one scenario.

    Attributes:
        whole: `WHOLE`, shape (n,).
        by_event: `BY_EVENT`, shape (n, events).
        judgements: `JUDGEMENT`, shape (n,).
    """

    def __init__(self, scenario: Scenario, count: int) -> None:
        """Begin with NaN everywhere."""
        self._scenario = scenario
        self._whole = np.full((count, len(WHOLE_QUANTITIES)), np.nan)
        self._by_event = np.full((count, len(scenario.events) * len(EVENT_QUANTITIES)), np.nan)
        self.whole = cast(Records, self._whole.view(WHOLE)[:, 0])
        self.by_event = cast(Records, self._by_event.view(BY_EVENT))
        self.judgements = blank(JUDGEMENT, count)

    def quantities(self) -> FloatArray:
        """Return the quantities, shape (n, m), in the order of `quantities_of(events)`."""
        table = np.column_stack([self._whole, self._by_event])
        return table[:, _places(len(self._scenario.events), self._scenario.measured_events)]


@cache
def _places(events: int, measured: tuple[int, ...]) -> list[int]:
    """Where the quantities stand in the records of a response, one after the other."""
    first, width = len(WHOLE_QUANTITIES), len(EVENT_QUANTITIES)
    places = {name: i for i, name in enumerate(WHOLE_QUANTITIES)}
    places |= {name: first + (events - 1) * width + i for i, name in enumerate(EVENT_QUANTITIES)}
    for number in measured:
        begin = first + (number - 1) * width
        places |= {f"event_{number}.{name}": begin + i for i, name in enumerate(EVENT_QUANTITIES)}
    return [places[name] for name in quantities_of(measured)]
