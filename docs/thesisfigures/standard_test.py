"""Figures 3.1 and 3.2: the standard test on the base set, and what its errors are."""

from dataclasses import replace

import numpy as np
from claims.contradictions import of_figure_3_1
from claims.judgement import Answer, Judgement, Statement
from claims.runs import Runs
from modelpages.chart import Area, Line, Note, Panel, draw
from modelpages.runs import Run, measured
from modelpages.tables import fixed

from divideropt.models.base import FloatArray, Outcome
from thesisfigures.courses import FLOW_FACTOR, FLOW_UNIT, TIME, course_between, panel_over, thin_line
from thesisfigures.figure import TITLES, Both
from thesisfigures.thin import thinned

TICK, LAST_TICK = 50e-6, 400e-6
"""Ticks of the vertical axis of Figure 3.1, and the last of them [m^3/s]: the axis ends below the next."""

WINDOW = (-0.1, 0.4)
"""What Figure 3.1 is drawn over, after the step [s]."""

ERROR_WINDOW = (-0.05, 0.25)
"""The same of Figure 3.2: the test of 0.2 s, and some time to either side."""

SAME, NEAR = 0.01, 0.10
"""Two volumes are the same that differ by this part of the larger of the two added; by the second in part."""


def draw_step_response(both: Both) -> str:
    """Draw Figure 3.1: both load flows."""
    panels, top = [], 6.0
    for name, runs in both.items():
        course = course_between(runs.response({}), *WINDOW)
        lines = [
            thin_line(Line(label, course.times, course.flows[:, i] * FLOW_FACTOR, i), WINDOW, (0.0, top))
            for i, label in enumerate(("QL1", "QL2"))
        ]
        end = (LAST_TICK + TICK) * FLOW_FACTOR
        lines.append(Line("the thesis’s axis ends below", np.array(WINDOW), np.array([end, end]), 2, "dot", 1.4))
        panels.append(Panel(lines, TIME, f"load flow [{FLOW_UNIT}]", TITLES[name], WINDOW, (0.0, top)))
    return draw(panels, "Load flows after a step of load 1 from 10 to 15 MPa, on the base set")


def draw_errors_shaded(both: Both) -> str:
    """Draw Figure 3.2: the areas that are the steady and the dynamic cumulative error."""
    runs = {name: measured(found.response({})) for name, found in both.items()}
    panels = [make(name, run) for make in (_shaded_flows, _shaded_difference) for name, run in runs.items()]
    return draw(panels, "Load flows and their difference with the steady and the dynamic cumulative error shaded", 2)


def volumes(both: Both) -> str:
    """Say the volumes that Figure 3.2 shades."""
    parts = []
    for name, runs in both.items():
        steady, dynamic, total = _volumes(measured(runs.response({})))
        parts.append(
            f"{name}: steady {_millilitres(steady)}, dynamic {_millilitres(dynamic)}, total {_millilitres(total)}"
        )
    return (
        f"The areas, branch 1 less branch 2: {'; '.join(parts)}. The thesis’s figure is a sample without numbers. "
        "Between the two steady flows, from the step over t_cum = 0.2 s, lies the steady error (3.9); between each "
        "flow and its own steady value, up to the settling time ts, the dynamic error (3.10). Below, the same of the "
        "difference, as the integrals have it: what is under its steady value is the dynamic error, negative. Where "
        "the two areas lie on each other they cancel."
    )


def another_test(both: Both) -> str:
    """Say why Figure 3.1 cannot have been made with the printed inputs."""
    return of_figure_3_1(both["listing, cold"].base())


def _responds(runs: Runs) -> Judgement:
    run = measured(runs.response({}))
    settles = run.outcome is Outcome.OK
    moves = settles and run["settling_time"] > 0.0
    answer = Answer.YES if moves else Answer.IN_PART if settles else Answer.NO
    return Judgement(answer, f"`{run.outcome}`, settled after {1e3 * run['settling_time']:.0f} ms")


def _below_axis(runs: Runs) -> Judgement:
    run = measured(runs.response({}))
    largest = max(run["load_flow_1"], run["load_flow_2"])
    answer = Answer.YES if largest < LAST_TICK + TICK else Answer.NO
    return Judgement(answer, f"{1e6 * largest:.0f}×10⁻⁶ m³/s in one branch at the end")


