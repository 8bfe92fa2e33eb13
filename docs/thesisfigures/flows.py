"""The figures of section 3.4 that show load flows: for five values of a parameter, and Figure 3.6 for one."""

from collections.abc import Callable, Sequence
from functools import cache

import numpy as np
from claims.judgement import Answer, Judgement, Statement
from claims.radius import LOST_RADIUS
from claims.runs import AUTHOR_STEP_TIME, Runs
from modelpages.chart import Line, Panel, draw
from modelpages.runs import Run, measured

from divideropt.models.base import FloatArray, Outcome
from divideropt.models.divider.study import THESIS_POINTS, THESIS_RANGES
from thesisfigures.courses import FLOW_FACTOR, FLOW_UNIT, TimeCourse, course_between, panel_over
from thesisfigures.figure import TITLES, Both
from thesisfigures.sweeps import AXES

FIVE = (0, 25, 50, 75, 99)
"""Which of his 100 values the author draws, `i_m` of changeall.m."""

BEFORE = -AUTHOR_STEP_TIME
"""Where his axis begins, after the step [s]."""

CLOSE, SHORTEST, LONGEST = -0.02, 0.06, 0.4
"""Where the enlarged view begins, and between which limits it ends, after the step [s]. He runs 0.4 s."""

SETTLED = 1.5
"""It ends at this many of the longest settling times, as his."""

SEPARATE, TOUCHING = 0.05, 0.01
"""Curves can be told apart by this part of a branch's share of the source flow; by the second in part."""

BRANCH_FLOW = 5e-4
"""A branch's share of the source flow [m^3/s]."""

Y_LABEL = f"QL1 (solid), QL2 (dashes) [{FLOW_UNIT}]"


def draw_flows(parameter: str) -> Callable[[Both], str]:
    """Make what draws the load flows for the author's five values, whole and enlarged."""

    def drawn(both: Both) -> str:
        runs = {name: _five(found, parameter) for name, found in both.items()}
        end = _enlarged_to([one for five in runs.values() for one in five])
        panels = [
            _panel(name, five, parameter, window, words)
            for window, words in (((BEFORE, LONGEST), ""), ((CLOSE, end), ", enlarged"))
            for name, five in runs.items()
        ]
        name = AXES[parameter][0]
        return draw(panels, f"Load flows after a step of load 1 from 10 to 15 MPa, for five values of {name}", 2)

    return drawn


def outcomes_of_five(parameter: str) -> Callable[[Both], str]:
    """Make what says which of the five responses ended badly."""

    def said(both: Both) -> str:
        parts = []
        for name, runs in both.items():
            for value, one in zip(five_values(parameter), _five(runs, parameter), strict=True):
                if one.outcome is not Outcome.OK:
                    parts.append(f"{_written(parameter, value)} in {name}: `{one.outcome}`")
        return f"Not `ok`: {'; '.join(parts)}." if parts else "All ten responses are `ok`."

    return said


def told_apart(parameter: str) -> Statement:
    """Return what a figure's caption claims that says no more than “showing effect of changing …”."""

    def judge(runs: Runs) -> Judgement:
        flows = [_on_grid(one) for one in _five(runs, parameter) if one.outcome is Outcome.OK]
        if len(flows) < 2:
            return Judgement(Answer.NOT_JUDGED, f"{len(flows)} of 5 responses are ok")
        apart = float(np.ptp(np.array(flows), axis=0).max()) / BRANCH_FLOW
        answer = Answer.YES if apart >= SEPARATE else Answer.IN_PART if apart >= TOUCHING else Answer.NO
        return Judgement(answer, f"up to {100 * apart:.1f} % of Qs/2 between two of {len(flows)} responses")

    return Statement(
        "showing effect of changing …",
        "",
        f"Yes if two of the five QL1 lie apart by {100 * SEPARATE:g} % of Qs/2 somewhere in the first "
        f"{LONGEST:g} s after the step, in part by {100 * TOUCHING:g} %.",
        judge,
    )


def draw_lost_control(both: Both) -> str:
    """Draw Figure 3.6: the load flows with a spool of 3 mm."""
    panels = []
    for name, runs in both.items():
        lines = _lines(course_between(runs.response({"spool_radius": LOST_RADIUS}), BEFORE, LONGEST), ("QL1", "QL2"))
        panels.append(panel_over(lines, f"load flow [{FLOW_UNIT}]", f"{TITLES[name]}, r = 3 mm", (BEFORE, LONGEST)))
    return draw(panels, "Load flows before and after a step of load 1, with a spool of 3 mm radius")


def five_values(parameter: str) -> list[float]:
    """Return the values that the author draws, SI."""
    return [float(value) for value in np.linspace(*THESIS_RANGES[parameter], THESIS_POINTS)[list(FIVE)]]


@cache
def _five(runs: Runs, parameter: str) -> tuple[Run, ...]:
    return tuple(measured(runs.response({parameter: value})) for value in five_values(parameter))


def _enlarged_to(runs: Sequence[Run]) -> float:
    longest = max((one["settling_time"] for one in runs if one.outcome is Outcome.OK), default=LONGEST)
    return round(min(max(SETTLED * longest, SHORTEST), LONGEST), 2)


def _panel(name: str, five: Sequence[Run], parameter: str, window: tuple[float, float], words: str) -> Panel:
    lines = []
    for place, (value, one) in enumerate(zip(five_values(parameter), five, strict=True)):
        label = _written(parameter, value)
        lines += _lines(course_between(one.response, *window), (label, label), (place, place))[::-1]
    return panel_over(lines, Y_LABEL, TITLES[name] + words, window)


def _lines(course: TimeCourse, labels: tuple[str, str], colours: tuple[int, int] = (0, 1)) -> list[Line]:
    return [
        Line(labels[i], course.times, course.flows[:, i] * FLOW_FACTOR, colours[i], dash, 1.6)
        for i, dash in enumerate(("solid", "dash"))
    ]


def _on_grid(run: Run) -> FloatArray:
    course = course_between(run.response, 0.0, LONGEST)
    after = course.times > 0.0
    times = np.linspace(1e-3, LONGEST, 400)
    return np.asarray(np.interp(times, course.times[after], course.flows[after, 0]))


def _written(parameter: str, value: float) -> str:
    _, factor, unit = AXES[parameter]
    return f"{value * factor:.3g} {unit}".strip()
