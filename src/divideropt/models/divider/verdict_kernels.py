"""How a response is judged, compiled: the first thing wrong, the gravest first."""

import math

from divideropt.models.divider.metric_kernels import REST_TOLERANCE, distance_from_rest, on_stop, rests_at_root
from divideropt.models.divider.oscillation import oscillation
from divideropt.models.divider.result_record import (
    AT_STOP,
    LEFT_ITS_BAND,
    LIMIT_CYCLE,
    NO_EQUILIBRIUM,
    NOT_COMPLETED,
    SOUND,
    UNSETTLED,
    UNSTABLE,
)
from divideropt.models.divider.states import STATES
from divideropt.ode.compiled import compiled

LAST_PART = 0.1
"""Where the final flows are the end's own, leaving the band in this last part of the time is unsettled."""

_X = STATES.index("x")


@compiled
def judge_course(course, whole, by_event, judgements, i):  # type: ignore[no-untyped-def]
    """Judge a response.

    Args:
        course: A `Course`.
        whole: What was measured, see `measure_course`.
        by_event: The same, by event.
        judgements: `JUDGEMENT`, shape (n,); the i-th receives what was found.
        i: Which.
    """
    j, last = judgements[i], course.spans.size - 1
    j.finding, j.phase, j.value = SOUND, last, math.nan
    for phase in range(last + 1):
        if course.stopped[phase] != 0:
            j.finding, j.phase = NOT_COMPLETED, phase
            return
    if _cycles(course, last):
        j.finding = LIMIT_CYCLE
        return
    for phase in range(last + 1):
        where = _on_its_stop(course, phase)
        if not math.isnan(where):
            j.finding, j.phase, j.value = AT_STOP, phase, where
            return
    for phase in range(last + 1):
        if course.rested[phase] == 0 and course.spans[phase].moving == 0:
            j.finding, j.phase = NO_EQUILIBRIUM, phase
            return
    if whole[i].stability_margin < 0.0:  # NaN is not unstable
        j.finding, j.value = UNSTABLE, whole[i].stability_margin
        return
    if course.reached[last] == 0 or course.rested[last] == 0:
        return
    time = by_event[i, course.rules[0].events - 1].settling_time
    if rests_at_root(course):
        off = distance_from_rest(course, last)
        if not off <= REST_TOLERANCE or math.isnan(time):
            j.finding, j.value = UNSETTLED, off
    elif not time <= (1.0 - LAST_PART) * (course.rules[0].end_time - course.rules[0].last_event_time):
        j.finding = LEFT_ITS_BAND


@compiled
def _cycles(course, last):  # type: ignore[no-untyped-def]
    """Whether the last phase ends in a sustained oscillation."""
    if course.reached[last] == 0 or course.rested[last] == 0 or course.first[last + 1] == course.first[last]:
        return False
    steps = slice(course.first[last], course.first[last + 1])
    edges = course.edges[course.first[last] : course.first[last + 1] + 1]
    span, design, rest = course.spans[last], course.designs[last : last + 1], course.rests[last]
    amplitude, _ = oscillation(edges, course.values[steps], design, rest, span.begin, span.end, REST_TOLERANCE)
    return not math.isnan(amplitude)


@compiled
def _on_its_stop(course, phase):  # type: ignore[no-untyped-def]
    """Distance from the centre [m] at which the spool rests on its stop, NaN where it does not."""
    if course.reached[phase] == 0:
        return math.nan
    if on_stop(course, phase, course.ends):
        return abs(course.ends[phase, _X])
    if course.rested[phase] != 0 and on_stop(course, phase, course.rests):
        return abs(course.rests[phase, _X])
    return math.nan