def _sum_of_the_two(runs: Runs) -> Judgement:
    steady, dynamic, total = _volumes(measured(runs.response({})))
    off = abs(steady + dynamic - total)
    part = off / max(abs(steady), abs(dynamic))
    answer = Answer.YES if part <= SAME else Answer.IN_PART if part <= NEAR else Answer.NO
    return Judgement(
        answer,
        f"{_millilitres(steady + dynamic)} and {_millilitres(total)}, {100 * part:.1f} % of the larger part off",
    )


STEP_RESPONSE = (
    Statement(
        "two outlet flows responding to a step change in one of the load pressures",
        "",
        "Yes if QL1 leaves its band of 2 % and the response ends `ok`; in part if it never leaves it.",
        _responds,
    ),
    Statement(
        "(a vertical axis with ticks of 50×10⁻⁶ m³/s and its last at 400×10⁻⁶), calculated using the … parameters "
        "found in Appendix B",
        "",
        "Yes if both flows end below 450×10⁻⁶ m³/s, where the next tick would be.",
        _below_axis,
    ),
)
"""What the caption of Figure 3.1 says, and its axis."""

ERRORS_SHADED = (
    Statement(
        "The total cumulative error, E_CU, is the sum of the two",
        "",
        "(3.9) + (3.10) beside (3.8) over 0.2 s: yes if they differ by at most 1 % of the larger part, in part by 10 "
        "%. They are not the same by definition: (3.10) ends at the settling time, and what is within 2 % then is "
        "left out.",
        _sum_of_the_two,
    ),
)
"""What the caption of Figure 3.2 says."""


def _millilitres(volume: float) -> str:
    return f"{fixed(1e6 * volume, 2)} mL"


def _volumes(run: Run) -> tuple[float, float, float]:
    """Return steady, dynamic and total cumulative error, (3.9), (3.10), (3.8) [m^3]."""
    scenario = run.response.scenario
    steady = run["cumulative_steady_error_percent"] / 100 * scenario.source_flow * scenario.accumulation_time
    return steady, run["dynamic_error"], run["cumulative_error"]


def _shaded_flows(name: str, run: Run) -> Panel:
    course = course_between(run.response, *ERROR_WINDOW)
    final = (run["load_flow_1"] * FLOW_FACTOR, run["load_flow_2"] * FLOW_FACTOR)
    areas = [_steady_area(run, final[1], final[0])]
    lines = []
    for i, label in enumerate(("QL1", "QL2")):
        flow = course.flows[:, i] * FLOW_FACTOR
        areas.append(_dynamic_area(run, course.times, flow, final[i]))
        lines.append(Line(label, course.times, flow, i))
    return _shaded(lines, areas, f"load flow [{FLOW_UNIT}]", TITLES[name], run)


def _shaded_difference(name: str, run: Run) -> Panel:
    course = course_between(run.response, *ERROR_WINDOW)
    difference = (course.flows[:, 0] - course.flows[:, 1]) * FLOW_FACTOR
    final = (run["load_flow_1"] - run["load_flow_2"]) * FLOW_FACTOR
    areas = [_steady_area(run, 0.0, final), _dynamic_area(run, course.times, difference, final)]
    lines = [Line("QL1 − QL2", course.times, difference, 3)]
    return _shaded(lines, areas, f"QL1 − QL2 [{FLOW_UNIT}]", TITLES[name], run)


def _steady_area(run: Run, low: float, high: float) -> Area:
    test = np.array([0.0, run.response.scenario.accumulation_time])
    return Area("steady error (3.9)", test, np.full(2, low), np.full(2, high), 2)


def _dynamic_area(run: Run, times: FloatArray, curve: FloatArray, final: float) -> Area:
    after = np.flatnonzero(times >= 0.0)
    after = after[times[after] <= run["settling_time"]]
    after = after[np.argmax(times[after] > 0.0) - 1 :]  # of the two values at the step the later
    x, y = thinned(times[after], curve[after], ERROR_WINDOW, (float(curve.min()), float(curve.max())))
    return Area("dynamic error (3.10)", x, np.full(len(x), final), y, 4)


def _shaded(lines: list[Line], areas: list[Area], y_label: str, title: str, run: Run) -> Panel:
    panel = panel_over(lines, y_label, title, ERROR_WINDOW)
    floor = float(min(line.y.min() for line in lines))
    ends = (("ts", run["settling_time"]), ("t_cum", run.response.scenario.accumulation_time))
    return replace(panel, areas=areas, notes=[Note(words, at, floor) for words, at in ends])
